//! A host of several axes: one request at a time, and moves that begin together.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use pump_bench::drives::wire::Wire;
use pump_ctl::step::{Brake, Segment, TickRate};
use pump_link::frame::{AnswerHeader, Deframer, Encoded, RequestHeader, body};
use pump_link::message::{
    AXES, Answer, AxisConfig, AxisState, AxisStatus, Identity, MAX_PACKED, MoveOrder, Refusal, Request,
};
use pump_link::packing::{Codec, Grain, Rounder};
use pump_link::sender::Stream;

use super::emulator::Emulator;
use super::noise::Noise;

/// Session of this host.
const SESSION: u64 = 0x5e55_1011;

/// Longest wait for an answer before the request is sent again.
const RESEND: Duration = Duration::from_millis(50);

/// Number of times that a request is sent.
const SENDS: u32 = 10;

/// Time from the last answer to the tick at which moves begin, ticks.
const BEGIN: u64 = 5_000;

/// Segments that are held until the board has taken them.
const HELD: usize = 256;

/// Host of several axes.
pub(crate) struct Host {
    pub(crate) emulator: Emulator,
    pub(crate) identity: Identity,
    number: u16,
    deframer: Deframer,
    /// Tick at which the board took the last request.
    heard_at: u64,
    /// Changes of bytes on the line.
    pub(crate) noise: Option<Noise>,
}

/// Move of an axis.
#[derive(Debug, Clone)]
pub(crate) struct Move {
    pub(crate) axis: u8,
    /// Segments, rounded as the link does.
    pub(crate) segments: Vec<Segment>,
}

impl Move {
    /// Makes the move of these segments.
    pub(crate) fn new(axis: u8, segments: impl IntoIterator<Item = Segment>) -> Result<Self, Box<dyn Error>> {
        let mut rounder = Rounder::default();
        let segments =
            segments.into_iter().map(|segment| rounder.round(segment)).collect::<Result<_, _>>()?;
        Ok(Self { axis, segments })
    }

    /// Returns the signed steps of the move.
    pub(crate) fn steps(&self) -> i64 {
        self.segments.iter().map(|segment| i64::from(segment.count)).sum()
    }

    /// Returns the shortest interval between two steps, ticks.
    pub(crate) fn shortest_interval(&self) -> u32 {
        let ends = |s: &Segment| s.interval_before(1).whole.min(s.interval_before(s.steps()).whole);
        self.segments.iter().map(ends).min().map_or(u32::MAX, |ticks| ticks as u32)
    }

    /// Returns the times at which the steps are due after the begin, in ticks.
    pub(crate) fn times(&self) -> Vec<f64> {
        let mut times = Vec::new();
        let mut now = 0.5;
        for segment in &self.segments {
            let first = segment.interval as f64 + f64::from(segment.frac) / 2_f64.powi(32);
            for k in 0..segment.steps() {
                now += first + segment.add as f64 / 2_f64.powi(32) * f64::from(k);
                times.push(now);
            }
        }
        times
    }
}

impl Host {
    /// Meets a board that was just switched on, and sets its dead-man time.
    pub(crate) fn new(firmware: &Path, dead_man_ms: u16) -> Result<Self, Box<dyn Error>> {
        Self::over(Emulator::new(firmware)?, dead_man_ms)
    }

    /// Meets a board that was just switched on, by the port that its emulator has, and sets its dead-man time.
    pub(crate) fn over(emulator: Emulator, dead_man_ms: u16) -> Result<Self, Box<dyn Error>> {
        let mut host = Self {
            emulator,
            identity: Identity::new(0, [0; 3], 0, 0, 0, 0),
            number: 0,
            deframer: Deframer::new(),
            heard_at: 0,
            noise: None,
        };
        let Answer::Identity(identity) = host.ask(&Request::Identify)? else {
            return Err("the board does not say who it is".into());
        };
        host.identity = identity;
        host.adopt(dead_man_ms)?;
        Ok(host)
    }

    /// Gives the board the session.
    pub(crate) fn adopt(&mut self, dead_man_ms: u16) -> Result<(), Box<dyn Error>> {
        match self.ask(&Request::Adopt { dead_man_ms })? {
            Answer::Adopted => Ok(()),
            other => Err(format!("the session was not adopted: {other:?}").into()),
        }
    }

    /// Returns the frame of a request, under a new number.
    pub(crate) fn frame(&mut self, request: &Request<'_>) -> Result<Vec<u8>, Box<dyn Error>> {
        self.number = self.number.wrapping_add(1);
        let header = RequestHeader { number: self.number, session: SESSION };
        Ok(Encoded::request(header, request)?.bytes().to_vec())
    }

    /// Sends a request until its answer is there.
    pub(crate) fn ask(&mut self, request: &Request<'_>) -> Result<Answer, Box<dyn Error>> {
        let frame = self.frame(request)?;
        for _ in 0..SENDS {
            let mut bytes = frame.clone();
            if let Some(noise) = &mut self.noise {
                noise.pass(0, &mut bytes);
            }
            self.emulator.write(&bytes)?;
            let until = self.emulator.now() + RESEND;
            while self.emulator.now() < until {
                let mut bytes = [0; 512];
                let read = self.emulator.read(&mut bytes, RESEND)?;
                let bytes = bytes.get_mut(..read).unwrap_or_default();
                if let Some(noise) = &mut self.noise {
                    noise.pass(1, bytes);
                }
                for byte in bytes {
                    let Some(Ok(payload)) = self.deframer.push(*byte) else { continue };
                    let (header, rest) = AnswerHeader::split(payload)?;
                    if header.number == self.number {
                        self.heard_at = header.received_at;
                        return Ok(body(rest)?);
                    }
                }
            }
        }
        Err(format!("the board does not answer {request:?}").into())
    }

    /// Configures an axis with a brake.
    pub(crate) fn configure(&mut self, axis: u8, brake: &Brake) -> Result<(), Box<dyn Error>> {
        let entries: Vec<_> = brake.climb().copied().collect();
        let mut config = AxisConfig::new(entries.len() as u8);
        config.energised = true;
        let mut first = self.configured(&Request::Configure { axis, revision: 1, config })?;
        while first < entries.len() {
            let mut packed = [0; MAX_PACKED];
            let mut room = &mut packed[..];
            let mut codec = Codec::new(Grain::Exact);
            let rest = entries.get(first..).unwrap_or_default();
            let written = rest.iter().take_while(|entry| codec.write(entry, &mut room).is_ok()).count();
            let used = MAX_PACKED - room.len();
            let entries = packed.get(..used).unwrap_or_default();
            first = self
                .configured(&Request::Brake { axis, revision: 1, first: first as u8, entries })?
                .max(first + written);
        }
        Ok(())
    }

    fn configured(&mut self, request: &Request<'_>) -> Result<usize, Box<dyn Error>> {
        match self.ask(request)? {
            Answer::Configured { brake_entries } => Ok(brake_entries.into()),
            other => Err(format!("the axis was not configured: {other:?}").into()),
        }
    }

    /// Returns the state of an axis.
    pub(crate) fn status(&mut self, axis: u8) -> Result<AxisStatus, Box<dyn Error>> {
        match self.ask(&Request::Status { axis })? {
            Answer::Status(status) => Ok(status),
            other => Err(format!("the axis has no state: {other:?}").into()),
        }
    }

    /// Prepares a move. The answer may be a refusal.
    pub(crate) fn prepare(&mut self, number: u32, made: &Move) -> Result<Answer, Box<dyn Error>> {
        let from = self.status(made.axis)?.position;
        let order =
            MoveOrder { from, last: from + made.steps(), shortest_interval: made.shortest_interval() };
        self.ask(&Request::Prepare { axis: made.axis, move_number: number, order })
    }

    /// Begins a move with its first segments, and sends no more. Returns false if the board refused it, as it does
    /// where too much was lost on the line.
    pub(crate) fn begin(
        &mut self,
        number: u32,
        made: &Move,
        segments: usize,
    ) -> Result<bool, Box<dyn Error>> {
        let Answer::Accepted { next, room } = self.prepare(number, made)? else { return Ok(false) };
        let mut stream = Box::new(Stream::<HELD>::new(0));
        stream.accepted(next, room)?;
        for segment in made.segments.iter().take(segments) {
            stream.push(*segment)?;
        }
        let mut packed = [0; MAX_PACKED];
        let chunk = stream.chunk(&mut packed).ok_or("the move has no segments")?;
        let packed = packed.get(..chunk.bytes).unwrap_or_default();
        let request = Request::Segments { axis: made.axis, move_number: number, first: chunk.first, packed };
        if !matches!(self.ask(&request)?, Answer::Accepted { .. }) {
            return Ok(false);
        }
        let mut moves = [0; AXES];
        *moves.get_mut(usize::from(made.axis)).ok_or("no such axis")? = number;
        loop {
            match self.begin_moves(moves)? {
                Answer::Begun => return Ok(true),
                // The request was lost until its tick was past.
                Answer::Refused(Refusal::Begin { .. }) => {}
                _ => return Ok(false),
            }
        }
    }

    /// Begins moves that are loaded.
    pub(crate) fn begin_moves(&mut self, moves: [u32; AXES]) -> Result<Answer, Box<dyn Error>> {
        let at = self.heard_at + BEGIN;
        self.ask(&Request::Begin { at, moves })
    }

    /// Makes moves that begin at one tick, and feeds them until all motors stand. Returns the tick, and how each
    /// move ended.
    pub(crate) fn make(
        &mut self,
        number: u32,
        moves: &[Move],
    ) -> Result<(u64, Vec<AxisState>), Box<dyn Error>> {
        let mut streams = Vec::new();
        for made in moves {
            let Answer::Accepted { next, room } = self.prepare(number, made)? else {
                return Err("the move was refused".into());
            };
            let mut stream = Box::new(Stream::<HELD>::new(0));
            stream.accepted(next, room)?;
            streams.push((made, stream, made.segments.iter()));
        }
        // Each queue is filled before the begin.
        while self.feed(number, &mut streams)? {}
        let mut named = [0; AXES];
        moves.iter().for_each(|made| named[usize::from(made.axis)] = number);
        let at = self.heard_at + BEGIN;
        match self.ask(&Request::Begin { at, moves: named })? {
            Answer::Begun => {}
            other => return Err(format!("the moves did not begin: {other:?}").into()),
        }
        loop {
            self.feed(number, &mut streams)?;
            let mut states = Vec::new();
            for (made, stream, _) in &mut streams {
                let status = self.status(made.axis)?;
                if status.state == AxisState::Moving {
                    stream.accepted(status.next_segment, status.room)?;
                }
                states.push(status.state);
            }
            if states.iter().all(|state| matches!(state, AxisState::Ended(_))) {
                return Ok((at, states));
            }
        }
    }

    /// Sends a frame of segments to each axis that has room. Returns false if none was sent.
    fn feed<'a>(&mut self, number: u32, streams: &mut [Feed<'a>]) -> Result<bool, Box<dyn Error>> {
        let mut sent = false;
        for (made, stream, segments) in streams {
            while stream.room() > 0 {
                let Some(segment) = segments.next() else { break };
                stream.push(*segment)?;
            }
            let mut packed = [0; MAX_PACKED];
            let Some(chunk) = stream.chunk(&mut packed) else { continue };
            let packed = packed.get(..chunk.bytes).unwrap_or_default();
            let request =
                Request::Segments { axis: made.axis, move_number: number, first: chunk.first, packed };
            match self.ask(&request)? {
                Answer::Accepted { next, room } => stream.accepted(next, room)?,
                other => return Err(format!("segments were refused: {other:?}").into()),
            }
            sent = true;
        }
        Ok(sent)
    }
}

/// Move with its segments on the way.
type Feed<'a> = (&'a Move, Box<Stream<HELD>>, std::slice::Iter<'a, Segment>);

/// Rate of the board's timer.
pub(crate) const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();
