//! The heads of the catalogue that give a flow within the speeds that their documents state.

use crate::heads::{BoughtHead, bought_heads};

use super::error::SizingError;

/// Part of the largest speed that a head is best run at: room for more flow, and slow enough for the tube.
const BEST: f64 = 0.5;

/// Seconds of a minute.
const S_PER_MIN: f64 = 60.0;

/// Returns the speed in r/min at which a head gives a flow in mL/s.
pub(super) fn speed_rpm(head: &BoughtHead, flow_ml_s: f64) -> f64 {
    S_PER_MIN * flow_ml_s / head.ml_per_rev
}

/// Returns the heads that give a flow in mL/s within the speeds that their documents state, the nearest first.
///
/// The nearest one is that whose speed is nearest to half of its largest, by ratio. A head whose document states no
/// largest speed or no number of rollers is left out.
///
/// ```
/// let heads = pump_bench::sizing::heads_for(2000.0 / 3600.0)?;
/// let rpm = 60.0 * 2000.0 / 3600.0 / heads[0].ml_per_rev;
/// assert!(rpm > 150.0 && rpm < 250.0 && heads[0].most_rpm == Some(400.0));
/// # Ok::<(), pump_bench::sizing::SizingError>(())
/// ```
///
/// # Errors
/// [`SizingError::NoHead`] if no head gives that flow.
pub fn heads_for(flow_ml_s: f64) -> Result<Vec<&'static BoughtHead>, SizingError> {
    let known = || {
        bought_heads()
            .iter()
            .filter(|head| head.rollers.is_some())
            .filter_map(|head| Some((head, head.most_rpm?)))
    };
    let mut found: Vec<(f64, &BoughtHead)> = known()
        .filter_map(|(head, most_rpm)| {
            let rpm = speed_rpm(head, flow_ml_s);
            let within = rpm >= head.least_rpm.unwrap_or(0.0) && rpm <= most_rpm;
            within.then(|| ((rpm / (BEST * most_rpm)).ln().abs(), head))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    if !found.is_empty() {
        return Ok(found.into_iter().map(|(_, head)| head).collect());
    }
    let flow = |head: &BoughtHead, rpm: f64| (head.ml_per_rev * rpm / S_PER_MIN, head.name.clone());
    let by_flow = |a: &(f64, String), b: &(f64, String)| a.0.total_cmp(&b.0);
    let most = known().map(|(head, most_rpm)| flow(head, most_rpm)).max_by(by_flow);
    let least = known().filter_map(|(head, _)| Some(flow(head, head.least_rpm?))).min_by(by_flow);
    let (most_ml_s, largest) = most.unwrap_or_default();
    let (least_ml_s, smallest) = least.unwrap_or_default();
    Err(SizingError::NoHead { flow_ml_s, least_ml_s, smallest, most_ml_s, largest })
}
