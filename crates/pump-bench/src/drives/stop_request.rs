//! The user's request to stop, as every wait for a device hears it.

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// Question whether the user asked to stop.
///
/// Every wait for a device at rest asks it. A motion asks its gate instead, since it must decelerate first.
#[derive(Clone, Default)]
pub struct StopRequest {
    asked: Option<Arc<dyn Fn() -> bool + Send + Sync>>,
    cause: Option<Arc<dyn Fn() -> Option<String> + Send + Sync>>,
    by_others: Option<Arc<dyn Fn() -> bool + Send + Sync>>,
}

impl StopRequest {
    /// Returns a request that is made as soon as `asked` returns true.
    pub fn new(asked: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self { asked: Some(Arc::new(asked)), ..Self::default() }
    }

    /// Returns the request that says who or what made it, as `SIGINT`. The log keeps it for a motion that was stopped.
    ///
    /// ```
    /// use pump_bench::drives::StopRequest;
    ///
    /// let stop = StopRequest::new(|| true).saying(|| Some("SIGTERM".to_owned()));
    /// assert_eq!(stop.cause().as_deref(), Some("SIGTERM"));
    /// ```
    #[must_use]
    pub fn saying(self, cause: impl Fn() -> Option<String> + Send + Sync + 'static) -> Self {
        Self { cause: Some(Arc::new(cause)), ..self }
    }

    /// Returns the request that `by_others` says is that of another pump's fault, and not the user's. A motion that it
    /// ends before the first step leaves no unfinished dose.
    #[must_use]
    pub(crate) fn by_others(self, by_others: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self { by_others: Some(Arc::new(by_others)), ..self }
    }

    /// Returns true if the request is made, and by the fault of another pump.
    pub(crate) fn is_by_others(&self) -> bool {
        self.is_made() && self.by_others.as_ref().is_some_and(|by_others| by_others())
    }

    /// Returns true if the user asked to stop.
    pub fn is_made(&self) -> bool {
        self.asked.as_ref().is_some_and(|asked| asked())
    }

    /// Returns who or what made the request. `None` if nobody says.
    pub fn cause(&self) -> Option<String> {
        self.cause.as_ref().and_then(|cause| cause())
    }
}

impl Debug for StopRequest {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.debug_tuple("StopRequest").field(&self.is_made()).finish()
    }
}

impl PartialEq for StopRequest {
    fn eq(&self, other: &Self) -> bool {
        match (&self.asked, &other.asked) {
            (None, None) => true,
            (Some(one), Some(two)) => Arc::ptr_eq(one, two),
            _ => false,
        }
    }
}
