"""One result of every class that has a picture."""

from functools import cache
from typing import Any

import numpy as np

import pumpmodel as pm


@cache
def runs() -> tuple[pm.WeighedRun, ...]:
    scatter = np.random.default_rng(2).normal(0, 0.02, 12)
    speeds = np.repeat([20, 60, 100, 140], 3)
    return tuple(
        pm.WeighedRun(speed_rpm=speed, turned_deg=720, mass_g=42.4 - 0.003 * speed + noise)
        for speed, noise in zip(speeds.tolist(), scatter.tolist(), strict=True)
    )


@cache
def line(port: str = "outlet") -> pm.Identified:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=0.4, dt_s=2e-3)
    kpa = np.asarray(getattr(run, f"{port}_kpa")) + np.random.default_rng(1).normal(0, 0.3, len(run))
    return pm.identify_line(
        pump,
        time_s=run.time_s,
        pressure_kpa=kpa,
        speed_rpm=100,
        begin="step",
        port="inlet" if port == "inlet" else "outlet",
    )


def verification() -> pm.Verification:
    return pm.Verification.from_dict(
        {
            "schema": "verification/1",
            "nominal_ml": 10.0,
            "volumes_ml": [10.01, 9.98, 10.04, 10.02],
            "mean_ml": 10.0125,
            "systematic_ml": 0.0125,
            "systematic_percent": 0.125,
            "random_ml": 0.025,
            "random_percent": 0.25,
            "tolerance": {"systematic_percent": 0.6, "random_percent": 0.2},
            "passed": False,
        }
    )


@cache
def joint() -> pm.JointlyIdentified:
    pump = pm.Pump.three_roller()
    dice = np.random.default_rng(1)
    records = []
    for speed_rpm in (30, 100):
        run = pump.simulate(speed_rpm=speed_rpm, duration_s=0.4, dt_s=2e-3)
        kpa = run.outlet_kpa + dice.normal(0, 0.3, len(run))
        records.append(pm.PressureRecord(run.time_s, kpa, speed_rpm, begin="step"))
    return pm.identify_line_jointly(pump, records)


@cache
def results() -> dict[str, Any]:
    pump = pm.Pump.three_roller()
    plan = pm.Doser(pump).plan("5mL", rate="10 mL/s", start_angle_rad=0.1)
    return {
        "pump": pump,
        "run": pump.simulate(speed_rpm=100, duration_s=0.5),
        "long run": pump.simulate(speed_rpm=100, duration_s=60),
        "plan": plan,
        "dose": pm.Dose.from_dict(plan.to_dict()),
        "steady state": pump.steady_state(speed_rpm=100),
        "steady states": pump.steady_state(speed_rpm=np.arange(5.0, 171.0)),
        "sweep": pm.sweep([pump, pump.replace(rollers=4)], speed_rpm=range(10, 100)),
        "calibration": pm.Calibration.from_runs(pump, runs()),
        "single calibration": pm.Calibration.from_runs(pump, runs()[:3], fit="factor"),
        "line": line(),
        "joint line": joint(),
        "sensitivity": pump.simulate(speed_rpm=100, duration_s=0.5, sensitivity=True).sensitivity,
        "expected fit": pm.next_experiment(
            pump, [pm.Experiment(speed_rpm=60, duration_s=1)], standard_kpa=0.3
        )[0],
        "trials": pm.monte_carlo(plan, trials=2000, seed=1),
        "resistance": pm.identify_resistance([10, 20, 40, 60], drop_kpa=[1.11, 2.21, 4.44, 6.64]),
        "compliance": pm.identify_compliance([0, 0.1, 0.2, 0.3, 0.4], [88.6, 91.4, 94.2, 96.9, 99.7]),
        "volume": pm.VolumeFit([0, 10, 20, 30, 40, 50], [0, 0.23, 0.83, 1.49, 1.96, 2.1]),
        "function": pm.VolumeFit.from_function(lambda deg: 1.05 * (1 - np.cos(np.pi * deg / 50)), 50),
        "polynomial": pm.VolumePolynomial([-3.2e-5, 0.0024, 0, 0], 50),
        "verification": verification(),
        "pulsation": pump.harmonics(12, speed_rpm=100),
    }
