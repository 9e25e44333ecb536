"""A bench's record: where the rollers stand, the tube, and a dose that is unfinished."""

import warnings

from pumpmodel._pumpmodel import _Bench
from pumpmodel.dose import Status


class BenchRecord:
    """What a person says of a bench, and what is on record of it. Base of `Bench`."""

    _core: _Bench

    def status(self) -> Status:
        """Read what is on record; another process may hold the pump.

        Raises
        ------
        PumpError
            If the journal is damaged; `home_set` puts it aside.
        """
        return Status._from_json(self._core.status())

    def discard(self) -> Status:
        """Accept a dose that was stopped or cut off as it is. What doses owe is zero afterwards.

        Raises
        ------
        PumpError
            If nothing is unfinished.
        DriveError
            If another process holds the pump.
        """
        return _told(self._core.discard())

    def home_set(self, angle_rad: float | None, *, half_width_rad: float = 0.0) -> Status:
        """Record where the rollers stand. What doses owe is zero afterwards.

        Parameters
        ----------
        angle_rad : float or None
            The angle, rad: at 0 a roller begins to leave the outlet. None: nobody knows.
        half_width_rad : float
            The true angle lies within this of it, rad.

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

    def home_sensor(self) -> Status:
        """Turn forward, a revolution at most, until the index sensor answers. The pump pumps meanwhile.

        Raises
        ------
        DriveError
            If there is no sensor, or it does not answer.
        PumpFileError
            If the pump file does not say at which angle it answers.
        """
        return _told(self._core.home_sensor())

    def home_mark(self, *, half_width_rad: float) -> Status:
        """Record that the rotor's mark meets the housing's, as `jog` turned it.

        Parameters
        ----------
        half_width_rad : float
            How well the marks can be seen to meet, rad.

        Raises
        ------
        PumpFileError
            If the pump file does not say at which angle they meet.
        """
        return _told(self._core.home_mark(half_width_rad))

    def jog(self, angle_rad: float) -> float:
        """Turn the rotor at 10 r/min; what doses owe each other stays as it is.

        Parameters
        ----------
        angle_rad : float
            How far, rad, up to 100; negative in reverse.

        Returns
        -------
        float
            How far it was turned, rad: whole steps, one at least.
        """
        return self._core.jog(angle_rad)

    def release(self) -> Status:
        """Let go of the rotor; its angle is less well known afterwards."""
        return _told(self._core.release())

    def new_tube(self) -> Status:
        """Record that the tube was exchanged.

        It has pumped nothing, doses owe nothing, and no calibration is used.
        """
        return _told(self._core.new_tube())


def _told(told: tuple[str, list[str]]) -> Status:
    text, said = told
    for words in said:
        warnings.warn(words, stacklevel=3)
    return Status._from_json(text)
