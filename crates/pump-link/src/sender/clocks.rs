//! The relation of the host's clock to the node's timer.

/// Number of round trips that are kept.
const SAMPLES: usize = 16;

/// Largest difference of the two clocks' rates, ns a second: two crystals of 50 ppm.
const DRIFT_NS_PER_S: u64 = 100_000;

const NS_PER_S: u64 = 1_000_000_000;

/// A round trip: the node's tick lies somewhere between the two times.
#[derive(Debug, Clone, Copy)]
struct Sample {
    middle_ns: u64,
    half_ns: u64,
    tick: u64,
}

impl Sample {
    /// Returns the largest error of the relation at `now_ns`, ns.
    fn error_ns(&self, now_ns: u64) -> u64 {
        let age_ns = u128::from(now_ns.abs_diff(self.middle_ns));
        let drift_ns = age_ns * u128::from(DRIFT_NS_PER_S) / u128::from(NS_PER_S);
        self.half_ns.saturating_add(u64::try_from(drift_ns).unwrap_or(u64::MAX))
    }
}

/// The clocks of both ends, related by round trips. The shortest is the best, until it is old.
///
/// ```
/// use pump_link::sender::Clocks;
///
/// let mut clocks = Clocks::new(1_000_000);
/// // A slow round trip of 40 ms, then one of 2 ms; the node counts 5 s more than the host.
/// clocks.observe(0, 40_000_000, 5_035_000);
/// clocks.observe(100_000_000, 102_000_000, 5_101_300);
/// let relation = clocks.relation(110_000_000).unwrap();
/// assert_eq!(relation.tick_at(111_000_000), 5_111_300);
/// assert_eq!(relation.ns_at(5_111_300), 111_000_000);
/// assert!(relation.error_ns < 1_001_000);
/// ```
#[derive(Debug, Clone)]
pub struct Clocks {
    tick_hz: u32,
    samples: [Option<Sample>; SAMPLES],
    next: usize,
}

/// A tick of the node's timer and the host's time at which it came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Relation {
    /// Rate of the node's timer, Hz.
    pub tick_hz: u32,
    /// Tick of the node's timer.
    pub tick: u64,
    /// Time of the host at that tick, ns.
    pub ns: u64,
    /// Largest error of the relation at the time that it was asked for, ns.
    pub error_ns: u64,
}

impl Clocks {
    /// Makes the clocks of a node whose timer has this rate.
    pub const fn new(tick_hz: u32) -> Self {
        Self { tick_hz, samples: [None; SAMPLES], next: 0 }
    }

    /// Takes a round trip: the request was sent and the answer arrived at these times of the host, ns, and the
    /// request arrived at this tick of the node.
    pub fn observe(&mut self, sent_ns: u64, answered_ns: u64, tick: u64) {
        let half_ns = answered_ns.saturating_sub(sent_ns).div_ceil(2);
        let sample = Sample { middle_ns: sent_ns.saturating_add(half_ns), half_ns, tick };
        if let Some(place) = self.samples.get_mut(self.next % SAMPLES) {
            *place = Some(sample);
        }
        self.next = (self.next + 1) % SAMPLES;
    }

    /// Returns the best relation for times about `now_ns`, or `None` before the first round trip.
    pub fn relation(&self, now_ns: u64) -> Option<Relation> {
        let best = self.samples.iter().flatten().min_by_key(|sample| sample.error_ns(now_ns))?;
        Some(Relation {
            tick_hz: self.tick_hz,
            tick: best.tick,
            ns: best.middle_ns,
            error_ns: best.error_ns(now_ns),
        })
    }

    /// Forgets all round trips, as after a reset of the node.
    pub fn clear(&mut self) {
        self.samples = [None; SAMPLES];
    }
}

impl Relation {
    /// Returns the tick of the node's timer at a time of the host, ns.
    pub fn tick_at(&self, ns: u64) -> u64 {
        let ticks = i128::from(ns) - i128::from(self.ns);
        moved(self.tick, ticks * i128::from(self.tick_hz) / i128::from(NS_PER_S))
    }

    /// Returns the time of the host at a tick of the node's timer, ns.
    pub fn ns_at(&self, tick: u64) -> u64 {
        let ticks = i128::from(tick) - i128::from(self.tick);
        moved(self.ns, ticks * i128::from(NS_PER_S) / i128::from(self.tick_hz.max(1)))
    }
}

fn moved(from: u64, by: i128) -> u64 {
    let to = i128::from(from) + by;
    u64::try_from(to.max(0)).unwrap_or(u64::MAX)
}
