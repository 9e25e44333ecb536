"""Continuous flow of a bench: for a time, for a volume, or until it is stopped."""

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pumpmodel._pumpmodel import Limits, _numbers
from pumpmodel._results.numbers import Number
from pumpmodel.bench.calls import stoppable
from pumpmodel.bench.planning import Progress
from pumpmodel.bench.repeats import BenchRepeats
from pumpmodel.bench.request import asked
from pumpmodel.choices import Ramps
from pumpmodel.dose import Dose


class BenchRuns(BenchRepeats):
    """The runs of continuous flow of a bench. Base of `Bench`."""

    @stoppable
    def run(
        self,
        *,
        rate: str | None = None,
        speed: str | None = None,
        duration: str | None = None,
        volume: str | None = None,
        profile: str | os.PathLike[str] | ArrayLike | None = None,
        reverse: bool = False,
        smooth: bool = False,
        ramps: Ramps | None = None,
        start_angle_rad: Number | None = None,
        start_half_width_rad: Number = 0.0,
        limits: Limits | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Pump at a rate for a time, for a volume, or until `stop`, or follow a flow over time.

        The carry between doses stays as it is.

        Without `duration`, `volume` and `profile` the run goes on until `stop` is called in another thread,
        which completes it. It keeps real time on a simulated motor too. Any other simulated run takes no
        time, unless the bench was opened with `pace="real"`.

        Parameters
        ----------
        rate : str, optional
            Average flow while cruising, as "10 mL/min"; "max" is the fastest flow that holds every limit.
        speed : str, optional
            Speed of the pump head while cruising, as "100rpm". Give at most one of `rate` and `speed`. The
            default is the pump's `default_rate_ml_s`.
        duration : str, optional
            Time from the first step to the last, ramps included, as "2h" or "30s".
        volume : str, optional
            Volume after which the run ends, as "1L". Give at most one of `duration` and `volume`.
        profile : path or array_like, optional
            Flow over time at the rollers: a CSV file with the columns time_s and flow_ml_s, or an array of
            rows of time (s) and flow (mL/s). It is linear between rows, and two rows of one time are a step.
            The steps keep within a motor step of it. Give no rate, speed or end beside it.
        reverse : bool
            Run in reverse.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        ramps : {"line", "fastest"}, optional
            Ramps in which the run starts and stops. The default leaves the outlet's line nearly at rest; a
            board that plans its own ramps has "fastest".
        start_angle_rad : float, optional
            Angle of the rollers at the start, rad; overrides the record.
        start_half_width_rad : float
            Half width of that angle, rad: the true angle lies within it on either side. 0 is an exact angle.
        limits : Limits, optional
            Pressure limits that replace the pump file's.
        dry_run : bool
            Plan and predict; move nothing, record nothing.
        progress : callable, optional
            Called with the steps made and the steps planned, a few times a second. An exception from it stops
            the motor. What cannot be called so is refused before the motor turns.

        Returns
        -------
        Dose
            The planned run and its result. `run` has its end and its mean flow. `completed` is False if
            `stop` stopped it before its time or its volume.

        Raises
        ------
        TypeError
            If a quantity is a bare number.
        ValueError
            If a text is not the expected quantity, if more than one of `duration`, `volume` and `profile` is
            given, or if the profile is no table of times and flows.
        PlanError
            If the pump cannot make the run. The message names the first instant of a profile that it cannot
            meet.
        UnfinishedError
            If an earlier dose or run is unfinished.
        SafetyError
            If the run would exceed a safety limit. A run until `stop` goes on up to the limit; the pump then
            stands, and the run is on record.
        PumpError
            If a run until `stop` ends by itself, as where its tube is nearly used up. It is complete and on
            record.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.

        Examples
        --------
        >>> import tempfile
        >>> import pumpmodel as pm
        >>> with tempfile.TemporaryDirectory() as tmp, pm.Bench.open("three-roller", state_dir=tmp) as bench:
        ...     run = bench.run(rate="10mL/s", duration="1min")
        ...     print(f"{run.delivered_ml:.0f} mL, {run.run.mean_flow_ml_s:.2f} mL/s")
        598 mL, 9.97 mL/s
        """
        if sum(end is not None for end in (duration, volume, profile)) > 1:
            raise ValueError("duration, volume and profile each end the run; give one of them, or none")
        request: dict[str, Any] = asked(
            volume,
            rate,
            speed,
            None,
            smooth,
            "any",
            ramps,
            None,
            start_angle_rad,
            start_half_width_rad,
            limits,
            duration=duration,
            until_stopped=duration is None and volume is None,
            reverse=reverse,
        )
        if profile is not None:
            flow = _flow(profile)
            if dry_run:
                return Dose._from_json(self._core.prepare_profile(request, flow))
            return Dose._from_json(self._core.run_profile(request, flow, progress))
        return self._run("run", request, dry_run, progress)


def _flow(
    profile: str | os.PathLike[str] | ArrayLike,
) -> tuple[str, str | os.PathLike[str] | None, list[float], list[float]]:
    """Return the name of a profile, and its file or its times and flows."""
    if isinstance(profile, str | os.PathLike):
        return os.path.basename(os.fspath(profile)), profile, [], []
    rows = np.asarray(_numbers("profile", profile))
    if rows.ndim != 2 or rows.shape[1] != 2:
        raise ValueError(f"profile has the shape {rows.shape}; allowed: rows of a time (s) and a flow (mL/s)")
    return "profile", None, rows[:, 0].tolist(), rows[:, 1].tolist()
