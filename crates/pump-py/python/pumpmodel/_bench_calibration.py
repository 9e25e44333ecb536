"""A bench's calibrations."""

from collections.abc import Callable, Sequence

from pumpmodel._pumpmodel import Calibration, _Bench
from pumpmodel.dose import Verification
from pumpmodel.weighed import PhaseFit, ShortDose, WeighedRun


class BenchCalibration:
    """Runs to weigh, and what becomes of the readings. Base of `Bench`."""

    _core: _Bench

    def calibration_run(
        self,
        *,
        speed_rpm: float | None = None,
        speed_rad_s: float | None = None,
        pitches: int,
        progress: Callable[[int, int], object] | None = None,
    ) -> WeighedRun:
        """Make a run that is to be weighed, of the uncalibrated pump.

        Parameters
        ----------
        speed_rpm : float
            Cruise speed, r/min.
        speed_rad_s : float
            The same in rad/s; exactly one of both is given.
        pitches : int
            How far, in whole pitches, 1 to 100,000; 50 mL or more weigh well.
        progress : callable, optional
            As of `dose`.

        Returns
        -------
        WeighedRun
            The run without a reading: `calibrate([run.weighed("42.51g"), ...])`.

        Raises
        ------
        DriveError
            If the motor cannot be used or fails, or `stop` stopped it.
        """
        return WeighedRun._made(self._core.calibration_run(speed_rpm, speed_rad_s, pitches, progress))

    def calibrate(
        self,
        runs: Sequence[WeighedRun],
        *,
        fit: str = "line",
        scale: str | None = None,
        tube: str | None = None,
        note: str | None = None,
    ) -> Calibration:
        """Fit weighed runs, keep what they show under the next number, and use it from now on.

        Parameters
        ----------
        runs : sequence of WeighedRun
            The runs, at three speeds or more if doses have several.
        fit : {"line", "speed-law"}, optional
            What is fitted over several speeds: a straight line, or the experimental law of `SpeedLaw`.
        scale : str, optional
            Standard uncertainty of a reading, as "0.01g" or "0.1mL".
        tube, note : str, optional
            For the record.

        Raises
        ------
        ValueError
            If there are no runs, or one of them cannot be right.
        DriveError
            If another process holds the pump.
        """
        return self._core.calibrate(runs, fit, scale, tube, note)

    def calibrate_phase(
        self,
        doses: Sequence[ShortDose],
        *,
        scale: str | None = None,
        tube: str | None = None,
        note: str | None = None,
    ) -> PhaseFit:
        """Find the zero of the angle from short doses, keep it under the next number, and use it from now on.

        Parameters
        ----------
        doses : sequence of ShortDose
            Five or more, from angles all over a pitch.
        scale, tube, note : str, optional
            As of `calibrate`.

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

    @property
    def calibration(self) -> Calibration | None:
        """The one that doses use; None if they use none."""
        return self._core.calibration

    def use_calibration(self, version: int | None) -> None:
        """Have doses use another calibration, or none, from now on.

        Raises
        ------
        ValueError
            If there is no such version.
        """
        self._core.use_calibration(version)

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
