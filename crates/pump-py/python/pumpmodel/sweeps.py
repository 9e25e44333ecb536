"""Steady states of many pumps at many speeds, on all cores or on any executor."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel._pumpmodel import Pump, _cavitation, _numbers, _steady_states
from pumpmodel._results import checks
from pumpmodel._results.optional import optional
from pumpmodel._results.tables import COLUMNS
from pumpmodel.choices import SteadyQuantity

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

_Array: TypeAlias = NDArray[np.float64]
_Progress: TypeAlias = Callable[[int, int], object]

# Number of points in a task for an executor: about a tenth of a second of work.
_TASK = 2000

RESULTS: tuple[SteadyQuantity, ...] = get_args(SteadyQuantity)


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """Steady states of many pumps at many speeds, made by `sweep`.

    Results are read-only arrays of float64 of shape (pumps, speeds). Pressures are absolute.
    """

    #: Pumps, one for each row.
    pumps: tuple[Pump, ...]
    #: Speeds of the pump head, r/min, one for each column; shape (speeds,).
    speed_rpm: _Array
    #: Speeds of the pump head, rad/s, one for each column; shape (speeds,).
    speed_rad_s: _Array
    #: Smallest inlet pressure, kPa.
    inlet_min_kpa: _Array
    #: Largest inlet pressure, kPa.
    inlet_max_kpa: _Array
    #: Mean inlet pressure, kPa.
    inlet_mean_kpa: _Array
    #: Smallest outlet pressure, kPa.
    outlet_min_kpa: _Array
    #: Largest outlet pressure, kPa.
    outlet_max_kpa: _Array
    #: Mean outlet pressure, kPa.
    outlet_mean_kpa: _Array
    #: Mean flow, mL/s; negative in reverse.
    mean_flow_ml_s: _Array
    #: (Largest - smallest) / mean of the flow at the outlet rollers.
    ripple_peak_to_peak: _Array
    #: Standard deviation / mean of the flow at the outlet rollers.
    ripple_rms: _Array

    def __post_init__(self) -> None:
        """Make the arrays read-only, also after unpickling."""
        for field in fields(self)[1:]:
            getattr(self, field.name).setflags(write=False)

    def __reduce__(self) -> tuple[type[Sweep], tuple[Any, ...]]:
        """Pickle a sweep by its fields."""
        return Sweep, tuple(getattr(self, field.name) for field in fields(self))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of pumps, number of speeds."""
        return len(self.pumps), len(self.speed_rpm)

    def __eq__(self, other: object) -> bool:
        """Tell if pumps, speeds and every number are equal."""
        if not isinstance(other, Sweep):
            return NotImplemented
        arrays = [field.name for field in fields(self)[1:]]
        return self.pumps == other.pumps and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in arrays
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Tell the size of a sweep and the ranges of its numbers."""
        ranges = "".join(
            f", {name} {values.min():.4g} to {values.max():.4g}"
            for name in ("speed_rpm", "inlet_min_kpa", "outlet_max_kpa")
            if (values := getattr(self, name)).size
        )
        return f"<Sweep of {len(self.pumps)} pumps at {len(self.speed_rpm)} speeds{ranges}>"

    def to_dataframe(self) -> pd.DataFrame:
        """Return one row for each pump and speed.

        Returns
        -------
        pandas.DataFrame
            Columns `pump` (number of the pump), `pump_id`, `rollers`, `speed_rpm`, `speed_rad_s` and the
            results. `attrs["units"]` maps columns to units.

        Raises
        ------
        ImportError
            If pandas is missing, which `pip install './crates/pump-py[dataframe]'` brings.
        """
        pumps, speeds = self.shape
        columns = {
            "pump": np.repeat(np.arange(pumps), speeds),
            "pump_id": np.repeat([pump.id for pump in self.pumps], speeds),
            "rollers": np.repeat([pump.rollers for pump in self.pumps], speeds),
            "speed_rpm": np.tile(self.speed_rpm, pumps),
            "speed_rad_s": np.tile(self.speed_rad_s, pumps),
        }
        columns |= {name: getattr(self, name).ravel() for name in RESULTS}
        frame: pd.DataFrame = optional("pandas", "dataframe").DataFrame(columns)
        frame.attrs["units"] = {name: COLUMNS[name][0] for name in columns if name in COLUMNS}
        return frame

    def to_xarray(self) -> xr.Dataset:
        """Return the results over the dimensions `pump` and `speed_rpm`.

        Returns
        -------
        xarray.Dataset
            Each variable has the attributes `units` and `long_name`. `pump_id` and `rollers` are coordinates
            along `pump`.

        Raises
        ------
        ImportError
            If xarray is missing, which `pip install './crates/pump-py[xarray]'` brings.
        """

        def described(name: str, dims: str | tuple[str, ...], numbers: object) -> tuple[Any, ...]:
            units, long_name = COLUMNS[name]
            return dims, numbers, {"units": units, "long_name": long_name}

        dims = ("pump", "speed_rpm")
        dataset: xr.Dataset = optional("xarray", "xarray").Dataset(
            {name: described(name, dims, getattr(self, name)) for name in RESULTS},
            coords={
                "pump": np.arange(len(self.pumps)),
                "pump_id": ("pump", [pump.id for pump in self.pumps]),
                "rollers": ("pump", [pump.rollers for pump in self.pumps]),
                "speed_rpm": described("speed_rpm", "speed_rpm", self.speed_rpm),
                "speed_rad_s": described("speed_rad_s", "speed_rpm", self.speed_rad_s),
            },
        )
        return dataset

    def plot(
        self,
        quantity: SteadyQuantity | ArrayLike = "outlet_max_kpa",
        *,
        label: str | None = None,
        y: ArrayLike | None = None,
        y_label: str | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw a result as a map over speed and pump, as `pumpmodel.plot_map` does."""
        from pumpmodel.plotting import plot_map

        return plot_map(self, quantity, label=label, y=y, y_label=y_label, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import sweep_html

        return sweep_html(self)


def sweep(
    pumps: Pump | Iterable[Pump],
    *,
    speed_rpm: ArrayLike | None = None,
    speed_rad_s: ArrayLike | None = None,
    executor: Executor | None = None,
    progress: bool | _Progress = False,
) -> Sweep:
    """Compute the periodic steady state of every pump at every speed.

    All cores of this machine compute in Rust while other Python threads run. Ctrl-C ends a sweep within
    about 0.2 s, and later where gigabytes of results are given back. With an executor its workers compute
    instead, on one core each, and the numbers agree to the last bit.

    Parameters
    ----------
    pumps : Pump or iterable of Pump
        Pumps of the sweep, one row of results for each.
    speed_rpm : array_like
        Speeds of the pump head, r/min, a number or shape (speeds,); negative in reverse; not zero.
    speed_rad_s : array_like
        Speeds of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    executor : concurrent.futures.Executor, optional
        Executor of the work: a ThreadPoolExecutor, a ProcessPoolExecutor, `get_executor()` of a Dask client.
    progress : bool or callable
        True shows a line on standard error. A callable is called as `progress(done, total)`.

    Returns
    -------
    Sweep
        Results as arrays of shape (pumps, speeds).

    Raises
    ------
    ValueError
        If a speed is not allowed, or a line without resistance resonates at it. The message names the pump.
    PumpError
        If the solver fails on the way.
    MemoryError
        If there is no room for the results.

    Warns
    -----
    UserWarning
        If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning. One
        warning counts the points and tells the lowest.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> three = pm.Pump.three_roller()
    >>> result = pm.sweep([three, three.replace(rollers=4)], speed_rpm=[50, 100, 150])
    >>> result.outlet_max_kpa.shape
    (2, 3)
    """
    pumps = (pumps,) if isinstance(pumps, Pump) else tuple(checks.items("pumps", pumps, Pump))
    if not isinstance(progress, bool):
        checks.function("progress", progress, "the points done and their total, True or False")
    _check_executor(executor)
    name, speeds = _speeds(speed_rpm, speed_rad_s)
    found, warning = _swept(pumps, name, speeds, executor, _show if progress is True else progress or None)
    if warning:
        warnings.warn(warning, UserWarning, stacklevel=2)
    return found


def sweep_in_parts(
    pumps: Pump | Iterable[Pump],
    *,
    speed_rpm: ArrayLike | None = None,
    speed_rad_s: ArrayLike | None = None,
    points: int = 100_000,
    executor: Executor | None = None,
) -> Iterator[Sweep]:
    """Compute the periodic steady states of pumps part by part, for more points than fit into memory.

    Pumps are taken from the iterable as they are needed, so a generator may make them. A part is computed
    when it is asked for, as `sweep` computes it, and its numbers are those of one sweep to the last bit.

    Parameters
    ----------
    pumps : Pump or iterable of Pump
        Pumps of the sweep, one row of results for each.
    speed_rpm : array_like
        Speeds of the pump head, r/min, a number or shape (speeds,); negative in reverse; not zero.
    speed_rad_s : array_like
        Speeds of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    points : int
        Largest number of points (pumps times speeds) of a part, at least 1. A part has whole rows, so a row
        of more speeds is a part of its own.
    executor : concurrent.futures.Executor, optional
        Executor of the work: a ThreadPoolExecutor, a ProcessPoolExecutor, `get_executor()` of a Dask client.

    Yields
    ------
    Sweep
        The next rows. A part of 100,000 points takes 7 MB.

    Raises
    ------
    TypeError
        If a pump is not a `Pump`, or `points` is not an integer.
    ValueError
        If a speed or `points` is not allowed, or a line without resistance resonates at a speed. The message
        names the pump by its number in the whole sweep.

    Warns
    -----
    UserWarning
        If a pressure is below 0 kPa absolute, once for each part.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> three = pm.Pump.three_roller()
    >>> heads = (three.replace(rollers=count) for count in range(2, 7))
    >>> parts = pm.sweep_in_parts(heads, speed_rpm=range(10, 171), points=400)
    >>> [part.shape for part in parts]
    [(2, 161), (2, 161), (1, 161)]
    """
    name, speeds = _speeds(speed_rpm, speed_rad_s)
    points = checks.whole("points", points, 1)
    _check_executor(executor)
    if not isinstance(pumps, Iterable | Pump) or isinstance(pumps, str | type):
        message = f"pumps must be a Pump or an iterable of Pumps, not {checks.told(pumps)}"
        raise TypeError(message)
    rows = min(sys.maxsize, max(1, points // max(1, len(speeds))))
    return _parts(iter((pumps,) if isinstance(pumps, Pump) else pumps), name, speeds, rows, executor)


def _check_executor(executor: object) -> None:
    if executor is not None:
        checks.having("executor", executor, "submit", "an Executor, as a ProcessPoolExecutor")


def _parts(
    pumps: Iterator[Pump], name: str, speeds: NDArray[Any], rows: int, executor: Executor | None
) -> Iterator[Sweep]:
    first = 0
    while part := tuple(islice(pumps, rows)):
        found, warning = _swept(part, name, speeds, executor, None, first)
        if warning:
            warnings.warn(warning, UserWarning, stacklevel=2)
        yield found
        first += len(part)


def _speeds(speed_rpm: ArrayLike | None, speed_rad_s: ArrayLike | None) -> tuple[str, NDArray[Any]]:
    """Return the name of the argument that has the speeds, and its numbers."""
    if (speed_rpm is None) == (speed_rad_s is None):
        message = "give exactly one of speed_rpm and speed_rad_s"
        raise ValueError(message)
    name = "speed_rad_s" if speed_rpm is None else "speed_rpm"
    speeds = np.atleast_1d(_numbers(name, speed_rad_s if speed_rpm is None else speed_rpm))
    if speeds.ndim != 1:
        message = f"{name} has shape {speeds.shape}; allowed: a number or one dimension"
        raise ValueError(message)
    return name, speeds


def _swept(
    pumps: tuple[Pump, ...],
    name: str,
    speeds: NDArray[Any],
    executor: Executor | None,
    progress: _Progress | None,
    first: int = 0,
) -> tuple[Sweep, str | None]:
    """Return the steady states of pumps, the first of which has the number `first`, and a warning."""
    for number, pump in enumerate(pumps, start=first):
        if not isinstance(pump, Pump):
            message = f"pumps[{number}] must be a Pump, not {checks.told(pump)}"
            raise TypeError(message)
    if executor is None:
        results = _compute(pumps, name, speeds, first=first, progress=progress)
    else:
        results = _on_executor(executor, pumps, name, speeds, progress, first)

    speeds = speeds.astype(np.float64)
    # This order of operations gives the bits of the compiled module's own conversion.
    rad_s_per_rpm = math.tau / 60
    rpm, rad_s = (speeds, speeds * rad_s_per_rpm) if name == "speed_rpm" else (speeds / rad_s_per_rpm, speeds)
    found = Sweep(pumps, rpm, rad_s, *results)
    return found, _cavitating(found, first)


def _cavitating(found: Sweep, first: int) -> str | None:
    """Return the warning of pressures below 0 kPa absolute, if there are any."""
    lowest = np.minimum(found.inlet_min_kpa, found.outlet_min_kpa)
    below = int(np.count_nonzero(lowest < 0))
    if below == 0:
        return None
    row, column = np.unravel_index(np.argmin(lowest), lowest.shape)
    kpa = float(lowest[row, column])
    port = "inlet" if found.inlet_min_kpa[row, column] == kpa else "outlet"
    place = f"{port} of pumps[{first + row}] at {found.speed_rpm[column]:.6g} r/min"
    return _cavitation(kpa, f"{place}, the lowest of {below} of {lowest.size} points below 0")


def _compute(
    pumps: Sequence[Pump],
    name: str,
    speeds: NDArray[Any],
    *,
    threads: int | None = None,
    first: int = 0,
    progress: _Progress | None = None,
) -> list[_Array]:
    rpm, rad_s = (speeds, None) if name == "speed_rpm" else (None, speeds)
    return _steady_states(
        pumps, speed_rpm=rpm, speed_rad_s=rad_s, threads=threads, first=first, progress=progress
    )


def _on_executor(
    executor: Executor,
    pumps: tuple[Pump, ...],
    name: str,
    speeds: NDArray[Any],
    progress: _Progress | None,
    first: int,
) -> list[_Array]:
    shape = len(pumps), len(speeds)
    results = [np.empty(shape) for _ in RESULTS]
    tiles = list(_tiles(*shape))
    futures = [
        executor.submit(_tile, pumps[rows], name, speeds[columns], first + rows.start)
        for rows, columns in tiles
    ]
    done = 0
    try:
        # Results are taken in order, so the first of several errors is raised.
        for (rows, columns), future in zip(tiles, futures, strict=True):
            for whole, part in zip(results, future.result(), strict=True):
                whole[rows, columns] = part
                count = part.size
            done += count
            if progress:
                progress(done, shape[0] * shape[1])
    finally:
        for future in futures:
            future.cancel()
    return results


def _tile(pumps: Sequence[Pump], name: str, speeds: NDArray[Any], first: int) -> list[_Array]:
    """Do one task. The workers of an executor import this function."""
    return _compute(pumps, name, speeds, threads=1, first=first)


def _tiles(pumps: int, speeds: int) -> Iterator[tuple[slice, slice]]:
    """Cut the table into tasks: whole rows if rows are short, otherwise parts of one row."""
    rows = max(1, _TASK // max(1, speeds))
    for row in range(0, pumps, rows):
        for column in range(0, speeds, _TASK):
            yield slice(row, min(row + rows, pumps)), slice(column, min(column + _TASK, speeds))


def _show(done: int, total: int) -> None:
    end = "\n" if done == total else ""
    share = done / total if total else 1.0
    sys.stderr.write(f"\r{share:4.0%} of {total:,} steady states{end}")
    sys.stderr.flush()
