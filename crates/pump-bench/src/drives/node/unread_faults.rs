//! Words for the faults that a board has counted since they were last read.

use pump_link::message::FaultCounts;

use crate::notice::Notice;

/// Returns the note on faults that the board has counted since they were last read.
pub(super) fn faults_noted(unread: FaultCounts) -> Option<Notice> {
    let kinds = [
        (unread.late, "late step", "late steps"),
        (unread.starved, "empty queue", "empty queues"),
        (
            unread.link,
            "stop because it heard nothing from the computer",
            "stops because it heard nothing from the computer",
        ),
        (unread.estop, "emergency stop", "emergency stops"),
    ];
    let counted = kinds.iter().filter(|(count, ..)| *count > 0);
    let mut named: Vec<String> = counted
        .map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many }))
        .collect();
    // The board sees a fault that lasts anew whenever it gives the motor current.
    if unread.driver > 0 {
        named.push("a fault of the stepper driver, or one that lasts and was met anew".to_owned());
    }
    (!named.is_empty()).then(|| {
        Notice::from(format!("the board has counted faults since they were last read: {}", named.join(", ")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_fault_is_named_in_the_singular_and_several_in_the_plural() {
        let said = |link, late| {
            faults_noted(FaultCounts { link, late, ..FaultCounts::default() })
                .map(|note| note.text().to_owned())
        };
        let begins = "the board has counted faults since they were last read: ";
        let one = format!("{begins}1 stop because it heard nothing from the computer");
        let several = format!("{begins}1 late step, 2 stops because it heard nothing from the computer");
        assert_eq!([said(0, 0), said(1, 0), said(2, 1)], [None, Some(one), Some(several)]);
    }

    #[test]
    fn a_drivers_fault_that_every_attempt_meets_is_not_counted() {
        for driver in [1, 3] {
            let note = faults_noted(FaultCounts { driver, ..FaultCounts::default() }).unwrap();
            assert!(
                note.text().ends_with(": a fault of the stepper driver, or one that lasts and was met anew")
            );
        }
    }
}
