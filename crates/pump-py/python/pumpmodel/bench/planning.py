"""Plans of a bench, and what its doses have in common."""

from collections.abc import Callable
from typing import Any

from pumpmodel._pumpmodel import Calibration, Doser, Limits, Plan, Pump
from pumpmodel._results.numbers import Number
from pumpmodel.bench.calls import HasCore
from pumpmodel.bench.request import asked
from pumpmodel.choices import Finish, Ramps
from pumpmodel.dose import Dose

Progress = Callable[[int, int], object]


class BenchPlans(HasCore):
    """The plans of a bench. Base of `Bench`."""

    @property
    def pump(self) -> Pump:
        """Pump of the bench."""
        return self._core.pump

    @property
    def calibration(self) -> Calibration | None:
        """Calibration that doses use; None without one."""
        return self._core.calibration

    @property
    def last_dose(self) -> Dose | None:
        """Result of the dose or run that ended last: of one that Ctrl-C or `progress` interrupted too.

        None before the first, and where the last one was refused before it moved.
        """
        text = self._core.last
        return None if text is None else Dose._from_json(text)

    def plan(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Finish = "any",
        ramps: Ramps | None = None,
        retract: str | None = None,
        start_angle_rad: Number | None = None,
        start_half_width_rad: Number = 0.0,
        limits: Limits | None = None,
    ) -> Plan:
        """Plan a dose from the record, with the calibration in use, for its steps and waveform.

        Nothing moves, and nothing is recorded.

        Parameters
        ----------
        volume : str
            Volume or mass with its unit, as "25mL", "250uL", "25 g"; negative in reverse.
        rate : str, optional
            Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
        speed : str, optional
            Speed of the pump head while cruising, as "100rpm".
        within : str, optional
            Total time with ramps and settling, as "10s". Give at most one of `rate`, `speed` and `within`.
            The default is the pump's `default_rate_ml_s`.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        finish : {"any", "low-flow"}
            Places in a pitch where the dose may end.
        ramps : {"line", "fastest"}, optional
            Ramps in which the dose starts and stops. The default leaves the outlet's line nearly at rest;
            a board that plans its own ramps has "fastest".
        retract : str, optional
            Volume that is sucked back after the dose, as "0.1mL". The next dose repays it.
        start_angle_rad : float, optional
            Angle of the rollers at the start, rad; overrides the record.
        start_half_width_rad : float
            Half width of that angle, rad: the true angle lies within it on either side. 0 is an exact angle.
        limits : Limits, optional
            Pressure limits that replace the pump file's.

        Returns
        -------
        Plan
            Steps, times and predicted pressures.

        Raises
        ------
        TypeError
            If a quantity is a bare number.
        ValueError
            If a text is not the expected quantity.
        PlanError
            If the pump cannot make the dose.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        request = asked(
            volume,
            rate,
            speed,
            within,
            smooth,
            finish,
            ramps,
            retract,
            start_angle_rad,
            start_half_width_rad,
            limits,
        )
        self._core.prepare("dose", request)
        angle_rad: Number
        half_width_rad: Number
        angle_rad, half_width_rad, carry_ml = self._core.stands
        if start_angle_rad is not None:
            angle_rad, half_width_rad = start_angle_rad, start_half_width_rad
        keywords: dict[str, Any] = {"rate": rate, "speed": speed, "within": within}
        return Doser(self.pump, limits, self.calibration).plan(
            volume,
            smooth=smooth,
            finish=finish,
            ramps=ramps or "line",
            retract=retract,
            start_angle_rad=angle_rad,
            start_half_width_rad=half_width_rad,
            carry_in_ml=carry_ml,
            **keywords,
        )

    def stop(self) -> str | None:
        """Make every call under way in other threads decelerate the motor, which then holds.

        A call is under way from its first instruction to its last, and a batch from its first dose to its
        end, its waits included. A dose that is stopped on its way returns, with `completed` False. One that
        is stopped before its motion raises StoppedError. A batch makes no more doses. A call whose last step
        is made completes.

        Returns
        -------
        str or None
            Names of the methods that the stop has reached, as "dose" or "batch, prime"; None if none is
            under way. Calls that begin later are not stopped.
        """
        return ", ".join(self._core.stop()) or None

    def _run(self, purpose: str, request: dict[str, Any], dry_run: bool, progress: Progress | None) -> Dose:
        if dry_run:
            return Dose._from_json(self._core.prepare(purpose, request))
        return Dose._from_json(self._core.dose(purpose, request, progress))
