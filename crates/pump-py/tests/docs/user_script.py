"""A script as a user writes it, for type checkers: numbers of NumPy and pandas, and what may be missing."""

import asyncio

import numpy as np
import pandas as pd

import pumpmodel as pm


def speeds(table: pd.DataFrame, fastest_rpm: float | None) -> None:
    pump = pm.Pump.three_roller()
    flows = pump.average_flow_ml_s(speed_rpm=table["speed_rpm"])
    one: float = pump.average_flow_ml_s(speed_rpm=np.float32(60))
    print(flows, one, pump.steady_state(speed_rpm=np.float32(60)).outlet_max_kpa)
    limits = pm.Limits(max_outlet_kpa=fastest_rpm, min_inlet_kpa=np.float64(50))
    plan = pm.Doser(pump, limits).plan("25mL", start_angle_rad=np.float32(0.1))
    settle_s: float | None = plan.settle_s
    print(settle_s, plan.to_dataframe()["time_s"].max())


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
