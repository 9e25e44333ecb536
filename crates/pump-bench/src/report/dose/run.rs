//! The run of continuous flow: its end and its mean flow.

use serde::Serialize;

use super::made::told_ml;
use crate::bench::{Delivered, PreparedProfile};
use crate::dosing::{Prepared, RunEnd};
use crate::numbers::significant;
use crate::record::{Purpose, ShortText};

/// A run of continuous flow, or a prime or purge for a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RunReport {
    /// Event that was to end it: `volume`, `time`, `stop` or `profile`.
    pub until: Until,
    /// Time that was asked for, s; null if no time was to end it.
    pub asked_s: Option<f64>,
    /// Volume that was delivered over the time of its motion, mL/s; null on a dry run, and if nothing moved.
    pub mean_flow_ml_s: Option<f64>,
    /// True if somebody stopped it before the end of its plan; null on a dry run.
    pub was_stopped: Option<bool>,
    /// Flow over time that it followed; absent for other runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<ProfileReport>,
}

/// Flow over time that a run followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ProfileReport {
    /// Name of the profile, as the file's.
    pub name: ShortText,
    /// Volume of the profile at the rollers, mL.
    pub volume_ml: f64,
    /// Time of the profile from its first row to its last, s.
    pub time_s: f64,
    /// Largest distance of the volume at the rollers from the profile's at any moment, mL: that of a motor step. Null
    /// if the run was stopped or took longer than its profile, and so left it.
    pub largest_departure_ml: Option<f64>,
}

/// Event that ends a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Until {
    /// A volume is delivered.
    Volume,
    /// A time has passed.
    Time,
    /// Somebody stops it.
    Stop,
    /// The last row of a flow over time is reached.
    Profile,
}

impl RunReport {
    /// Reports the run that was prepared. `None` for a motion of another purpose that a volume ends.
    pub(in crate::report) fn of(prepared: &Prepared, delivered: Option<&Delivered>) -> Option<Self> {
        let (until, asked_s) = match prepared.request.end {
            RunEnd::Volume if prepared.request.purpose != Purpose::Run => return None,
            RunEnd::Volume => (Until::Volume, None),
            RunEnd::Time { time_s } => (Until::Time, Some(time_s)),
            RunEnd::Stop => (Until::Stop, None),
        };
        let mean_ml_s =
            |end: &Delivered| (end.measured_s > 0.0).then(|| told_ml(prepared, end).abs() / end.measured_s);
        Some(Self {
            until,
            asked_s,
            mean_flow_ml_s: delivered.and_then(mean_ml_s),
            was_stopped: delivered.map(|delivered| !delivered.completed),
            profile: None,
        })
    }

    /// Reports a run that followed a flow over time and delivered `delivered_ml`.
    pub(super) fn of_profile(
        prepared: &PreparedProfile,
        delivered: Option<&Delivered>,
        delivered_ml: Option<f64>,
    ) -> Self {
        let flow = prepared.motion();
        let mean_ml_s =
            |(end, ml): (&Delivered, f64)| (end.measured_s > 0.0).then(|| ml.abs() / end.measured_s);
        Self {
            until: Until::Profile,
            asked_s: None,
            mean_flow_ml_s: delivered.zip(delivered_ml).and_then(mean_ml_s),
            was_stopped: delivered.map(|delivered| !delivered.completed),
            profile: Some(ProfileReport {
                name: prepared.name,
                volume_ml: flow.volume_ml(),
                time_s: flow.duration_s(),
                largest_departure_ml: delivered.map_or_else(
                    || Some(prepared.largest_departure_ml()),
                    |delivered| prepared.departure_kept_ml(delivered),
                ),
            }),
        }
    }

    /// Returns true if the run goes on until somebody stops it.
    pub(in crate::report) fn is_endless(&self) -> bool {
        self.until == Until::Stop
    }

    /// Returns true if somebody stopped it before the end of its plan.
    pub(in crate::report) fn is_stopped(&self) -> bool {
        self.was_stopped == Some(true)
    }

    /// Returns the line of the run for people. It took `moved_s`.
    pub(in crate::report) fn line(&self, moved_s: f64) -> String {
        if let Some(profile) = &self.profile {
            let within =
                |departure_ml| format!(", within {} µL at every moment", significant(1e3 * departure_ml, 4));
            return format!(
                "profile {}: {} mL in {} s at the rollers{}\n",
                profile.name.as_str(),
                significant(profile.volume_ml, 4),
                significant(profile.time_s, 6),
                profile.largest_departure_ml.map_or_else(String::new, within),
            );
        }
        let Some(flow_ml_s) = self.mean_flow_ml_s else { return String::new() };
        let [ml_s, ml_min] = [flow_ml_s, 60.0 * flow_ml_s].map(|flow| significant(flow, 4));
        format!("run: {ml_s} mL/s ({ml_min} mL/min) on average over {moved_s:.3} s\n")
    }
}
