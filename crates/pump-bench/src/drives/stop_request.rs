//! The user's request to stop, as every wait for a device hears it.

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// Question whether the user asked to stop.
///
/// Every wait for a device at rest asks it. A motion asks its gate instead, since it must decelerate first.
#[derive(Clone, Default)]
pub struct StopRequest(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl StopRequest {
    /// Returns a request that is made as soon as `asked` returns true.
    pub fn new(asked: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(asked)))
    }

    /// Returns true if the user asked to stop.
    pub fn is_made(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked())
    }
}

impl Debug for StopRequest {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.debug_tuple("StopRequest").field(&self.is_made()).finish()
    }
}

impl PartialEq for StopRequest {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (None, None) => true,
            (Some(one), Some(two)) => Arc::ptr_eq(one, two),
            _ => false,
        }
    }
}
