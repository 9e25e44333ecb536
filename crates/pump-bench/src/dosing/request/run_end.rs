//! The end of a run of continuous flow.

/// Event that ends a motion.
///
/// ```
/// use pump_bench::DoseRequest;
/// use pump_bench::dosing::RunEnd;
/// use pump_bench::record::Purpose;
///
/// let run = DoseRequest::new(Purpose::Run, 1.0).with_end(RunEnd::Time { time_s: 7200.0 });
/// assert_eq!(run.end, RunEnd::Time { time_s: 7200.0 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum RunEnd {
    /// The volume of the request is delivered.
    #[default]
    Volume,
    /// The motion has taken this time from its start to its last step, ramps included. The sign of the request's
    /// volume is the direction.
    Time {
        /// Time of the motion, in s.
        time_s: f64,
    },
    /// Somebody stops the motion, which then counts as complete. The sign of the request's volume is the direction.
    Stop,
}
