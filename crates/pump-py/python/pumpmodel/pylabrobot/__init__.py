"""Doses of a `pumpmodel.Bench` from PyLabRobot (`pip install './crates/pump-py[pylabrobot]'`).

PyLabRobot's own `Pump.pump_volume` divides the volume by a constant before it calls its backend, so a backend
cannot know the requested volume. `BenchPump` replaces it: the bench plans from the rollers' angle. PyLabRobot
0.2 and 1.0 are served, which keeps its pumps in `pylabrobot.legacy.pumps`.

    from pumpmodel.pylabrobot import BenchBackend, BenchPump

    async with BenchPump(BenchBackend("my-pump.toml")) as pump:
        await pump.pump_volume(speed=50, volume=25)
"""

from pumpmodel.pylabrobot.array import BenchArrayBackend, BenchPumpArray
from pumpmodel.pylabrobot.backend import BenchBackend
from pumpmodel.pylabrobot.pump import BenchPump, HaltedError

__all__ = ["BenchArrayBackend", "BenchBackend", "BenchPump", "BenchPumpArray", "HaltedError"]
