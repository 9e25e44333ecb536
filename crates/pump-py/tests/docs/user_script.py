"""A script as a user writes it, for type checkers: numbers of NumPy and pandas, and what may be missing."""

import asyncio

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from numpy.typing import NDArray

import pumpmodel as pm
from pumpmodel.pylabrobot import BenchBackend, BenchPump


def speeds(table: pd.DataFrame, fastest_rpm: float | None) -> None:
    pump = pm.Pump.three_roller()
    flows = pump.average_flow_ml_s(speed_rpm=table["speed_rpm"])
    one: float = pump.average_flow_ml_s(speed_rpm=np.float32(60))
    print(flows, one, pump.steady_state(speed_rpm=np.float32(60)).outlet_max_kpa)
    limits = pm.Limits(max_outlet_kpa=fastest_rpm, min_inlet_kpa=np.float64(50))
    plan = pm.Doser(pump, limits).plan("25mL", start_angle_rad=np.float32(0.1))
    settle_s: float | None = plan.settle_s
    print(settle_s, plan.to_dataframe()["time_s"].max())


def pictures(pump: pm.Pump, calibration: pm.Calibration, dose: pm.Dose) -> list[str]:
    run = pump.simulate(speed_rpm=100, duration_s=1)
    pressure: Axes = run.plot(panels="pressure")
    over_time: list[Axes] = pm.Doser(pump).plan("5mL").plot()
    over_speed: list[Axes] = pump.steady_state(speed_rpm=np.arange(10.0, 100.0)).plot(ax=over_time[:3])
    axes = [pressure, *over_speed, pump.plot(angle_rad=0.5, ax=None), pm.plot_pitch(pump, ax=pressure)]
    axes += [calibration.plot(pump=pump), dose.plot(), pm.plot_dose_error(pump, [1.0, 5.0])]
    axes.append(pm.sweep([pump], speed_rpm=[50, 100]).plot("inlet_min_kpa"))
    harmonics = pump.harmonics(5, speed_rpm=100)
    amplitudes: NDArray[np.float64] = np.abs(harmonics.pressure_kpa)
    print(amplitudes.max(), len(harmonics.plot()))
    found = pm.identify_resistance([10, 20, 40, 60], drop_kpa=[1.11, 2.21, 4.44, 6.64])
    estimate: pm.Estimate = found.parameters["resistance_kpa_s_ml"]
    print(estimate.value, len(found.plot()), len(pump.animate(run, slower=2).to_jshtml()))
    return [axis.get_xlabel() for axis in axes]


def lines(table: pd.DataFrame) -> pm.Identified:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=1)
    again = pump.simulate(speed_rpm=np.float32(100), duration_s=np.float32(1), initial=run.end_state)
    likelihood = pm.LineLikelihood(
        pump,
        time_s=again.time_s,
        pressure_kpa=again.outlet_kpa,
        standard_kpa=np.float32(0.1),
        speed_rpm=np.float32(100),
    )
    found: float = likelihood.log_likelihood(compliance_ml_kpa=np.float32(0.03))
    hose = pm.Hose(bore_radius_mm=np.float32(4), outer_radius_mm=6, length_mm=500, modulus_mpa=3.5)
    water = pm.Fluid.water(temperature_degc=np.float32(20))
    line = hose.line(water, reservoir_kpa=np.float32(101.3), flow_ml_s=10)
    weighed = pm.WeighedRun(speed_rpm=np.float32(60), turned_deg=720, mass_g=table["mass_g"].iloc[0])
    unknown: float | None = None
    plan = pm.Doser(pump).plan("25mL", start_angle_rad=unknown)
    length_mm: float = hose.length_mm
    print(found, line, weighed.mass_g, plan.steps, length_mm)
    return pm.identify_line(
        pump,
        time_s=table["time_s"],
        pressure_kpa=table["pressure_kpa"],
        speed_rpm=np.float32(60),
        start_s=np.float32(0),
    )


async def robot() -> float | None:
    async with BenchPump(BenchBackend("three-roller")) as pump:
        dose = await pump.pump_volume(rate="10 mL/s", volume=np.float32(25))
        return dose.delivered_ml


async def dose(bench: pm.AsyncBench) -> float | None:
    made: pm.Dose = await bench.dose("25mL", rate="10 mL/s", progress=lambda made, planned: None)
    async for each in bench.batch("1mL", 3, every_s=60):
        print(each.delivered_ml)
    stopped: str | None = bench.stop()
    print(stopped)
    return made.delivered_ml


def main() -> None:
    with pm.Bench.open("three-roller") as bench:
        print(asyncio.run(dose(pm.AsyncBench(bench))))
    print(asyncio.run(robot()))
