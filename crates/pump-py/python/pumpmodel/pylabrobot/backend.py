"""The bench behind a pump of PyLabRobot."""

import asyncio
import os
from typing import Any, NoReturn

from pumpmodel.bench import AsyncBench, Bench
from pumpmodel.choices import Driver, Pace
from pumpmodel.pylabrobot import bases


class BenchBackend(bases.PumpBackend):
    """The bench behind a `BenchPump`, which opens it in `setup` and closes it in `stop`.

    Parameters
    ----------
    pump : str or os.PathLike
        Path of a pump file, name in `[pumps]` of the configuration, or name of a built-in pump.
    driver : {"sim", "grbl", "node", "klipper"}, optional
        Driver of the motor; by default the pump file's `[drive]`, otherwise "sim". A motor moves only if the
        pump file or `driver` names one.
    port : str, optional
        Serial port of the controller, as "/dev/ttyUSB0"; by default the pump file's.
    state_dir : str or os.PathLike, optional
        Folder of angle, journal and lock; by default `DOSE_STATE_DIR`, otherwise the command's folder.
    pace : {"real", "fast"}, optional
        Pace of a simulated motor, as `Bench.open` takes it: "real" takes the time of the plans.
    confirm_pump : bool
        Say that the pump's values are those of the pump at the motor, as `Bench.open` asks for.
    """

    def __init__(
        self,
        pump: str | os.PathLike[str],
        driver: Driver | None = None,
        port: str | None = None,
        state_dir: str | os.PathLike[str] | None = None,
        *,
        pace: Pace | None = None,
        confirm_pump: bool = False,
    ) -> None:
        super().__init__()
        self._pace = pace
        self._confirm_pump = confirm_pump
        self._pump = os.fspath(pump)
        self._driver = driver
        self._port = port
        self._state_dir = None if state_dir is None else os.fspath(state_dir)
        self._bench: AsyncBench | None = None

    @property
    def bench(self) -> Bench:
        """Bench, for everything that PyLabRobot does not offer. A RuntimeError before `setup`."""
        return self.awaited.bench

    @property
    def awaited(self) -> AsyncBench:
        """Bench whose calls are awaited. A RuntimeError before `setup`."""
        if self._bench is None:
            message = "the pump is not set up; await its setup() first"
            raise RuntimeError(message)
        return self._bench

    async def setup(self) -> None:
        """Open the bench. The first dose takes the pump."""
        if self._bench is not None:
            message = "the pump is set up already; await its stop() first"
            raise RuntimeError(message)
        self._bench = await asyncio.to_thread(
            AsyncBench.open,
            self._pump,
            driver=self._driver,
            port=self._port,
            state_dir=self._state_dir,
            pace=self._pace,
            confirm_pump=self._confirm_pump,
        )

    async def stop(self) -> None:
        """Wait for the dose under way, and give the pump back."""
        bench, self._bench = self.awaited, None
        await bench.close()

    def serialize(self) -> dict[str, Any]:
        """Return the arguments that make an equal backend."""
        return {
            **super().serialize(),
            "pump": self._pump,
            "driver": self._driver,
            "port": self._port,
            "state_dir": self._state_dir,
            "pace": self._pace,
            "confirm_pump": self._confirm_pump,
        }

    def run_revolutions(self, num_revolutions: float) -> NoReturn:
        """Raise NotImplementedError: `BenchPump.run_revolutions` runs the bench."""
        refuse("revolutions behind the back of its BenchPump")

    def run_continuously(self, speed: float) -> NoReturn:
        """Raise NotImplementedError: `BenchPump.run_continuously` runs the bench."""
        refuse("a speed behind the back of its BenchPump")

    def halt(self) -> None:
        """Make the motor of the dose under way decelerate and hold."""
        self.bench.stop()


def refuse(amount: str) -> NoReturn:
    """Refuse what only a front end can do."""
    message = f"a bench doses volumes, not {amount}"
    raise NotImplementedError(message)
