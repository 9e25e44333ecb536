"""The calibrations of a bench."""

from collections.abc import Callable, Sequence

from pumpmodel._pumpmodel import Calibration
from pumpmodel._results.numbers import Number
from pumpmodel.bench.calls import HasCore, stoppable
from pumpmodel.choices import CalibrationFit
from pumpmodel.dose import Verification
from pumpmodel.weighed import PhaseFit, ShortDose, WeighedRun


class BenchCalibration(HasCore):
    """Runs to weigh, and fits to their readings. Base of `Bench`."""

    @stoppable
    def calibration_run(
        self,
        *,
        speed_rpm: Number | None = None,
        speed_rad_s: Number | None = None,
        pitches: int,
        progress: Callable[[int, int], object] | None = None,
    ) -> WeighedRun:
        """Make a run to be weighed. It does not apply the calibration in use.

        Parameters
        ----------
        speed_rpm : float
            Cruise speed, r/min.
        speed_rad_s : float
            Cruise speed, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
        pitches : int
            Length of the run in whole pitches, 1 to 100,000. 50 mL or more weigh well.
        progress : callable, optional
            Called with the steps made and the steps planned, a few times a second. An exception from it stops
            the motor. What cannot be called so is refused before the motor turns.

        Returns
        -------
        WeighedRun
            Run without a reading: `calibrate([run.weighed("42.51g"), ...])`.

        Raises
        ------
        DriveError
            If the motor cannot be used or fails, or `stop` stopped the run.
        """
        return WeighedRun._made(self._core.calibration_run(speed_rpm, speed_rad_s, pitches, progress))

    def calibrate(
        self,
        runs: Sequence[WeighedRun],
        *,
        fit: CalibrationFit = "best",
        scale: str | None = None,
        tube: str | None = None,
        note: str | None = None,
    ) -> Calibration:
        """Fit weighed runs, keep the calibration under the next number, and use it from now on.

        Parameters
        ----------
        runs : sequence of WeighedRun
            Runs with their readings, at three speeds or more if doses have several speeds.
        fit : {"best", "line", "factor", "speed-law"}, optional
            Curve that is fitted over several speeds: a straight line or, where four speeds or more ask for
            it, a parabola; a straight line alone; one factor for every speed; or the experimental law of
            `SpeedLaw`.
        scale : str, optional
            Standard uncertainty of a reading, as "0.01g" or "0.1mL".
        tube, note : str, optional
            Texts for the record.

        Returns
        -------
        Calibration
            Calibration that doses use from now on.

        Raises
        ------
        ValueError
            If there are no runs, or a run is impossible.
        DriveError
            If another process holds the pump.
        """
        return self._core.calibrate(runs, fit, scale, tube, note)

    def calibrate_last(
        self,
        reading: str,
        *,
        add: bool = False,
        anew: bool = False,
        anyway: bool = False,
        scale: str | None = None,
        tube: str | None = None,
        note: str | None = None,
    ) -> Calibration:
        """Calibrate by the weight of the dose just made.

        The reading joins those of earlier doses that were weighed in this way.

        Parameters
        ----------
        reading : str
            Reading of the scale or vessel, as "23.8g" or "24mL".
        add : bool, optional
            Join the reading to the runs of the calibration in use, whatever made them.
        anew : bool, optional
            Calibrate by this reading alone.
        anyway : bool, optional
            Take a reading that lies far beyond the uncertainty of the dose.
        scale : str, optional
            Standard uncertainty of a reading, as "0.01g". Without it the last digit of the reading tells it.
        tube, note : str, optional
            Texts for the record.

        Returns
        -------
        Calibration
            Calibration that doses use from now on, unless it is less sure than the model and no other is in
            use. Then it waits for the next weighed dose.

        Raises
        ------
        ValueError
            If the reading cannot be that of the last dose, or no dose is on record.
        DriveError
            If another process holds the pump.
        """
        return self._core.calibrate_last(reading, add, anew, anyway, scale, tube, note)

    def calibrate_phase(
        self,
        doses: Sequence[ShortDose],
        *,
        scale: str | None = None,
        tube: str | None = None,
        note: str | None = None,
    ) -> PhaseFit:
        """Find the pulse and the zero of the angle from short doses, and use them from now on.

        Parameters
        ----------
        doses : sequence of ShortDose
            Five or more doses, from angles all over a pitch.
        scale : str, optional
            Standard uncertainty of a reading, as "0.01g" or "0.1mL".
        tube, note : str, optional
            Texts for the record.

        Returns
        -------
        PhaseFit
            Fitted roller volume, engagement angle and zero, and the calibration that keeps them.

        Raises
        ------
        ValueError
            If the doses do not determine the zero.
        """
        numbers = [(dose.start_angle_deg, dose.turned_deg, dose.volume_ml, dose.speed_rpm) for dose in doses]
        calibration, (roller, engagement, zero) = self._core.calibrate_phase(numbers, scale, tube, note)
        return PhaseFit(calibration, *roller, *engagement, *zero)

    def calibrations(self) -> list[Calibration]:
        """Return every calibration, oldest first."""
        return self._core.calibrations()

    def use_calibration(self, version: int | None) -> None:
        """Make doses use another calibration, or none, from now on.

        Parameters
        ----------
        version : int or None
            Number of the calibration; None for none.

        Raises
        ------
        ValueError
            If no calibration has this number.
        """
        self._core.use_calibration(version)

    def verify(
        self,
        nominal: str,
        readings: Sequence[str],
        *,
        systematic_percent: Number | None = None,
        random_percent: Number | None = None,
    ) -> Verification:
        """Judge weighed doses of one volume, as ISO 8655-6 reports them. Nothing moves or is recorded.

        Parameters
        ----------
        nominal : str
            Volume that every dose should have, as "10mL".
        readings : sequence of str
            Reading of scale or vessel for each dose, as "9.98g" or "10.01mL"; two at least, ten by the
            standard. Masses are masses of the bench's fluid at its temperature.
        systematic_percent : float, optional
            Largest systematic error allowed, in per cent; by default the limit of ISO 8655-5 for 10 mL.
        random_percent : float, optional
            Largest random error allowed, in per cent; by default the limit of ISO 8655-5 for 10 mL.

        Returns
        -------
        Verification
            Both errors, and the result of the comparison with the tolerance.

        Raises
        ------
        ValueError
            If a text is not a reading, or no tolerance is known.
        """
        return Verification._from_json(
            self._core.verify(nominal, readings, systematic_percent, random_percent)
        )
