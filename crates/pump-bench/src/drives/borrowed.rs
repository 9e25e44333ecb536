//! A borrowed drive: whoever lends it to a session has it back afterwards.

use pump_ctl::plan::{FlowMotion, Plan, PlannedMotion};

use super::abilities::Abilities;
use super::board_share::BoardShare;
use super::common_begin::BeginPlace;
use super::drive::{Disturbance, Drive, DriveLimits, Gate, IndexSearch, Watch};
use super::error::{DriveError, DriveFault};
use crate::displacement::Correction;
use crate::notice::Notice;

impl<T: Drive + ?Sized> Drive for &mut T {
    fn id(&self) -> &str {
        T::id(self)
    }

    fn is_simulated(&self) -> bool {
        T::is_simulated(self)
    }

    fn abilities(&self) -> Abilities {
        T::abilities(self)
    }

    fn limits(&self) -> Option<DriveLimits> {
        T::limits(self)
    }

    fn count(&self) -> Option<i64> {
        T::count(self)
    }

    fn farthest_count(&self) -> Option<i64> {
        T::farthest_count(self)
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        T::disturbed(self)
    }

    fn is_without_current(&self) -> bool {
        T::is_without_current(self)
    }

    fn recorded(&mut self) {
        T::recorded(self);
    }

    fn holds_at_rest(&self) -> bool {
        T::holds_at_rest(self)
    }

    fn rests(&self) -> u32 {
        T::rests(self)
    }

    fn put_on_record(&mut self) -> Result<(), DriveError> {
        T::put_on_record(self)
    }

    fn connect(&mut self) -> Result<(), DriveError> {
        T::connect(self)
    }

    fn check(&mut self, plan: &Plan) -> Result<(), DriveError> {
        T::check(self, plan)
    }

    fn board_share(&self, motion: PlannedMotion<'_>) -> Result<Option<BoardShare>, DriveError> {
        T::board_share(self, motion)
    }

    fn begin_lead_s(&self) -> f64 {
        T::begin_lead_s(self)
    }

    fn displaces(&mut self, correction: Correction) {
        T::displaces(self, correction);
    }

    fn forget_plan(&mut self) {
        T::forget_plan(self);
    }

    fn begin_with(&mut self, place: BeginPlace) -> Result<(), DriveError> {
        T::begin_with(self, place)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        T::run(self, plan, gate)
    }

    fn check_flow(&mut self, flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        T::check_flow(self, flow)
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        T::run_flow(self, flow, gate)
    }

    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        T::seek(self, plan, gate)
    }

    fn settle(&mut self, settle_s: f64, watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        T::settle(self, settle_s, watch)
    }

    fn simulated_s(&self) -> Option<f64> {
        T::simulated_s(self)
    }

    fn notes(&mut self) -> Vec<Notice> {
        T::notes(self)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        T::release(self)
    }
}

#[cfg(test)]
mod tests {
    /// Returns the names of the functions in a source.
    fn names(source: &str) -> Vec<&str> {
        let starts = source.lines().filter_map(|line| line.strip_prefix("    fn "));
        starts.filter_map(|line| line.split('(').next()).collect()
    }

    #[test]
    fn a_borrowed_drive_hands_on_every_function_that_has_a_default() {
        let (_, of_trait) = include_str!("drive.rs").split_once("pub trait Drive").unwrap();
        let (of_trait, _) = of_trait.split_once("\n}\n").unwrap();
        let handed_on = names(include_str!("borrowed.rs").split("#[cfg(test)]").next().unwrap());
        assert!(names(of_trait).len() > 10);
        for name in names(of_trait) {
            assert!(handed_on.contains(&name), "{name}");
        }
    }
}
