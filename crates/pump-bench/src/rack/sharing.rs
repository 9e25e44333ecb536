//! Claims of two pumps of a rack on one thing: a record, an axis, or a board that moves its axes only as one line.

use super::error::RackError;
use super::member::Member;
use super::step::RackStep;
use crate::bench::Bench;
use crate::drives::Together;
use crate::files::is_one_file;
use crate::pump_file::DriverName;

/// Way out for pumps of one board that it cannot turn together.
const NODE_INSTEAD: &str =
    "give each pump a board of its own, or the axes of a node (driver = \"node\"; docs/node.md)";

/// Refuses the first two pumps that share a record or an axis, or axes of a grbl board that are to follow a flow over
/// time or their rollers.
pub(super) fn check(members: &[Member], steps: &[RackStep]) -> Result<(), RackError> {
    for (number, member) in members.iter().enumerate() {
        for (before, other) in members[..number].iter().enumerate() {
            if let Some((shared, instead)) = shared(&other.bench, &member.bench) {
                let (pump, other) = (other.name.clone(), member.name.clone());
                return Err(RackError::Shared { pump, other, shared, instead });
            }
            if is_one_line(&other.bench, &member.bench)
                && let Some(why) = off_line(steps, [before, number])
            {
                return Err(not_one_line(other, member, &why));
            }
        }
    }
    Ok(())
}

/// Returns the reason why the first step of two pumps is no line of constant ratio.
fn off_line(steps: &[RackStep], pumps: [usize; 2]) -> Option<String> {
    (1..).zip(steps).find_map(|(number, step)| {
        let mut flows = step.flows.iter().filter(|flow| pumps.contains(&flow.pump)).peekable();
        flows.peek()?;
        match flows.any(|flow| flow.profile.is_some()) {
            true => Some(format!("step {number} is a flow over time")),
            false if step.smooth => Some(format!("step {number} is smooth")),
            false => None,
        }
    })
}

/// Returns true if two pumps are axes of a board that moves its axes only as one line.
pub(super) fn is_one_line(one: &Bench, other: &Bench) -> bool {
    one.identity().abilities.together == Some(Together::Line) && is_one_board(one, other)
}

/// Returns the refusal of two pumps on a grbl board.
pub(super) fn not_one_line(one: &Member, other: &Member, why: &str) -> RackError {
    let port = one.bench.board_port().map(|port| format!(", at {}", port.display())).unwrap_or_default();
    let shared = format!(
        "are axes of one grbl board{port}, which moves its axes only as one line of constant ratio, and {why}"
    );
    let (pump, other) = (one.name.clone(), other.name.clone());
    RackError::Shared { pump, other, shared, instead: NODE_INSTEAD }
}

/// Returns the thing that two pumps share, and the way out.
fn shared(one: &Bench, other: &Bench) -> Option<(String, &'static str)> {
    if one.folder() == other.folder() {
        let shared = format!("are one pump, `{}`", one.file().pump.id);
        return Some((shared, "name each pump once, or give each file a [pump] id of its own"));
    }
    if !is_one_board(one, other) {
        return None;
    }
    let (port, axis) = (one.board_port()?.display(), one.drive().axis);
    let (driver, other_driver) = (one.drive().driver, other.drive().driver);
    if driver != other_driver {
        let shared = format!("are turned by {driver} and {other_driver} at one port, {port}");
        return Some((shared, "give each board its own port"));
    }
    if driver == DriverName::Klipper {
        let (one, other) = one.drive().klipper.as_ref().zip(other.drive().klipper.as_ref())?;
        let pin = one.clash(other)?;
        let shared = format!("are turned by one board at {port}, and both by the {pin}");
        return Some((shared, "name the pins of each pump in its [drive.klipper]"));
    }
    if axis == other.drive().axis {
        return Some((
            format!("name one axis, {axis} at {port}"),
            "name the axis of each pump in its [drive]",
        ));
    }
    None
}

/// Has each pump know of the others that the same board turns, and of other boards.
pub(super) fn beside_each_other(members: Vec<Member>) -> Vec<Member> {
    let known: Vec<_> = (0..members.len())
        .map(|number| {
            let real = |member: &&Member| !member.bench.is_simulated();
            let others = members.iter().enumerate().filter(|(other, _)| *other != number);
            let (here, elsewhere): (Vec<_>, Vec<_>) = others
                .map(|(_, member)| member)
                .filter(real)
                .partition(|other| is_one_board(&other.bench, &members[number].bench));
            let table = |other: &Member| (other.bench.file().pump.id.clone(), other.bench.drive().clone());
            (here.into_iter().map(table).collect(), !elsewhere.is_empty())
        })
        .collect();
    let pairs = members.into_iter().zip(known);
    pairs
        .map(|(Member { name, bench }, (here, elsewhere))| Member {
            name,
            bench: bench.in_rack(here, elsewhere),
        })
        .collect()
}

/// Returns true if boards at one port turn both pumps. No board turns a simulated pump.
pub(super) fn is_one_board(one: &Bench, other: &Bench) -> bool {
    let ports = one.board_port().zip(other.board_port());
    ports.is_some_and(|(port, at)| port == at || is_one_file(port, at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dosing::FlowProfile;
    use crate::rack::step::{Begin, Flow};
    use crate::record::ShortText;

    #[test]
    fn every_flow_of_every_step_is_looked_at() {
        let profile = FlowProfile::from_columns("ramp", &[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]);
        let asked = ShortText::new("1 mL");
        let flow = |pump, profile| Flow { pump, asked, volume_ml: 1.0, rate_ml_s: None, profile };
        let step = |flows, smooth| RackStep { begin: Begin::After { time_s: 0.0 }, flows, smooth };
        let dose = || step(vec![flow(0, None), flow(1, None)], false);
        let mixed = step(vec![flow(0, None), flow(1, Some(profile.unwrap()))], false);
        let told = off_line(&[dose(), mixed], [0, 1]);
        assert_eq!(told.as_deref(), Some("step 2 is a flow over time"));
        let smooth = step(vec![flow(1, None)], true);
        assert_eq!(off_line(&[dose(), dose(), smooth], [0, 1]).as_deref(), Some("step 3 is smooth"));
        let other = step(vec![flow(2, None)], true);
        assert_eq!(off_line(&[dose(), other], [0, 1]), None);
    }
}
