//! An order whose process is silent, or does not answer a stop: everyone is told, and it is ended.

use jiff::{SignedDuration, Timestamp};

use super::service::Service;
use crate::order::OrderId;
use crate::shell::Failed;
use crate::worker::{ANSWERS_WITHIN, SILENT_AFTER, Sign, silent};

impl Service {
    /// Takes a sign of an order's process: shows it with the pump, notes it, and tells a person of a fault.
    pub(super) fn heed(&self, id: &OrderId, sign: Sign) {
        let (order, since, asked) = {
            let mut live = self.live();
            let Some(live) = live.get_mut(id) else { return };
            let since = live.silent_since.take();
            live.silent_since = match sign {
                Sign::Speaks => None,
                Sign::Silent(quiet) => {
                    Timestamp::now().checked_sub(SignedDuration::try_from(quiet).unwrap_or_default()).ok()
                }
                Sign::Unanswered | Sign::Killed | Sign::GoesOn => since,
            };
            (live.record.order.clone(), since, live.stop_asked)
        };
        let shown = self.pumps().filter(|pump| order.pump == pump.name() || self.is_ordered(pump));
        shown.for_each(|pump| self.tell("pump", &self.view(pump)));
        let what = format!("order {id} ({})", order.task.name());
        let text = match sign {
            Sign::Silent(_) => format!(
                "the process of {what} has not reported for {} s; its motor may still be turning: look at the \
                 pump, and stop it",
                SILENT_AFTER.as_secs()
            ),
            Sign::Speaks => {
                format!("the process of {what} speaks again, after {} s", seconds_since(since))
            }
            Sign::Unanswered => format!(
                "{what} has not stopped yet: its process has not answered for {} s, so the service ends it",
                ANSWERS_WITHIN.as_secs()
            ),
            // The end of the process is told as that of its order.
            Sign::Killed => return,
            Sign::GoesOn => format!(
                "{what} has not ended yet, {} s after its stop; if the motor turns, switch it off by hand",
                seconds_since(asked)
            ),
        };
        self.note("service", Some(&order.pump), &text);
        // Whoever was told of the silence knows that the process hangs; its end is told with its volume.
        let is_known = sign == Sign::Speaks || sign == Sign::Unanswered && since.is_some();
        if !is_known {
            self.alarm("service", Failed::of(&order, silent(&text), None));
        }
    }
}

fn seconds_since(time: Option<Timestamp>) -> i64 {
    time.map_or(0, |time| Timestamp::now().duration_since(time).as_secs())
}
