"""Softer outlet lines at every speed: 100,000 steady states on a Dask cluster.

python cluster_sweep.py                       two processes on this machine
python cluster_sweep.py tcp://scheduler:8786  the workers of a cluster that has pumpmodel installed
"""

import sys

import numpy as np
from dask.distributed import Client

import pumpmodel as pm

SPEED_RPM = np.linspace(40, 170, 1000)


def pumps() -> list[pm.Pump]:
    """Return three rollers on 100 outlet lines, from a third of the paper's compliance to three times it."""
    pump = pm.Pump.three_roller()
    line = pump.outlet
    return [
        pump.replace(
            outlet=pm.Line(
                resistance_kpa_s_ml=line.resistance_kpa_s_ml,
                compliance_ml_kpa=line.compliance_ml_kpa * factor,
                inertance_kpa_s2_ml=line.inertance_kpa_s2_ml,
                reservoir_kpa=line.reservoir_kpa,
            )
        )
        for factor in np.geomspace(1 / 3, 3, 100)
    ]


def main(scheduler: str | None) -> pm.Sweep:
    """Sweep on the cluster and print, for a few speeds, the line that keeps the outlet pressure lowest."""
    if scheduler:
        client = Client(scheduler)
    else:
        client = Client(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None)
    with client:
        result = pm.sweep(pumps(), speed_rpm=SPEED_RPM, executor=client.get_executor(), progress=True)
    for speed in (50, 100, 150):
        column = int(np.abs(result.speed_rpm - speed).argmin())
        best = int(result.outlet_max_kpa[:, column].argmin())
        print(
            f"{speed} r/min: {result.outlet_max_kpa[best, column]:.2f} kPa at least,"
            f" with {result.pumps[best].outlet.compliance_ml_kpa:.4f} mL/kPa"
        )
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
