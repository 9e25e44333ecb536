"""The record of a bench: the angle of the rollers, the tube, and an unfinished dose."""

import warnings

from pumpmodel._results.numbers import Number
from pumpmodel._results.renamed import renamed
from pumpmodel.bench.calls import HasCore, stoppable
from pumpmodel.dose import LoggedDose, Status


class BenchRecord(HasCore):
    """The record of a bench, and the entries that a person makes in it. Base of `Bench`."""

    def status(self) -> Status:
        """Read the record, even while another process holds the pump.

        Raises
        ------
        PumpError
            If the journal is damaged. `home_set` puts it aside.
        """
        return Status._from_json(self._core.status())

    def log(self, since: str | None = None) -> list[LoggedDose]:
        """Read the log, even while another process holds the pump: every dose, oldest first.

        Parameters
        ----------
        since : str, optional
            Leave out doses that began before: "2d" or "90min" ago, a date as "2026-11-23", or a time with
            its offset, as "2026-11-23T08:00:00+01:00".

        Raises
        ------
        ValueError
            If `since` is no such text.
        PumpError
            If the log cannot be read.

        Warns
        -----
        UserWarning
            If doses are left out although a dose before them is listed: a clock had gone back. If a line of
            the log is damaged.

        Examples
        --------
        >>> import tempfile
        >>> import pumpmodel as pm
        >>> with tempfile.TemporaryDirectory() as tmp, pm.Bench.open("three-roller", state_dir=tmp) as bench:
        ...     dose = bench.dose("25mL")
        ...     [logged] = bench.log(since="1d")
        >>> logged.asked, logged.end, logged.time == dose.time
        ('25mL', 'done', True)
        """
        return [LoggedDose._from_json(text) for text in self._core.log(since)]

    def discard(self) -> Status:
        """Accept an unfinished dose with the volume that was delivered. The carry is zero afterwards.

        Raises
        ------
        PumpError
            If no dose is unfinished.
        DriveError
            If another process holds the pump.
        """
        return _told(self._core.discard())

    def home_set(self, angle_rad: Number | None, *, half_width_rad: Number = 0.0) -> Status:
        """Record the angle of the rollers. The carry is zero afterwards.

        Parameters
        ----------
        angle_rad : float or None
            Angle of the rollers, rad; at 0 a roller begins to leave the outlet. None: the angle is unknown.
        half_width_rad : float
            Half width of the angle, rad: the true angle lies within it on either side.

        Raises
        ------
        ValueError
            If an angle is not finite, or the half width negative.
        UnfinishedError
            If a dose is unfinished.
        DriveError
            If another process holds the pump.
        """
        return _told(self._core.home_set(angle_rad, half_width_rad))

    @stoppable
    def home_sensor(self) -> Status:
        """Turn forward, a revolution at most, until the index sensor answers. The pump pumps meanwhile.

        Raises
        ------
        DriveError
            If the pump has no sensor, or the sensor does not answer.
        PumpFileError
            If the pump file does not have the angle at which the sensor answers.
        """
        # One call more than of the others stands between: that of `stoppable`.
        return _told(self._core.home_sensor(), 4)

    def home_mark(self, *, half_width_rad: Number) -> Status:
        """Record that the rotor's mark meets the housing's. `jog_rad` turns the rotor there.

        Parameters
        ----------
        half_width_rad : float
            Half width of the angle at which the marks appear to meet, rad.

        Raises
        ------
        PumpFileError
            If the pump file does not have the angle at which the marks meet.
        """
        return _told(self._core.home_mark(half_width_rad))

    @stoppable
    def jog_rad(self, angle_rad: Number) -> float:
        """Turn the rotor at 10 r/min. The carry between doses stays as it is.

        Parameters
        ----------
        angle_rad : float
            Angle to turn, rad, up to 100; negative in reverse.

        Returns
        -------
        float
            Angle of the steps made, rad: whole steps, one at least.
        """
        return self._core.jog(angle_rad)

    def jog(self, angle_rad: Number) -> float:
        """Turn the rotor, by the deprecated name of `jog_rad`."""
        renamed("Bench.jog", "Bench.jog_rad")
        return self.jog_rad(angle_rad)

    def release(self) -> Status:
        """Release the rotor. Its angle is less well known afterwards."""
        return _told(self._core.release())

    def new_tube(self) -> Status:
        """Record that the tube was replaced.

        Afterwards the tube has pumped nothing, the carry is zero, and no calibration is used.
        """
        return _told(self._core.new_tube())

    def clear_safety(self, reason: str) -> Status:
        """Let the pump go on that stands at a safety limit. The volumes of the last 24 hours count no more.

        Parameters
        ----------
        reason : str
            Reason why it may go on. The journal keeps it.

        Raises
        ------
        ValueError
            If the pump does not stand, or the reason is empty or longer than 1000 bytes.
        """
        return _told(self._core.clear_safety(reason))

    def vessel_emptied(self) -> Status:
        """Record that the receiving vessel is empty. A pump that stands at a safety limit stands on."""
        return _told(self._core.vessel_emptied())


def _told(told: tuple[str, list[str]], stacklevel: int = 3) -> Status:
    text, messages = told
    for message in messages:
        warnings.warn(message, stacklevel=stacklevel)
    return Status._from_json(text)
