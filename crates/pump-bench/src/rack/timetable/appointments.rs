//! The appointments of a rack: when each part of a pump begins, and with which axes of its board.

use std::time::Duration;

use crate::drives::{BeginPlace, CommonBegin};
use crate::pump_file::DriverName;
use crate::rack::member::Member;
use crate::rack::rack::Rack;
use crate::rack::sharing::is_one_board;

/// Longest time for which axes that begin together wait for each other.
const LIMIT: Duration = Duration::from_secs(5);

/// Begin of a part.
#[derive(Debug)]
pub(in crate::rack) struct Appointment {
    /// Time of the rack, in s.
    pub(in crate::rack) begin_s: f64,
    /// Place among the axes or boards that begin at this time.
    pub(in crate::rack) place: Option<BeginPlace>,
}

/// Parts that begin together at one time: those of one board, or of several boards with clocks that are followed.
pub(super) struct Meeting {
    board: usize,
    begin_s: f64,
    /// Number of the pump and of the part of each.
    pub(super) parts: Vec<(usize, usize)>,
}

/// Makes the appointments of each pump. `begins_s` are the times of the steps.
pub(in crate::rack) fn appointments(rack: &Rack, begins_s: &[f64]) -> Vec<Vec<Appointment>> {
    let pumps = 0..rack.members().len();
    let of_pump = |pump| {
        let begins = rack.parts(pump).map(|step| Appointment { begin_s: begins_s[step], place: None });
        begins.collect::<Vec<_>>()
    };
    let mut all: Vec<_> = pumps.map(of_pump).collect();
    for meeting in meetings(rack.members(), &all).into_iter().filter(|meeting| meeting.parts.len() > 1) {
        let count = meeting.parts.len();
        let places = match is_of_one_board(rack.members(), &meeting) {
            true => CommonBegin::places(count, LIMIT),
            false => CommonBegin::places_of_boards(count, LIMIT),
        };
        for ((pump, part), place) in meeting.parts.into_iter().zip(places) {
            all[pump][part].place = Some(place);
        }
    }
    all
}

/// Returns the parts that begin together. Those that begin alone are meetings of one.
pub(super) fn meetings(members: &[Member], appointments: &[Vec<Appointment>]) -> Vec<Meeting> {
    let mut meetings: Vec<Meeting> = Vec::new();
    for (pump, (member, appointments)) in members.iter().zip(appointments).enumerate() {
        let Some(board) = board(members, member) else { continue };
        for (part, Appointment { begin_s, .. }) in appointments.iter().enumerate() {
            let same = |meeting: &&mut Meeting| meeting.board == board && meeting.begin_s == *begin_s;
            match meetings.iter_mut().find(same) {
                Some(meeting) => meeting.parts.push((pump, part)),
                None => meetings.push(Meeting { board, begin_s: *begin_s, parts: vec![(pump, part)] }),
            }
        }
    }
    meetings
}

/// Returns true if one board turns all pumps of a meeting.
fn is_of_one_board(members: &[Member], meeting: &Meeting) -> bool {
    let mut benches = meeting.parts.iter().filter_map(|(pump, _)| Some(&members.get(*pump)?.bench));
    benches.next().is_none_or(|first| benches.all(|other| is_one_board(first, other)))
}

/// Returns the number of the first pump that begins together with a pump: on its board, or on any board that makes each
/// step at its time. `None` if the board begins nothing together.
fn board(members: &[Member], member: &Member) -> Option<usize> {
    let begins_together =
        !member.bench.is_simulated() && member.bench.identity().abilities.together.is_some();
    let has_clock = |member: &Member| {
        let driver = member.bench.drive().driver;
        !member.bench.is_simulated() && matches!(driver, DriverName::Klipper | DriverName::Node)
    };
    let first = members
        .iter()
        .position(|other| is_one_board(&other.bench, &member.bench) || has_clock(other) && has_clock(member));
    first.filter(|_| begins_together)
}
