//! The speeds of pumps on one grbl board. A line gives all of them the time of the slowest, so the others are planned
//! again at the speed that it leaves them: the volume of a revolution may depend on it.

use pump_ctl::plan::Cruise;

use super::appointments::{appointments, meetings};
use super::timetable::{Timetable, Timing};
use crate::bench::SeriesRequest;
use crate::rack::error::RackError;
use crate::rack::rack::Rack;
use crate::rack::sharing::{is_one_line, not_one_line};

/// Largest part of its speed by which a pump may be planned at another one than its line gives it.
const NEARLY: f64 = 1e-3;

/// Most times that the pumps of a rack are planned again. One or two are usual: another speed changes the angle of a
/// volume by a few percent, and that angle the speed.
const MOST_ROUNDS: usize = 8;

/// Speed of each part of each pump that a line slows, in rad/s at the pump head. `None` keeps the pump's own.
#[derive(Debug)]
pub(in crate::rack) struct LineSpeeds(Vec<Vec<Option<f64>>>);

/// Part that is not planned at the speed of its line.
struct Slowed {
    pump: usize,
    part: usize,
    speed_rad_s: f64,
    /// Pump that sets the time of the line.
    leader: usize,
}

impl LineSpeeds {
    /// Lays out the steps by the pumps' own `timings`, and has `plan` plan those pumps again that their lines slow.
    /// It goes on until all are planned at the speeds that their lines give them. `plan` gets the speeds, the pumps,
    /// and the timings to change. Returns the timetable with its timings.
    ///
    /// # Errors
    ///
    /// [`RackError`] as for [`Timetable::of`], and that of `plan`. [`RackError::Shared`] for a part that cannot be
    /// planned at the speed of its line.
    pub(in crate::rack) fn settle(
        rack: &Rack,
        mut timings: Vec<Vec<Timing>>,
        mut plan: impl FnMut(&Self, &[usize], &mut [Vec<Timing>]) -> Result<(), RackError>,
    ) -> Result<(Timetable, Vec<Vec<Timing>>), RackError> {
        let mut speeds =
            Self((0..rack.members().len()).map(|pump| rack.parts(pump).map(|_| None).collect()).collect());
        let mut timetable = Timetable::of(rack.steps(), rack.members(), &timings)?;
        for _ in 0..MOST_ROUNDS {
            let slowed = speeds.slowed(rack, &timetable.begins_s, &timings);
            let parted = speeds.parted(rack, &timetable.begins_s);
            if slowed.is_empty() && parted.is_empty() {
                return Ok((timetable, timings));
            }
            let mut pumps: Vec<usize> =
                slowed.iter().map(|slowed| slowed.pump).chain(parted.iter().map(|(pump, _)| *pump)).collect();
            pumps.sort_unstable();
            pumps.dedup();
            for (pump, part) in parted {
                speeds.0[pump][part] = None;
            }
            for Slowed { pump, part, speed_rad_s, .. } in slowed {
                speeds.0[pump][part] = Some(speed_rad_s);
            }
            plan(&speeds, &pumps, &mut timings)?;
            timetable = Timetable::of(rack.steps(), rack.members(), &timings)?;
        }
        match speeds.slowed(rack, &timetable.begins_s, &timings).first() {
            None => Ok((timetable, timings)),
            Some(Slowed { pump, part, leader, .. }) => {
                let step = rack.parts(*pump).nth(*part).map_or(0, |step| step + 1);
                let why = format!("step {step} of the second cannot be planned at the speed of the line");
                Err(not_one_line(&rack.members()[*leader], &rack.members()[*pump], &why))
            }
        }
    }

    /// Returns the requests to a pump, with the speeds of its lines.
    pub(in crate::rack) fn requests(&self, rack: &Rack, pump: usize) -> Vec<SeriesRequest> {
        let mut requests = rack.requests(pump);
        for (asked, speed_rad_s) in requests.iter_mut().zip(&self.0[pump]) {
            if let Some(rad_s) = *speed_rad_s {
                asked.request = asked.request.with_cruise(Some(Cruise::Speed { rad_s }));
            }
        }
        requests
    }

    /// Returns the parts with the speed of a line that meet no other part of a line any more.
    fn parted(&self, rack: &Rack, begins_s: &[f64]) -> Vec<(usize, usize)> {
        let members = rack.members();
        let met = meetings(members, &appointments(rack, begins_s));
        let is_met = |pump: usize, part: usize| {
            met.iter().filter(|meeting| meeting.parts.contains(&(pump, part))).any(|meeting| {
                let others = meeting.parts.iter().filter(|(other, _)| *other != pump);
                others.into_iter().any(|(other, _)| is_one_line(&members[*other].bench, &members[pump].bench))
            })
        };
        let slowed = self.0.iter().enumerate().flat_map(|(pump, parts)| {
            parts.iter().enumerate().filter(|(_, speed)| speed.is_some()).map(move |(part, _)| (pump, part))
        });
        slowed.filter(|(pump, part)| !is_met(*pump, *part)).collect()
    }

    /// Returns the parts that are not planned at the speeds of their lines, in the order of the pumps.
    fn slowed(&self, rack: &Rack, begins_s: &[f64], timings: &[Vec<Timing>]) -> Vec<Slowed> {
        let members = rack.members();
        let mut slowed = Vec::new();
        for meeting in meetings(members, &appointments(rack, begins_s)) {
            let timing = |(pump, part): (usize, usize)| timings[pump][part];
            // The slowest pump keeps its own speed, and sets the time.
            let slowest = |parts: &mut dyn Iterator<Item = (usize, usize)>| {
                parts.max_by(|one, two| timing(*one).at_peak_s.total_cmp(&timing(*two).at_peak_s))
            };
            let all = || meeting.parts.iter().copied();
            let own = slowest(&mut all().filter(|(pump, part)| self.0[*pump][*part].is_none()));
            // Parts that other lines have slowed may meet here: the slowest of them sets the time.
            let Some(leader) = own.or_else(|| slowest(&mut all())) else { continue };
            let time_s = timing(leader).at_peak_s;
            for (pump, part) in meeting.parts {
                let Timing { turn_rad, at_peak_s, .. } = timings[pump][part];
                let is_followed = is_one_line(&members[leader.0].bench, &members[pump].bench);
                if (pump, part) != leader && is_followed && (at_peak_s / time_s - 1.0).abs() > NEARLY {
                    slowed.push(Slowed { pump, part, speed_rad_s: turn_rad / time_s, leader: leader.0 });
                }
            }
        }
        slowed.sort_by_key(|slowed| slowed.pump);
        slowed
    }
}
