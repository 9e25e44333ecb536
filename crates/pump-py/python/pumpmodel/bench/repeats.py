"""Doses of a bench that come again and again, and those that are finished."""

from collections.abc import Iterator

from pumpmodel._pumpmodel import Balance, Limits
from pumpmodel._results.numbers import Number
from pumpmodel.bench.calls import stoppable
from pumpmodel.bench.doses import BenchDoses
from pumpmodel.bench.planning import Progress
from pumpmodel.bench.request import asked, by_weight
from pumpmodel.bench.schedule import due
from pumpmodel.choices import Finish, Missed, Ramps
from pumpmodel.dose import Dose
from pumpmodel.errors import StoppedError


class BenchRepeats(BenchDoses):
    """The batches of a bench, and the rest of a dose. Base of `Bench`."""

    def batch(
        self,
        volume: str,
        count: int,
        *,
        every_s: Number | None = None,
        missed: Missed = "skip",
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
    ) -> Iterator[Dose]:
        """Dose again and again. Each step of `for dose in bench.batch(...)` makes one dose.

        Each dose carries its remainder to the next. A batch that is left early makes no more doses. A `stop`
        ends the batch from its first dose on: at the start of a dose, on its way, in its suck-back, and
        between two doses, where the wait ends within 0.05 s. A dose that is stopped on its way is the last
        one that the batch gives.

        Parameters
        ----------
        volume : str
            Volume or mass of every dose with its unit, as "25mL"; negative in reverse.
        count : int
            Number of doses, 1 to 1,000,000.
        every_s : float, optional
            Time from the start of a dose to the start of the next, s; by default one follows the other. It
            counts from the first `next` and includes the work of the caller between two doses.
        missed : {"skip", "now"}
            "skip" leaves out a dose whose time has passed, with a warning; "now" makes it at once.
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
            Angle of the rollers at the start of the first dose, rad; overrides the record.
        start_half_width_rad : float
            Half width of that angle, rad: the true angle lies within it on either side. 0 is an exact angle.
        limits : Limits, optional
            Pressure limits that replace the pump file's.

        Yields
        ------
        Dose
            Each dose with its result.

        Raises
        ------
        ValueError
            If `count`, `every_s` or `missed` is not allowed, or a text is not the expected quantity.

        Warns
        -----
        RuntimeWarning
            For each dose that was left out.
        """
        call = self._core.begin("batch", lasts=True)
        try:
            with call:
                # A board may take seconds to answer, and the time counts from the first dose.
                self._core.connect()
            for _ in due(count, every_s, missed, call):
                with call:
                    dose = self.dose(
                        volume,
                        rate=rate,
                        speed=speed,
                        within=within,
                        smooth=smooth,
                        finish=finish,
                        ramps=ramps,
                        retract=retract,
                        start_angle_rad=start_angle_rad,
                        start_half_width_rad=start_half_width_rad,
                        limits=limits,
                    )
                yield dose
                if dose.retraction_completed is False:
                    # The caller wanted the motor to stand.
                    return
                start_angle_rad, start_half_width_rad = None, 0.0
        except StoppedError:
            # The dose that was about to start is the one that the batch does not make.
            return
        finally:
            call.end()

    @stoppable
    def resume(
        self,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Finish | None = None,
        ramps: Ramps | None = None,
        limits: Limits | None = None,
        until_scale: Balance | None = None,
        max_volume: str | None = None,
        slow_rate: str | None = None,
        scale: str | None = None,
        progress: Progress | None = None,
    ) -> Dose:
        """Make the rest of a dose that was stopped or cut off.

        Parameters
        ----------
        rate : str, optional
            Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
        speed : str, optional
            Speed of the pump head while cruising, as "100rpm".
        within : str, optional
            Total time with ramps and settling, as "10s". Give at most one of `rate`, `speed` and `within`.
            The default is the speed of the whole dose. A speed of its own makes the rest of a smooth dose at
            constant speed.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        finish : {"any", "low-flow"}, optional
            Places in a pitch where the dose may end. The default is that of the whole dose.
        ramps : {"line", "fastest"}, optional
            Ramps in which the rest starts and stops. The default is that of the whole dose.
        limits : Limits, optional
            Pressure limits that replace the pump file's.
        until_scale : Balance, optional
            Balance that ends the rest of a dose by weight. The vessel stands on it as the dose left it:
            the record has what it showed before the dose. Without it the rest is made by volume.
        max_volume : str, optional
            Most that the pump may turn for in the whole dose, by the model, as "27mL". The default is
            that of the whole dose.
        slow_rate : str, optional
            Flow of the last part, as "0.5 mL/s". The default is a tenth of the rest's.
        scale : str, optional
            Standard uncertainty of a reading of the balance, as "0.01g" or "0.01mL".
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
            If a text is not the expected quantity.
        PumpError
            If no dose is unfinished.
        PlanError
            If the pump cannot make the rest.
        UnfinishedError
            If the rest cannot be made by weight: no balance was to end the dose, or the balance does not
            show what the pump can have delivered. Nothing moves.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        BalanceError
            If the balance cannot be read, or fails while the pump turns.
        """
        request = asked(None, rate, speed, within, smooth, finish, ramps, None, None, 0.0, limits)
        weighed = by_weight(until_scale, max_volume, slow_rate, scale)
        if weighed is not None:
            return Dose._from_json(self._core.resume_by_weight(request, weighed, progress))
        return Dose._from_json(self._core.resume(request, progress))
