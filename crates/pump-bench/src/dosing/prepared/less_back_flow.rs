//! The warning of a back flow that exceeds the dose's own uncertainty, with what makes it smaller.

use pump_ctl::plan::{Cruise, Finish, Ramps, Request};

use super::{PlanningBasis, Prepared};
use crate::dosing::uncertainty::Budget;
use crate::dosing::warnings::{self, LessBackFlow};
use crate::notice::Notice;
use crate::numbers::significant;
use crate::pump_file::OutletEnd;

/// Ratio of a rate that is tried to the one before.
const SLOWER: f64 = 0.75;

/// Number of rates that are tried: down to a thirtieth.
const TRIALS: u32 = 12;

/// Part of the dose's own uncertainty from which on a back flow that is lost would widen it by a tenth: its share is
/// b/sqrt(3), so 2 b/sqrt(3) = sqrt(1.1² - 1) U.
const NOTABLE: f64 = 0.4;

impl PlanningBasis<'_> {
    /// Warns of a back flow that exceeds the uncertainty that the dose has beside it; at an end that nobody named, of
    /// one that would widen it notably. Names a slower rate that has less, and what line-aware ramps and an end at low
    /// flow have, and a retraction.
    ///
    /// The rates fall by a quarter each. A slower one may have more back flow, as the line's swing may meet the stop
    /// otherwise, so each is planned and the first that needs no warning counts.
    pub(super) fn back_flow_warning(&self, prepared: &Prepared, budget: &Budget) -> Option<Notice> {
        let own_ml = budget.beside_back_flow().expanded_ml();
        let back_ml = prepared.back_flow.backflow_ml;
        // An end that is named has the back flow in its interval, or draws the fluid itself back.
        let part = if self.file.outlet.end.is_none() { NOTABLE } else { 1.0 };
        let most_ml = part * own_ml;
        if back_ml <= most_ml {
            return None;
        }
        let (asked, _) = self.asked();
        let rate_ml_s = prepared.plan.cruise_flow_ml_s(&prepared.model);
        let slower = (1..=TRIALS).find_map(|n| {
            let slower_ml_s = significant(rate_ml_s * SLOWER.powi(n as i32), 2).parse().ok()?;
            let back_ml = self.back_flow_ml(&asked.with_cruise(Cruise::Flow { ml_s: slower_ml_s }))?;
            (back_ml <= most_ml).then_some((slower_ml_s, back_ml))
        });
        let low_flow_ml = match asked.finish {
            Finish::Any => self.back_flow_ml(&asked.with_finish(Finish::LowFlow)),
            Finish::LowFlow => None,
        };
        let line_aware_ml = match asked.ramps {
            Ramps::Fastest => self.back_flow_ml(&asked.with_ramps(Ramps::LineAware)),
            Ramps::LineAware => None,
        };
        let is_less = |other_ml: &f64| *other_ml < back_ml;
        let less = LessBackFlow {
            slower,
            low_flow_ml: low_flow_ml.filter(is_less),
            line_aware_ml: line_aware_ml.filter(is_less),
            by_retraction: self.retraction_would_help(),
        };
        let is_in_air = self.file.outlet.end == Some(OutletEnd::Air);
        Some(warnings::back_flow(&prepared.plan, back_ml, own_ml, is_in_air, &less))
    }

    /// Returns true if a retraction that was not asked for would draw in what hangs at the nozzle. It takes nothing
    /// back that has fallen, and an immersed nozzle has nothing that hangs.
    fn retraction_would_help(&self) -> bool {
        self.file.outlet.is_in_air() && self.request.retract_ml.is_none() && self.request.volume_ml > 0.0
    }

    /// Returns the back flow of the dose with another request, in mL, or `None` if there is no such dose.
    fn back_flow_ml(&self, request: &Request) -> Option<f64> {
        let found = self.planned(request).ok()?;
        Some(found.plan.back_flow(&found.model).ok()?.backflow_ml)
    }
}
