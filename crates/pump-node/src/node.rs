//! The node's half of the link: bytes in, answers out.

use pump_ctl::step::{BRAKE_ENTRIES, Brake, Segment, TickRate};
use pump_link::frame::{AnswerHeader, Encoded, FrameError, RequestHeader, VERSION, body};
use pump_link::message::{AXES, Answer, AxisConfig, Identity, Refusal, Request};
use pump_link::packing::{Codec, Grain};
use pump_link::receiver::{Arrival, DeadMan, Expected};

use crate::axes::MAX_STEP_HZ;
use crate::axis::{Checked, Setup, tick_rate};
use crate::board::{Board, Pins};
use crate::ports::Ports;
use crate::shared::Shared;

/// Returns the identity of a board with a number of its own, from the firmware's version and the timer's rate, Hz.
/// `A` is the number of its axes, `Q` that of the segments in a queue.
pub const fn identity<const Q: usize, const A: usize>(
    board: u64,
    firmware: [u16; 3],
    tick_hz: u32,
) -> Identity {
    Identity::new(board, firmware, A as u8, Q as u16, tick_hz, MAX_STEP_HZ)
}

/// The node: it takes the bytes of a host and answers its requests.
///
/// It has no session at power-up, so a host finds out that it was reset.
#[derive(Debug)]
pub struct Node {
    identity: Identity,
    tick_rate: TickRate,
    ports: Ports,
    /// Session number of the host. It is 0 after a reset.
    session: u64,
    dead_man: DeadMan,
    /// True if the dead-man time has passed since the last valid frame, and the axes know it.
    dead: bool,
    brake: BrakeParts,
}

/// The place and time that a request comes from.
#[derive(Debug, Clone, Copy)]
struct Origin {
    port: usize,
    session: u64,
    /// Tick at which the request arrived.
    now: u64,
}

/// A configuration whose brake is not complete.
#[derive(Debug)]
struct BrakeParts {
    axis: u8,
    /// Revision of the configuration. It is 0 if there is none.
    revision: u32,
    config: AxisConfig,
    entries: [Segment; BRAKE_ENTRIES],
    expected: Expected,
}

impl Node {
    /// Makes the node of a board that was just switched on. The timer of `identity` must not stand.
    pub fn new(identity: Identity) -> Self {
        Self {
            identity,
            tick_rate: tick_rate(identity.tick_hz),
            ports: Ports::new(),
            session: 0,
            dead_man: DeadMan::new(identity.tick_hz),
            dead: false,
            brake: BrakeParts {
                axis: 0,
                revision: 0,
                config: AxisConfig::new(0),
                entries: [Segment::default(); BRAKE_ENTRIES],
                expected: Expected::default(),
            },
        }
    }

    /// Returns the session number that the node holds. It is 0 after a reset.
    pub fn session(&self) -> u64 {
        self.session
    }

    /// Takes a byte that arrived at tick `now`. Returns the frame to send if the byte ends a request.
    ///
    /// Bytes that are no frame, and frames whose checksum does not fit, have no answer and do nothing.
    pub fn on_byte<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        byte: u8,
        now: u64,
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Option<Encoded> {
        self.on_byte_of(0, byte, now, shared)
    }

    /// Takes a byte that arrived at one of the [`crate::PORTS`], as [`Self::on_byte`] does. The answer goes to that
    /// port.
    ///
    /// The first port that adopts a session has it. Another port takes it only while all motors stand and the session's
    /// host has been quiet for the dead-man time. Until then it may ask who the node is and how an axis is, and nothing
    /// else.
    pub fn on_byte_of<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        port: usize,
        byte: u8,
        now: u64,
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Option<Encoded> {
        let mut payload = [0; pump_link::frame::MAX_PAYLOAD];
        let received = self.ports.deframer(port)?.push(byte)?.ok()?;
        let payload = payload.get_mut(..received.len())?;
        payload.iter_mut().zip(received).for_each(|(to, from)| *to = *from);
        self.on_payload(port, payload, now, shared)
    }

    /// Looks at the dead-man time, at the emergency stop and at the drivers. Call it every ms.
    pub fn poll<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        now: u64,
        shared: &mut impl Shared<P, B, Q, A>,
    ) {
        if !self.dead && self.dead_man.is_over(now) {
            self.dead = true;
            shared.with(|axes| axes.dead_man());
        }
        shared.with(|axes| axes.look());
    }

    fn on_payload<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        port: usize,
        payload: &[u8],
        now: u64,
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Option<Encoded> {
        let header = RequestHeader::of_any_version(payload)?;
        let request = RequestHeader::split(payload).and_then(|(_, rest)| body::<Request<'_>>(rest));
        let answer = match request {
            Ok(request) => {
                let from = Origin { port, session: header.session, now };
                let answer = self.answer(from, &request, shared).unwrap_or_else(Answer::Refused);
                if self.holds(from) {
                    self.dead_man.fed(now);
                    self.dead = false;
                }
                answer
            }
            Err(FrameError::Version { .. }) => Answer::Refused(Refusal::Version { known: VERSION }),
            Err(_) => Answer::Refused(Refusal::Malformed),
        };
        let header = AnswerHeader { number: header.number, session: self.session, received_at: now };
        Encoded::answer(header, &answer).ok()
    }

    /// Returns true if a computer has the board and was heard within the dead-man time.
    pub fn is_heard(&self) -> bool {
        self.session != 0 && !self.dead
    }

    /// Returns true if a request comes from the host that has the session.
    fn holds(&self, from: Origin) -> bool {
        from.session != 0 && from.session == self.session && self.ports.is_home(from.port)
    }

    fn answer<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        from: Origin,
        request: &Request<'_>,
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Result<Answer, Refusal> {
        match *request {
            Request::Identify => return Ok(Answer::Identity(self.identity)),
            Request::Status { axis } => {
                let status = shared.with_steps_as_due(|axes| axes.status(axis));
                return status.map(Answer::Status).ok_or(Refusal::Axis { axes: A as u8 });
            }
            Request::Adopt { dead_man_ms } => return self.adopt(from, dead_man_ms, shared),
            _ if !self.holds(from) => return Err(Refusal::Session),
            _ => {}
        }
        match *request {
            Request::Configure { axis, revision, config } => self.configure(axis, revision, config, shared),
            Request::Brake { axis, revision, first, entries } => {
                self.brake(axis, revision, first, entries, shared)
            }
            Request::Prepare { axis, move_number, order } => {
                let (next, room) = shared.with(|axes| axes.prepare(axis, move_number, order))?;
                Ok(Answer::Accepted { next, room })
            }
            Request::Segments { axis, move_number, first, packed } => {
                segments(axis, move_number, first, packed, shared)
            }
            Request::Retarget { axis, move_number, change } => {
                let (next, room) = shared.with(|axes| axes.retarget(axis, move_number, &change))?;
                Ok(Answer::Accepted { next, room })
            }
            Request::Begin { at, moves } => shared.with(|axes| axes.begin(at, moves)).map(|()| Answer::Begun),
            Request::Stop { moves } => stop(moves, shared),
            Request::FaultsRead { axis, read } => {
                shared.with(|axes| axes.confirm(axis, read)).map(|unread| Answer::Faults { unread })
            }
            _ => Err(Refusal::Malformed),
        }
    }

    fn adopt<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        from: Origin,
        dead_man_ms: u16,
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Result<Answer, Refusal> {
        let Origin { port, session, now } = from;
        if session == 0 {
            return Err(Refusal::Session);
        }
        let another = session != self.session;
        let elsewhere = self.session != 0 && !self.ports.is_home(port);
        if (another || elsewhere) && shared.with(|axes| axes.is_moving()) {
            return Err(Refusal::Moving);
        }
        if elsewhere && !self.dead_man.is_over(now) {
            // The session's host is about to move.
            return Err(Refusal::Moving);
        }
        if !self.dead_man.set_ms(dead_man_ms) {
            return Err(Refusal::DeadMan);
        }
        if another {
            shared.with(|axes| axes.forget_session());
            self.brake.revision = 0;
            self.session = session;
        }
        self.ports.move_to(port);
        Ok(Answer::Adopted)
    }

    fn configure<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        axis: u8,
        revision: u32,
        config: AxisConfig,
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Result<Answer, Refusal> {
        if shared.with(|axes| axes.may_configure(axis, revision))? {
            return Ok(Answer::Configured { brake_entries: config.brake_entries });
        }
        if !config.is_valid() {
            return Err(Refusal::Config);
        }
        let parts = &mut self.brake;
        if (parts.axis, parts.revision) != (axis, revision) || parts.config != config {
            (parts.axis, parts.revision, parts.config) = (axis, revision, config);
            parts.expected = Expected::default();
        }
        Ok(Answer::Configured { brake_entries: parts.expected.next() as u8 })
    }

    fn brake<P: Pins, B: Board, const Q: usize, const A: usize>(
        &mut self,
        axis: u8,
        revision: u32,
        first: u8,
        entries: &[u8],
        shared: &mut impl Shared<P, B, Q, A>,
    ) -> Result<Answer, Refusal> {
        let parts = &mut self.brake;
        if shared.with(|axes| axes.may_configure(axis, revision))? {
            return Ok(Answer::Configured { brake_entries: parts.config.brake_entries });
        }
        if (parts.axis, parts.revision) != (axis, revision) {
            return Err(Refusal::NotConfigured);
        }
        let refused = |expected: Expected| Refusal::Brake { entries: expected.next() as u8 };
        let (mut codec, mut rest) = (Codec::new(Grain::Exact), entries);
        let mut number = u32::from(first);
        while !rest.is_empty() && parts.expected.next() < parts.config.brake_entries.into() {
            let entry = codec.read(&mut rest).map_err(|_| refused(parts.expected))?;
            match parts.expected.arrival(number) {
                Arrival::Repeated => {}
                Arrival::Gap => return Err(refused(parts.expected)),
                Arrival::Next => {
                    let place = parts.entries.get_mut(number as usize).ok_or(refused(parts.expected))?;
                    *place = entry;
                    parts.expected.taken();
                }
            }
            number += 1;
        }
        let there = parts.expected.next();
        if there == parts.config.brake_entries.into() {
            let climb = parts.entries.into_iter().take(there as usize);
            let brake = Brake::from_climb(self.tick_rate, climb).map_err(|_| {
                // The next attempt begins anew.
                parts.revision = 0;
                Refusal::Brake { entries: 0 }
            })?;
            let setup = Setup::new(parts.config, brake, self.tick_rate);
            shared.with(|axes| axes.configure(axis, revision, &setup))?;
        }
        Ok(Answer::Configured { brake_entries: there as u8 })
    }
}

/// Stops the moves that are named, one at a time, so that the interrupt is kept off only for short times.
fn stop<P: Pins, B: Board, const Q: usize, const A: usize>(
    moves: [u32; AXES],
    shared: &mut impl Shared<P, B, Q, A>,
) -> Result<Answer, Refusal> {
    shared.with(|axes| axes.named(moves))?;
    let mut ends = [None; AXES];
    for ((axis, number), end) in (0..).zip(moves).zip(&mut ends) {
        if number != 0 {
            *end = shared.with(|axes| axes.stop(axis, number))?;
        }
    }
    Ok(Answer::Stopped { ends })
}

/// Takes the segments of a request, one at a time, so that the interrupt is kept off only for short times.
fn segments<P: Pins, B: Board, const Q: usize, const A: usize>(
    axis: u8,
    move_number: u32,
    first: u32,
    packed: &[u8],
    shared: &mut impl Shared<P, B, Q, A>,
) -> Result<Answer, Refusal> {
    shared.with_steps_as_due(|axes| axes.takes(axis, move_number, first))?;
    let (mut codec, mut rest) = (Codec::new(Grain::Fine), packed);
    let mut number = first;
    while !rest.is_empty() {
        let segment = codec.read(&mut rest).map_err(|_| Refusal::Segment { number })?;
        let checked = Checked::new(segment).ok_or(Refusal::Segment { number })?;
        if !shared.with_steps_as_due(|axes| axes.take(axis, move_number, number, &checked))? {
            break;
        }
        number = number.saturating_add(1);
    }
    let (next, room) = shared.with_steps_as_due(|axes| axes.accepted(axis))?;
    Ok(Answer::Accepted { next, room })
}
