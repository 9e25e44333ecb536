//! Several drives of one board, each in a thread of its own over one line, as the sessions of a rack of pumps.

use std::error::Error;
use std::path::Path;
use std::thread;
use std::time::Duration;

use pump_bench::built_in;
use pump_bench::drives::{CommonBegin, Drive, Leave, Node, NodeBoard, Opening};
use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};

use crate::board::emulator::Emulator;
use crate::board::host::{Move, TICK_RATE};
use crate::board::motor::rises;
use crate::check;
use crate::doses::START_RAD;
use crate::together::hold;

/// Axes, each with its dose: mL and mL/s.
const DOSES: [(Axis, f64, f64); 4] =
    [(Axis::X, 1.0, 2.0), (Axis::Y, 1.0, 2.0), (Axis::Z, -0.7, 1.5), (Axis::A, 1.5, 3.0)];

/// Time for which the threads wait for each other, by the computer's clock.
const LIMIT: Duration = Duration::from_secs(600);

/// Steps after which one axis of the second run stops.
const STOPS_AFTER: u64 = 400;

/// Makes four smooth doses by four drives that begin at one tick, then four of which one stops on its way.
pub(crate) fn axes(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let emulator = Emulator::new(firmware)?;
    let board = NodeBoard::over(Box::new(emulator.clone()));
    let (mut nodes, plans) = meet(&board)?;
    emulator.take_edges();
    let before = emulator.counts()?;
    let made = run(&mut nodes, &plans, None)?;
    let whole = made.iter().zip(&plans).all(|(made, plan)| *made == plan.steps().unsigned_abs());
    check(whole, "that all doses are whole")?;
    let moves: Result<Vec<_>, _> =
        (0..).zip(&plans).map(|(axis, plan)| Move::new(axis, plan.segments(TICK_RATE))).collect();
    println!("four smooth doses at 2, 2, -1.5 and 3 mL/s by four drives in threads of their own:");
    hold(&moves?, &emulator.take_edges(), before, emulator.counts()?)?;

    let (_, back) = plans_of(|ml| -ml)?;
    let made = run(&mut nodes, &back, Some(1))?;
    let edges = emulator.take_edges();
    let rose: Vec<u64> = (0..4).map(|axis| rises(&edges, axis).len() as u64).collect();
    println!(
        "  back, and axis Y is stopped after {} of {} steps; the pins rose {rose:?} times",
        made[1],
        back[1].steps()
    );
    check(
        made == rose && made[1] >= STOPS_AFTER && made[1] < back[1].steps().unsigned_abs(),
        "the count of a stop",
    )?;
    let others = [0, 2, 3].into_iter().all(|axis| made[axis] == back[axis].steps().unsigned_abs());
    check(others, "that a stop of one axis leaves the others alone")
}

/// Plans the doses of all axes, in the direction that `turned` gives them.
fn plans_of(turned: impl Fn(f64) -> f64) -> Result<(pump_bench::PumpFile, Vec<Plan>), Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("no such pump")?;
    let pump = file.model()?;
    let doser = Doser::new(&pump, file.limits())?;
    let plans = DOSES.iter().map(|(_, volume_ml, ml_s)| {
        let request = Request::new(turned(*volume_ml), Cruise::Flow { ml_s: *ml_s }).with_smooth(true);
        doser.plan(Phase::known(START_RAD), &request)
    });
    let plans = plans.collect::<Result<_, _>>()?;
    Ok((file, plans))
}

fn meet(board: &NodeBoard) -> Result<(Vec<Node>, Vec<Plan>), Box<dyn Error>> {
    let (file, plans) = plans_of(|ml| ml)?;
    let nodes = DOSES.iter().map(|(axis, ..)| {
        let table = DriveTable::of(DriverName::Node).with_axis(*axis);
        board.axis(&table, &file.motor, &Opening::default())
    });
    Ok((nodes.collect::<Result<_, _>>()?, plans))
}

/// Runs all plans, each in a thread of its own. Returns the steps that each made.
fn run(nodes: &mut [Node], plans: &[Plan], stops: Option<usize>) -> Result<Vec<u64>, Box<dyn Error>> {
    let mut places = CommonBegin::places(nodes.len(), LIMIT);
    let made: Result<Vec<u64>, String> = thread::scope(|scope| {
        let threads: Vec<_> = nodes
            .iter_mut()
            .zip(plans)
            .enumerate()
            .map(|(axis, (node, plan))| {
                let place = places.pop();
                scope.spawn(move || {
                    let mut gate = |made: u64, _: u64| {
                        if stops == Some(axis) && made >= STOPS_AFTER { Leave::Stop } else { Leave::Go }
                    };
                    place
                        .map_or(Ok(()), |place| node.begin_with(place))
                        .map_err(|error| error.to_string())?;
                    node.run(plan, &mut gate).map_err(|fault| format!("{fault:?}"))
                })
            })
            .collect();
        let joined =
            threads.into_iter().map(|thread| thread.join().map_err(|_| "a thread failed".to_owned())?);
        joined.collect()
    });
    Ok(made?)
}
