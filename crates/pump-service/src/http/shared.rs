//! The parts that every request shares.

use std::sync::Arc;

use super::access::Access;
use crate::guard::Guard;
use crate::runner::Runner;
use crate::service::Service;

/// Parts that every request shares.
#[derive(Debug, Clone)]
pub(super) struct Shared {
    pub(super) service: Service,
    pub(super) access: Arc<Access>,
    pub(super) schedule: Option<Arc<Runner>>,
    pub(super) guard: Guard,
    pub(super) version: &'static str,
}
