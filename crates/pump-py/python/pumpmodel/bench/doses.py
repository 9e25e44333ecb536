"""Doses of a bench, and volumes that fill and empty the line."""

from pumpmodel._pumpmodel import Balance, Limits
from pumpmodel._results.numbers import Number
from pumpmodel.bench.calls import stoppable
from pumpmodel.bench.planning import BenchPlans, Progress
from pumpmodel.bench.request import asked, by_weight, one_end
from pumpmodel.choices import Finish, Ramps
from pumpmodel.dose import Dose


class BenchDoses(BenchPlans):
    """The doses of a bench. Base of `Bench`."""

    @stoppable
    def dose(
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
        until_scale: Balance | None = None,
        max_volume: str | None = None,
        slow_rate: str | None = None,
        scale: str | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Plan, run and record one dose.

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
        until_scale : Balance, optional
            Balance under the vessel that ends the dose in place of the model. The vessel need not be tared.
            The last part is dosed slowly, and the motor stops so that what still falls makes up the rest.
            The dose runs forward, with no `within`, `smooth`, `finish`, `retract` or `start_angle_rad`.
        max_volume : str, optional
            Most that the pump may turn for in a dose by weight, by the model, as "27mL": the volume of the
            dose or more. The default is the dose and its uncertainty.
        slow_rate : str, optional
            Flow of the last part of a dose by weight, as "0.5 mL/s". The default is a tenth of the dose's.
        scale : str, optional
            Standard uncertainty of a reading of the balance, as "0.01g" or "0.01mL". The default is that of
            its last digit.
        dry_run : bool
            Plan and predict; move nothing, record nothing.
        progress : callable, optional
            Called with the steps made and the steps planned, a few times a second. An exception from it stops
            the motor. What cannot be called so is refused before the motor turns.

        Returns
        -------
        Dose
            The planned dose and its result. `completed` is False if `stop` stopped it. A dose by weight has
            the `volume_basis` "weighed", carries nothing, and has its weighing in `by_weight`.

        Raises
        ------
        TypeError
            If a quantity is a bare number, or `until_scale` no Balance.
        ValueError
            If a text is not the expected quantity, or a keyword of a dose by weight lacks `until_scale`.
        PlanError
            If the pump cannot make the dose, or no balance can end it.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        BalanceError
            If the balance cannot be read: nothing moves then. If it fails while the pump turns, or never
            shows what was asked for, the motor decelerates and the dose is unfinished; `resume` makes its
            rest, by weight with `until_scale` or by volume, `discard` accepts it.

        Examples
        --------
        A function stands in for the balance here, and reads the volume of the simulated pump on record.

        >>> import tempfile
        >>> import pumpmodel as pm
        >>> with tempfile.TemporaryDirectory() as tmp, pm.Bench.open("three-roller", state_dir=tmp) as bench:
        ...     balance = pm.Balance.function(lambda: f"{bench.status().wear.volume_ml:.2f} g")
        ...     dose = bench.dose("25g", until_scale=balance)
        ...     print(f"{dose.volume_basis}: {dose.by_weight.mass_g:.2f} g")
        weighed: 25.00 g
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
        weighed = by_weight(until_scale, max_volume, slow_rate, scale)
        if weighed is None:
            return self._run("dose", request, dry_run, progress)
        if dry_run:
            return Dose._from_json(self._core.prepare_by_weight(request, weighed))
        return Dose._from_json(self._core.dose_by_weight(request, weighed, progress))

    @stoppable
    def prime(
        self,
        volume: str | None = None,
        *,
        duration: str | None = None,
        reverse: bool = False,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        ramps: Ramps | None = None,
        start_angle_rad: Number | None = None,
        start_half_width_rad: Number = 0.0,
        limits: Limits | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Fill the line before a dose. The carry between doses stays as it is.

        Parameters
        ----------
        volume : str, optional
            Volume or mass with its unit, as "25mL", "250uL", "25 g"; negative in reverse.
        duration : str, optional
            Time from the first step to the last, ramps included, as "20s". Give one of `volume` and
            `duration`; `within` goes with a volume.
        reverse : bool
            Run in reverse.
        rate : str, optional
            Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
        speed : str, optional
            Speed of the pump head while cruising, as "100rpm".
        within : str, optional
            Total time with ramps and settling, as "10s". Give at most one of `rate`, `speed` and `within`.
            The default is the pump's `default_rate_ml_s`.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        ramps : {"line", "fastest"}, optional
            Ramps in which the motion starts and stops. The default leaves the outlet's line nearly at
            rest; a board that plans its own ramps has "fastest".
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
            The planned dose and its result. `completed` is False if `stop` stopped it.

        Raises
        ------
        TypeError
            If a quantity is a bare number.
        ValueError
            If a text is not the expected quantity, or not one of `volume` and `duration` is given.
        PlanError
            If the pump cannot make the dose.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        one_end(volume, duration)
        request = asked(
            volume,
            rate,
            speed,
            within,
            smooth,
            "any",
            ramps,
            None,
            start_angle_rad,
            start_half_width_rad,
            limits,
            duration=duration,
            reverse=reverse,
        )
        return self._run("prime", request, dry_run, progress)

    @stoppable
    def purge(
        self,
        volume: str | None = None,
        *,
        duration: str | None = None,
        reverse: bool = False,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        ramps: Ramps | None = None,
        start_angle_rad: Number | None = None,
        start_half_width_rad: Number = 0.0,
        limits: Limits | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Empty the line. A negative volume runs back. The carry between doses stays as it is.

        Parameters
        ----------
        volume : str, optional
            Volume or mass with its unit, as "25mL", "250uL", "25 g"; negative in reverse.
        duration : str, optional
            Time from the first step to the last, ramps included, as "20s". Give one of `volume` and
            `duration`; `within` goes with a volume.
        reverse : bool
            Run in reverse.
        rate : str, optional
            Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
        speed : str, optional
            Speed of the pump head while cruising, as "100rpm".
        within : str, optional
            Total time with ramps and settling, as "10s". Give at most one of `rate`, `speed` and `within`.
            The default is the pump's `default_rate_ml_s`.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        ramps : {"line", "fastest"}, optional
            Ramps in which the motion starts and stops. The default leaves the outlet's line nearly at
            rest; a board that plans its own ramps has "fastest".
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
            The planned dose and its result. `completed` is False if `stop` stopped it.

        Raises
        ------
        TypeError
            If a quantity is a bare number.
        ValueError
            If a text is not the expected quantity, or not one of `volume` and `duration` is given.
        PlanError
            If the pump cannot make the dose.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        one_end(volume, duration)
        request = asked(
            volume,
            rate,
            speed,
            within,
            smooth,
            "any",
            ramps,
            None,
            start_angle_rad,
            start_half_width_rad,
            limits,
            duration=duration,
            reverse=reverse,
        )
        return self._run("purge", request, dry_run, progress)
