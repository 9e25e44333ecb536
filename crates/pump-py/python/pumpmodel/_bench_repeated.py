"""A bench's repeated doses: batches, and what weighed doses show."""

import time
import warnings
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Literal

from pumpmodel._pumpmodel import Limits, _Bench, _Schedule
from pumpmodel.dose import Dose, Verification

if TYPE_CHECKING:
    from pumpmodel.bench import Bench


class BenchRepeated:
    """Doses that are made again and again. Base of `Bench`."""

    _core: _Bench

    def batch(
        self: "Bench",
        volume: str,
        count: int,
        *,
        every_s: float | None = None,
        missed: Literal["skip", "now"] = "skip",
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Literal["any", "low-flow"] = "any",
        retract: str | None = None,
        start_angle_rad: float | None = None,
        limits: Limits | None = None,
    ) -> Iterator[Dose]:
        """Dose again and again: each dose is made as it is asked for, as by `for dose in bench.batch(...)`.

        What a dose leaves over is carried to the next. A batch that is left early makes no more doses.

        Parameters
        ----------
        volume : str
            Of every dose.
        count : int
            How many doses, 1 to 1,000,000.
        every_s : float, optional
            Time from the start of a dose to the start of the next, s; by default one follows the other. It
            counts from the first `next`; what is done between two doses takes of it.
        missed : {"skip", "now"}
            Whether a dose whose time has passed is left out, which is warned of, or made at once.
        rate, speed, within, smooth, finish, retract, start_angle_rad, limits
            As of `dose`; the start angle is the first dose's.

        Yields
        ------
        Dose
            What came of each.

        Raises
        ------
        ValueError
            If count, every_s or missed is not allowed.

        Warns
        -----
        RuntimeWarning
            Of each dose that was left out.
        """
        schedule = _Schedule(count, every_s, missed)
        started = time.monotonic()
        while True:
            action, number = schedule.next(time.monotonic() - started)
            if action == "done":
                return
            if action == "wait":
                time.sleep(max(0.0, number - (time.monotonic() - started)))
            elif action == "skip":
                message = f"dose {number:.0f} of {count} was skipped: its time had passed"
                warnings.warn(message, RuntimeWarning, stacklevel=2)
            else:
                yield self.dose(
                    volume,
                    rate=rate,
                    speed=speed,
                    within=within,
                    smooth=smooth,
                    finish=finish,
                    retract=retract,
                    start_angle_rad=start_angle_rad,
                    limits=limits,
                )
                start_angle_rad = None

    def verify(
        self,
        nominal: str,
        readings: Sequence[str],
        *,
        systematic_percent: float | None = None,
        random_percent: float | None = None,
    ) -> Verification:
        """Judge weighed doses of one volume, as ISO 8655-6 reports them. Moves and records nothing.

        Parameters
        ----------
        nominal : str
            What every dose should be, as "10mL".
        readings : sequence of str
            What scale or vessel showed for each, as "9.98g" or "10.01mL"; two at least, ten by the standard.
            Masses are those of the bench's fluid at its temperature.
        systematic_percent, random_percent : float, optional
            Largest errors allowed, in per cent; by default those of ISO 8655-5 for 10 mL.

        Returns
        -------
        Verification
            Both errors, and whether they are allowed.

        Raises
        ------
        ValueError
            If a reading is none, or no tolerance is known.
        """
        return Verification._from_json(
            self._core.verify(nominal, readings, systematic_percent, random_percent)
        )
