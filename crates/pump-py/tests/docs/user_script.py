"""A script as a user writes it, for type checkers: numbers of NumPy and pandas, and what may be missing."""

import asyncio

import numpy as np
import pandas as pd

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
