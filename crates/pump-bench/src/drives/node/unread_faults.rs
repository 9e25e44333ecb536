//! Words for the faults that a board has counted since they were last read.

use pump_link::message::FaultCounts;

use crate::notice::Notice;

/// Returns the note on faults that the board has counted since they were last read.
pub(super) fn faults_noted(unread: FaultCounts) -> Option<Notice> {
    let kinds = [
        (unread.late, "late step", "late steps"),
        (unread.starved, "empty queue", "empty queues"),
        (unread.driver, "fault of the stepper driver", "faults of the stepper driver"),
        (
            unread.link,
            "stop for want of a word from the computer",
            "stops for want of a word from the computer",
        ),
        (unread.estop, "emergency stop", "emergency stops"),
    ];
    let counted = kinds.iter().filter(|(count, ..)| *count > 0);
    let named: Vec<String> = counted
        .map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many }))
        .collect();
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
        let one = format!("{begins}1 stop for want of a word from the computer");
        let several = format!("{begins}1 late step, 2 stops for want of a word from the computer");
        assert_eq!([said(0, 0), said(1, 0), said(2, 1)], [None, Some(one), Some(several)]);
    }
}
