//! A service may move a bench, its session and their results between threads.

use pump_bench::{
    Accepted, Bench, Delivered, DoseError, DoseReport, DoseRequest, Prepared, PumpFile, Session,
};

const fn moved<T: Send>() {}
const fn shared<T: Send + Sync>() {}

#[test]
fn threads_may_share_a_bench_and_move_its_session() {
    shared::<(Bench, PumpFile, DoseRequest, Prepared, Delivered, DoseReport, DoseError)>();
    moved::<(Session<'static>, Accepted)>();
}
