//! A host in small: it configures axes, streams plans, and reads what became of them.

use std::collections::BTreeMap;

use pump_link::frame::{AnswerHeader, Deframer, body};
use pump_link::message::{AXES, Answer, AxisConfig, AxisState, End, MAX_PACKED, MoveOrder, Refusal, Request};
use pump_link::packing::{Codec, Grain};
use pump_link::sender::{Bracket, Clocks, Stream, Window};

use crate::host_axis::HostAxis;
use crate::plans::{PlanData, TICK_HZ};
use crate::world::QUEUE;

/// Subject of the host's next request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    Identify,
    Adopt,
    /// Learns where each motor is, and what became of its move.
    Look,
    Configure(usize),
    Prepare,
    Load,
    Begin,
    Run,
    /// Every move has ended.
    Over,
    /// The board was reset.
    Reset,
}

#[derive(Debug)]
pub(crate) struct Host {
    pub(crate) window: Window<8>,
    deframer: Deframer,
    pub(crate) clocks: Clocks,
    pub(crate) phase: Phase,
    pub(crate) axes: Vec<HostAxis>,
    /// Requests under way, by number: axis and kind.
    asked: BTreeMap<u16, (usize, Kind)>,
    move_number: u32,
    dead_man_ms: u16,
    /// Most changes of each move.
    pub(crate) changes: u32,
    pub(crate) stop: bool,
    pub(crate) begin_at: Option<u64>,
    next_status_ns: u64,
    pub(crate) lost: u32,
    /// Refusals that a host without disturbance never sees.
    pub(crate) refusals: Vec<(Kind, Refusal)>,
    /// Bytes that were not sent yet.
    pub(crate) out: Vec<Vec<u8>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Identify,
    Adopt,
    Status,
    Configure,
    Brake,
    Prepare,
    Segments,
    Retarget,
    Begin,
    Stop,
}

impl Host {
    pub(crate) fn new(session: u64, plans: &[&'static PlanData], dead_man_ms: u16) -> Self {
        let axes = plans.iter().map(|plan| HostAxis::new(plan));
        Self {
            window: Window::new(session),
            deframer: Deframer::new(),
            clocks: Clocks::new(TICK_HZ),
            phase: Phase::Identify,
            axes: axes.collect(),
            asked: BTreeMap::new(),
            move_number: 1,
            dead_man_ms,
            changes: 0,
            stop: false,
            begin_at: None,
            next_status_ns: 0,
            lost: 0,
            refusals: Vec::new(),
            out: Vec::new(),
        }
    }

    fn ask(&mut self, request: &Request<'_>, axis: usize, kind: Kind) {
        let lane = (kind == Kind::Segments).then_some(axis as u8);
        if let Ok(number) = self.window.request(request, lane) {
            self.asked.insert(number, (axis, kind));
        }
    }

    fn is_asked(&self, kind: Kind) -> usize {
        self.asked.values().filter(|(_, asked)| *asked == kind).count()
    }

    pub(crate) fn on_byte(&mut self, byte: u8, now_ns: u64) {
        let Some(Ok(payload)) = self.deframer.push(byte) else { return };
        let Ok((header, rest)) = AnswerHeader::split(payload) else { return };
        let Ok(answer) = body::<Answer>(rest) else { return };
        let Some((axis, kind)) = self.asked.get(&header.number).copied() else { return };
        // A late answer to an earlier request may be older than the session.
        if header.session != self.window.session() && !matches!(self.phase, Phase::Identify | Phase::Adopt) {
            self.phase = Phase::Reset;
            return;
        }
        if let (Kind::Segments, Answer::Refused(Refusal::Gap { .. })) = (kind, &answer) {
            self.window.gap(header.number);
            return;
        }
        let Some(answered) = self.window.answered(header.number) else { return };
        self.asked.remove(&header.number);
        if let Some(sent_ns) = answered.sent_at_ns {
            self.clocks.observe(sent_ns, now_ns, header.received_at);
        }
        self.on_answer(axis, kind, &answer);
    }

    fn on_answer(&mut self, n: usize, kind: Kind, answer: &Answer) {
        let move_number = self.move_number;
        let axis = &mut self.axes[n];
        match *answer {
            Answer::Identity(identity) => {
                assert_eq!((identity.axes, identity.tick_hz), (4, TICK_HZ));
                self.phase = Phase::Adopt;
            }
            Answer::Adopted => self.phase = Phase::Look,
            Answer::Status(status) => {
                axis.status = Some(status);
                axis.bracket.reported(status.position);
                if axis.prepared && status.move_number == move_number {
                    axis.stream.accepted(status.next_segment, status.room).unwrap();
                }
            }
            Answer::Configured { brake_entries } => {
                axis.brake_sent = brake_entries;
                axis.config_sent = true;
                axis.configured |=
                    kind == Kind::Brake && usize::from(brake_entries) == axis.plan.brake.climb().count();
            }
            Answer::Accepted { next, room } => {
                axis.stream.accepted(next, room).unwrap();
                axis.prepared = true;
                if let (Kind::Retarget, Some(change)) = (kind, &mut axis.change) {
                    change.accepted = true;
                    axis.stream.go_on();
                }
            }
            Answer::Begun => self.phase = Phase::Run,
            Answer::Stopped { ends } => {
                for (axis, end) in self.axes.iter_mut().zip(ends) {
                    axis.stopping = end;
                    axis.status = None;
                }
                self.phase = Phase::Run;
            }
            Answer::Refused(refusal) => {
                self.refusals.push((kind, refusal));
                if kind == Kind::Begin && matches!(refusal, Refusal::NoSuchMove { .. }) {
                    // The move was stopped before it began.
                    self.phase = Phase::Run;
                }
            }
            _ => unreachable!("{answer:?}"),
        }
    }

    /// Does what is due. Call it when all input was read.
    pub(crate) fn act(&mut self, now_ns: u64) {
        if self.window.expire(now_ns).is_err() {
            // A new connection: everything under way is asked again, in the same session.
            self.lost += 1;
            self.window.clear();
            self.asked.clear();
            for axis in &mut self.axes {
                axis.status = None;
                axis.config_sent = false;
            }
            if !matches!(self.phase, Phase::Identify | Phase::Adopt | Phase::Reset) {
                self.phase = Phase::Look;
            }
        }
        self.plan_requests(now_ns);
        while let Some(frame) = self.window.next_to_send(now_ns) {
            self.out.push(frame.bytes().to_vec());
        }
    }

    fn moves(&self) -> [u32; AXES] {
        let mut moves = [0; AXES];
        moves.iter_mut().take(self.axes.len()).for_each(|number| *number = self.move_number);
        moves
    }

    fn plan_requests(&mut self, now_ns: u64) {
        let going =
            !matches!(self.phase, Phase::Identify | Phase::Adopt | Phase::Look | Phase::Over | Phase::Reset);
        if self.stop
            && going
            && self.is_asked(Kind::Stop) == 0
            && self.axes.iter().all(|axis| axis.stopping.is_none())
        {
            let moves = self.moves();
            self.ask(&Request::Stop { moves }, 0, Kind::Stop);
        }
        match self.phase {
            _ if going && self.stop && self.phase != Phase::Run => {}
            Phase::Identify if self.asked.is_empty() => self.ask(&Request::Identify, 0, Kind::Identify),
            Phase::Adopt if self.asked.is_empty() => {
                self.ask(&Request::Adopt { dead_man_ms: self.dead_man_ms }, 0, Kind::Adopt);
            }
            Phase::Look => self.look(),
            Phase::Configure(n) if self.asked.is_empty() => self.configure(n),
            Phase::Prepare => self.prepare(),
            Phase::Load => {
                self.feed();
                let full = |axis: &HostAxis| axis.stream.taken() as usize >= QUEUE.min(axis.segments.len());
                self.status_every(now_ns, 10_000_000);
                if self.axes.iter().all(full) {
                    self.phase = Phase::Begin;
                }
                self.stop |= self.axes.iter().any(HostAxis::has_ended);
            }
            Phase::Begin if self.is_asked(Kind::Begin) == 0 => {
                if let Some(relation) = self.clocks.relation(now_ns) {
                    let at = relation.tick_at(now_ns + 250_000_000);
                    self.begin_at = Some(at);
                    let moves = self.moves();
                    self.ask(&Request::Begin { at, moves }, 0, Kind::Begin);
                }
            }
            Phase::Run => {
                self.change();
                self.feed();
                self.status_every(now_ns, 20_000_000);
                let over = |axis: &HostAxis| {
                    axis.status.is_some_and(|status| {
                        matches!(
                            status.state,
                            AxisState::Ended(_) | AxisState::Unconfigured | AxisState::Ready
                        )
                    })
                };
                if self.axes.iter().all(over) {
                    self.phase = Phase::Over;
                }
            }
            _ => {}
        }
    }

    fn look(&mut self) {
        if self.axes.iter().any(|axis| axis.status.is_none()) {
            for n in 0..self.axes.len() {
                if self.axes[n].status.is_none()
                    && !self.asked.values().any(|asked| *asked == (n, Kind::Status))
                {
                    self.ask(&Request::Status { axis: n as u8 }, n, Kind::Status);
                }
            }
            return;
        }
        let number = self.move_number;
        let known =
            self.axes.iter().filter(|axis| axis.status.is_some_and(|s| s.move_number == number)).count();
        let began = self.begin_at.is_some();
        for axis in &mut self.axes {
            let status = axis.status.unwrap();
            axis.configured = status.revision != 0;
            if status.move_number == number && axis.prepared && !matches!(status.state, AxisState::Ended(_)) {
                axis.stream.resume(status.next_segment, status.room).unwrap();
            }
        }
        let ended = self.axes.iter().any(|axis| matches!(axis.status.unwrap().state, AxisState::Ended(_)));
        let stopped = self.axes.iter().any(|axis| axis.stopping.is_some());
        self.phase = if stopped || (ended && known > 0) {
            // Whatever has not ended is stopped.
            self.stop = true;
            Phase::Run
        } else if began {
            if self.axes.iter().all(|axis| axis.status.unwrap().state == AxisState::Prepared) {
                Phase::Load
            } else {
                Phase::Run
            }
        } else if let Some(n) = self.axes.iter().position(|axis| !axis.configured) {
            Phase::Configure(n)
        } else {
            Phase::Prepare
        };
    }

    fn configure(&mut self, n: usize) {
        let axis = &mut self.axes[n];
        if axis.configured {
            self.phase = if n + 1 < self.axes.len() { Phase::Configure(n + 1) } else { Phase::Prepare };
            return;
        }
        let entries: Vec<_> = axis.plan.brake.climb().copied().collect();
        let first = axis.brake_sent;
        let (axis_number, revision) = (n as u8, 1);
        if !axis.config_sent {
            let mut config = AxisConfig::new(entries.len() as u8);
            config.enable_setup_ns = 100_000;
            self.ask(&Request::Configure { axis: axis_number, revision, config }, n, Kind::Configure);
            return;
        }
        let mut packed = [0; MAX_PACKED];
        let mut room = &mut packed[..];
        let mut codec = Codec::new(Grain::Exact);
        for entry in &entries[usize::from(first)..] {
            if codec.write(entry, &mut room).is_err() {
                break;
            }
        }
        let used = MAX_PACKED - room.len();
        let request = Request::Brake { axis: axis_number, revision, first, entries: &packed[..used] };
        self.ask(&request, n, Kind::Brake);
    }

    fn prepare(&mut self) {
        if self.axes.iter().all(|axis| axis.prepared) {
            self.phase = Phase::Load;
            return;
        }
        for n in 0..self.axes.len() {
            let axis = &mut self.axes[n];
            if axis.prepared || self.asked.values().any(|asked| *asked == (n, Kind::Prepare)) {
                continue;
            }
            if !axis.ordered {
                axis.ordered = true;
                axis.from = axis.status.unwrap().position;
                let brake_steps = axis.plan.brake.climb().map(|entry| entry.steps()).sum();
                axis.stream = Stream::new(axis.from);
                (axis.last, axis.farthest) = (axis.from + axis.plan.steps, axis.from + axis.plan.steps);
                axis.planned_from = axis.from;
                axis.bracket = Bracket::new(axis.from, axis.last, brake_steps);
                axis.pushed = 0;
                axis.push();
            }
            let order = MoveOrder {
                from: axis.from,
                last: axis.last,
                shortest_interval: axis.plan.shortest_interval,
            };
            let request = Request::Prepare { axis: n as u8, move_number: self.move_number, order };
            self.ask(&request, n, Kind::Prepare);
        }
    }

    /// Changes moves under way, and tells the node of changes that it has not accepted.
    fn change(&mut self) {
        for n in 0..self.axes.len() {
            let axis = &mut self.axes[n];
            if axis.tried < self.changes && !self.stop && axis.changes_now() {
                axis.change();
            }
            let told = axis.change.filter(|change| !change.accepted && !axis.has_ended() && !self.stop);
            let is_asked = self.asked.values().any(|asked| *asked == (n, Kind::Retarget));
            if let Some(change) = told.filter(|_| !is_asked) {
                let (axis, move_number) = (n as u8, self.move_number);
                let request = Request::Retarget { axis, move_number, change: change.order };
                self.ask(&request, n, Kind::Retarget);
            }
        }
    }

    /// Streams segments, of each axis one frame at a time and four at most.
    fn feed(&mut self) {
        for n in 0..self.axes.len() {
            let axis = &mut self.axes[n];
            let live = axis
                .status
                .is_none_or(|status| matches!(status.state, AxisState::Prepared | AxisState::Moving));
            axis.push();
            if !live
                || self.stop
                || self.asked.values().filter(|asked| asked.1 == Kind::Segments).count() >= 4
            {
                continue;
            }
            let axis = &mut self.axes[n];
            // Frames are small, so that a small plan takes many.
            let mut packed = [0; 40];
            if let Some(chunk) = axis.stream.chunk(&mut packed) {
                axis.bracket.sent(chunk.end);
                let request = Request::Segments {
                    axis: n as u8,
                    move_number: self.move_number,
                    first: chunk.first,
                    packed: &packed[..chunk.bytes],
                };
                self.ask(&request, n, Kind::Segments);
            }
        }
    }

    fn status_every(&mut self, now_ns: u64, every_ns: u64) {
        if now_ns < self.next_status_ns || self.is_asked(Kind::Status) > 0 {
            return;
        }
        self.next_status_ns = now_ns + every_ns;
        for n in 0..self.axes.len() {
            self.ask(&Request::Status { axis: n as u8 }, n, Kind::Status);
        }
    }

    /// Takes over the books of a host that was killed: the session, the order of the move and its bracket.
    pub(crate) fn inherit(&mut self, other: &Self) {
        self.phase = Phase::Look;
        self.stop = true;
        self.begin_at = other.begin_at;
        for (axis, before) in self.axes.iter_mut().zip(&other.axes) {
            axis.from = before.from;
            (axis.last, axis.farthest) = (before.last, before.farthest);
            axis.bracket = before.bracket;
        }
    }

    /// Says what has become of the dose, for a test that fails.
    pub(crate) fn story(&self) -> String {
        let states: Vec<_> =
            self.axes.iter().map(|axis| (axis.status, axis.stream.taken(), axis.stream.sent())).collect();
        format!("{:?} {states:?} {:?} {:?} lost {}", self.phase, self.asked, self.refusals.last(), self.lost)
    }

    /// Returns true if every move is complete.
    pub(crate) fn is_complete(&self) -> bool {
        let complete =
            |axis: &HostAxis| axis.status.is_some_and(|s| s.state == AxisState::Ended(End::Complete));
        self.phase == Phase::Over && self.axes.iter().all(complete)
    }
}
