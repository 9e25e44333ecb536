use pump_ctl::plan::*;
use pump_model::{Geometry, Line, Pump, RollerVolume};
fn pump_c(p: &Pump, f: f64) -> Pump {
    let l = Line { compliance_ml_kpa: p.outlet().compliance_ml_kpa * f, ..*p.outlet() };
    Pump::new(*p.geometry(), *p.roller_volume(), l, l).unwrap()
}
fn main() {
    let n: usize = std::env::args().nth(1).map_or(72, |x| x.parse().unwrap());
    let only: Option<f64> = std::env::args().nth(2).map(|x| x.parse().unwrap());
    let pump = Pump::three_roller();
    let motor = Motor::new(12_800.0, 17.8, 500.0);
    let off: Vec<Pump> = [0.8, 1.2, 0.75, 1.25].iter().map(|f| pump_c(&pump, *f)).collect();
    let doser = Doser::new(&pump, Limits::new(motor)).unwrap();
    for (v, q) in [
        (1.0, 5.0),
        (3.0, 15.0),
        (25.0, 5.0),
        (0.05, 5.0),
        (0.3, 5.0),
        (-1.0, 5.0),
        (3.0, 60.0),
        (10.0, 30.0),
        (1.0, 1.0),
    ] {
        if only.is_some_and(|o| o != v) {
            continue;
        }
        for ramps in [Ramps::Fastest, Ramps::LineAware] {
            let (mut bf, mut t, mut cs) = (0.0f64, 0.0, [0.0f64; 4]);
            let mut tc = [0.0f64; 4];
            let mut plan_t = 0.0;
            let mut plan_max = 0.0f64;
            for i in 0..n {
                let th = pump.pitch_rad() * i as f64 / n as f64;
                let req = Request::new(v, Cruise::Flow { ml_s: q }).with_ramps(ramps);
                let now = std::time::Instant::now();
                let plan = doser.plan(Phase::known(th), &req).unwrap();
                let el = now.elapsed().as_secs_f64();
                plan_t += el;
                plan_max = plan_max.max(el);
                let b = plan.back_flow(&pump).unwrap().backflow_ml * 1e3;
                bf = bf.max(b);
                t += plan.profile().duration_s() + plan.predict(&pump).unwrap().settle_s;
                for (k, p) in off.iter().enumerate() {
                    cs[k] = cs[k].max(plan.back_flow(p).unwrap().backflow_ml * 1e3);
                    tc[k] += (plan.profile().duration_s() + plan.predict(p).unwrap().settle_s) / n as f64;
                }
                if only.is_some() && i % (n / 12).max(1) == 0 {
                    println!(
                        "   {:.3} bf {:.2} legs {:?}",
                        th,
                        b,
                        plan.legs()
                            .map(|l| (
                                (l.speed_rad_s * 100.0).round() / 100.0,
                                (l.duration_s * 1e4).round() / 10.0
                            ))
                            .collect::<Vec<_>>()
                    );
                }
            }
            println!(
                "{v} mL {q} mL/s {ramps}: bf {bf:.2} uL  C .8 {:.2} 1.2 {:.2} .75 {:.2} 1.25 {:.2}  time {:.3} C: {:.3} {:.3} {:.3} {:.3}  plan {:.3} ms max {:.3}",
                cs[0],
                cs[1],
                cs[2],
                cs[3],
                t / n as f64,
                tc[0],
                tc[1],
                tc[2],
                tc[3],
                plan_t / n as f64 * 1e3,
                plan_max * 1e3
            );
        }
    }
}
