//! The wait for a pump or a port that another process holds.

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::dosing::DoseError;
use crate::drives::{DriveError, StopRequest};
use crate::numbers::significant;
use crate::record::FolderError;

/// Time between two tries.
const TRY_EVERY: Duration = Duration::from_millis(100);

/// Time between two looks for a stop.
const SLICE: Duration = Duration::from_millis(10);

/// Words for a person, given to whoever shows them.
type Tell = Arc<dyn Fn(&str) + Send + Sync>;

/// Patience with another process that holds the pump or its port. None by default.
#[derive(Clone, Default)]
pub(in crate::bench) struct Patience {
    /// Time that is left to wait.
    left: Duration,
    /// Told for whom is waited, once for each holder.
    tell: Option<Tell>,
}

impl Patience {
    /// Makes the patience to wait for `limit` in all. `tell` is told for whom.
    pub(in crate::bench) fn new(limit: Duration, tell: impl Fn(&str) + Send + Sync + 'static) -> Self {
        Self { left: limit, tell: Some(Arc::new(tell)) }
    }

    /// Tries until another process no longer holds what is needed, the time is over, or the user asks to stop.
    pub(in crate::bench) fn try_until<T>(
        &mut self,
        stop: &StopRequest,
        mut attempt: impl FnMut() -> Result<T, DoseError>,
    ) -> Result<T, DoseError> {
        let mut told = None;
        loop {
            let (began, limit) = (Instant::now(), self.left);
            let tried = attempt();
            let Some(held) = tried.as_ref().err().and_then(held_by) else { return tried };
            // A try that asks a device takes time too.
            self.left = limit.saturating_sub(began.elapsed());
            if self.left.is_zero() {
                return tried;
            }
            if told.as_ref() != Some(&held) {
                let limit_s = significant(limit.as_secs_f64(), 4);
                self.tell.iter().for_each(|tell| tell(&format!("waiting for {held}, {limit_s} s at most")));
                told = Some(held);
            }
            let (waits, wait) = (Instant::now(), TRY_EVERY.min(self.left));
            while waits.elapsed() < wait {
                if stop.is_made() {
                    return Err(DoseError::Connection(DriveError::Interrupted));
                }
                sleep(SLICE.min(wait.saturating_sub(waits.elapsed())));
            }
            self.left = self.left.saturating_sub(waits.elapsed());
        }
    }
}

/// Returns what another process holds and who it is, in words. `None` for any other error.
fn held_by(error: &DoseError) -> Option<String> {
    match error {
        DoseError::Folder(FolderError::Busy { pump, holder, .. }) => {
            Some(format!("pump `{pump}`, in use by {holder}"))
        }
        DoseError::Connection(DriveError::Busy { device, holder }) => {
            Some(format!("{}, in use by {holder}", device.display()))
        }
        _ => None,
    }
}

impl Debug for Patience {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.debug_tuple("Patience").field(&self.left).finish()
    }
}

impl PartialEq for Patience {
    fn eq(&self, other: &Self) -> bool {
        self.left == other.left
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    fn busy(holder: &str) -> DoseError {
        DoseError::Connection(DriveError::Busy { device: "/dev/ttyUSB0".into(), holder: holder.to_owned() })
    }

    #[test]
    fn a_wait_ends_with_the_holder_and_says_once_for_whom_it_is() {
        let told = Arc::new(Mutex::new(Vec::new()));
        let says = Arc::clone(&told);
        let mut patience =
            Patience::new(Duration::from_secs(600), move |text| says.lock().unwrap().push(text.to_owned()));
        let mut holders = vec!["process 2", "process 1", "process 1"];
        let tried = patience
            .try_until(&StopRequest::default(), || holders.pop().map_or(Ok(7), |holder| Err(busy(holder))));
        assert_eq!(tried.unwrap(), 7);
        let told = told.lock().unwrap();
        assert_eq!(told[0], "waiting for /dev/ttyUSB0, in use by process 1, 600 s at most");
        assert!(told.len() == 2 && told[1].contains("process 2"), "{told:?}");
    }

    #[test]
    fn a_wait_ends_at_its_time_and_at_a_stop_and_no_other_error_is_waited_for() {
        let mut patience = Patience::new(Duration::from_millis(30), |_| {});
        let late = patience.try_until::<()>(&StopRequest::default(), || Err(busy("process 1")));
        assert!(late.unwrap_err().to_string().contains("process 1"));
        // Tries that take time count.
        let mut patience = Patience::new(Duration::from_millis(200), |_| {});
        let mut tries = 0;
        let slow = patience.try_until::<()>(&StopRequest::default(), || {
            tries += 1;
            sleep(Duration::from_millis(250));
            Err(busy("process 1"))
        });
        assert!(slow.is_err() && tries == 1, "{tries} tries");
        let mut patience = Patience::new(Duration::from_secs(600), |_| {});
        let stopped = patience.try_until::<()>(&StopRequest::new(|| true), || Err(busy("process 1")));
        assert!(stopped.unwrap_err().is_stop());
        let other = patience.try_until::<()>(&StopRequest::default(), || Err(DoseError::WasFinished));
        assert!(matches!(other, Err(DoseError::WasFinished)));
    }
}
