"""A bench: one pump, its driver, and its record."""

import os
from types import TracebackType
from typing import Self

from pumpmodel._pumpmodel import Pump, _Bench
from pumpmodel._results import checks
from pumpmodel.bench.calibration import BenchCalibration
from pumpmodel.bench.record import BenchRecord
from pumpmodel.bench.runs import BenchRuns
from pumpmodel.choices import Driver, Pace


class Bench(BenchRuns, BenchRecord, BenchCalibration):
    """A pump with its driver, its journal and its lock, shared with the command `dose`.

    Opening a bench moves and creates nothing. The first call that moves or records takes the pump, and the
    bench keeps it until `close` or the end of a `with` block. Meanwhile other processes, the command among
    them, cannot use the pump. Calls from several threads come one after the other, and other Python threads
    run meanwhile.

    A motor moves only if the pump file has a `[drive]` or `driver` names one. Ctrl-C in a call decelerates
    the motor, which then holds. The delivered volume is recorded, and KeyboardInterrupt is raised.

    Examples
    --------
    >>> import tempfile
    >>> import pumpmodel as pm
    >>> with tempfile.TemporaryDirectory() as tmp, pm.Bench.open("three-roller", state_dir=tmp) as bench:
    ...     dose = bench.dose("25mL")
    ...     print(f"{dose.delivered_ml:.2f} mL, {bench.status().angle_deg:.1f} deg")
    25.00 mL, 75.4 deg
    """

    def __init__(self, core: _Bench) -> None:
        """Wrap the compiled half; `open` opens a bench."""
        self._core = core

    @classmethod
    def open(
        cls,
        pump: Pump | str | os.PathLike[str],
        *,
        driver: Driver | None = None,
        port: str | os.PathLike[str] | None = None,
        pace: Pace | None = None,
        state_dir: str | os.PathLike[str] | None = None,
        configure: bool = False,
        accept_settings: bool = False,
        confirm_pump: bool = False,
        tube_limit: str | None = None,
        fluid: str | None = None,
        temperature: str | None = None,
    ) -> Self:
        """Open a bench. Nothing moves, and nothing is created.

        Parameters
        ----------
        pump : Pump, str or os.PathLike
            Pump, path of a pump file, name in `[pumps]` of the configuration, or name of a built-in pump.
        driver : {"sim", "grbl", "node", "klipper"}, optional
            Driver of the motor; by default the pump file's `[drive]`, otherwise "sim".
        port : str or os.PathLike, optional
            Serial port of the controller, as "/dev/ttyUSB0"; by default the pump file's.
        pace : {"real", "fast"}, optional
            Pace of a simulated motor: "real" takes the time of the plans, so that `stop`, Ctrl-C and
            `progress` can be tried; "fast" takes no time. The default is `pace` in the pump file's
            `[drive]`, otherwise "fast"; a run until it is stopped keeps real time.
        state_dir : str or os.PathLike, optional
            Folder of angle, journal and lock; by default `DOSE_STATE_DIR`, otherwise the configuration's
            `state_dir`, otherwise the command's folder.
        configure : bool
            Write the controller's settings that do not fit the pump.
        accept_settings : bool
            Accept another controller than the last time, or other settings of it.
        confirm_pump : bool
            Say that the pump's values are those of the pump at the motor. A real motor does not move while
            its steps per revolution, its direction or its head are filled in, as those of a built-in pump.
            The record keeps the word until such a value changes.
        tube_limit : str, optional
            Volume that a tube lasts, as "100L"; by default the pump file's.
        fluid : str, optional
            Fluid, as "water"; by default the pump file's.
        temperature : str, optional
            Temperature of the fluid, as "20degC"; by default the pump file's.

        Raises
        ------
        ValueError
            If the value of a keyword is not allowed.
        FileNotFoundError
            If the file is missing.
        PumpFileError
            If no pump has this name, or its file cannot be used.
        """
        named = pump if isinstance(pump, Pump) else Pump.named(_named(pump))
        for name, path in (("port", port), ("state_dir", state_dir)):
            if path is not None:
                checks.path(name, path, os.fspath)
        for name, text in (("driver", driver), ("pace", pace), ("fluid", fluid)):
            if not isinstance(text, str | None):
                message = f"{name} must be a text, not {checks.told(text)}"
                raise TypeError(message)
        return cls(
            _Bench(
                named,
                driver=driver,
                port=port,
                pace=pace,
                state_dir=state_dir,
                configure=configure,
                accept_settings=accept_settings,
                confirm_pump=confirm_pump,
                tube_limit=tube_limit,
                fluid=fluid,
                temperature=temperature,
            )
        )

    @property
    def driver(self) -> str:
        """Driver of the motor: "sim", "grbl", "node" or "klipper"."""
        return self._core.driver

    @property
    def port(self) -> str | None:
        """Serial port of the controller; None without one."""
        return self._core.port

    @property
    def folder(self) -> str:
        """Folder of the journal."""
        return os.fspath(self._core.folder)

    @property
    def closed(self) -> bool:
        """True once the bench is closed."""
        return self._core.closed

    def close(self) -> None:
        """Give the pump back after the call under way. Closing twice is no error."""
        self._core.close()

    def __enter__(self) -> Self:
        """Return the bench itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close the bench."""
        self.close()

    def __repr__(self) -> str:
        """Tell pump, driver and folder of the record."""
        at = "" if self.port is None else f" at {self.port}"
        closed = ", closed" if self.closed else ""
        return f"<Bench of '{self.pump.id}' ({self.driver}{at}) in {self.folder}{closed}>"


def _named(pump: object) -> str:
    """Return the path or name of a pump."""
    if isinstance(pump, str):
        return pump
    if not isinstance(pump, os.PathLike):
        message = f"pump must be a Pump, a name or a path, not {checks.told(pump)}"
        raise TypeError(message)
    return str(os.fspath(pump))
