"""A verification by weighed doses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from pumpmodel._results.record import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Tolerance(Record):
    """The largest systematic and random errors allowed, in per cent."""

    systematic_percent: float
    random_percent: float


@dataclass(frozen=True)
class Verification(Record):
    """The errors of repeated doses of one volume: the command's JSON `verification/1`.

    The systematic error is the mean less the nominal volume, in mL and in per cent of nominal. The random
    error is the standard deviation (n - 1), in mL and in per cent of the mean (ISO 8655-6).
    """

    _records: ClassVar[dict[str, type[Record]]] = {"tolerance": Tolerance}

    schema: str
    nominal_ml: float
    volumes_ml: tuple[float, ...]
    mean_ml: float
    systematic_ml: float
    systematic_percent: float
    random_ml: float
    random_percent: float
    tolerance: Tolerance
    passed: bool

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw the doses in their order, with the nominal volume and the errors allowed.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw in. By default a new figure.

        Returns
        -------
        Axes
            Axes over the number of the dose.

        Raises
        ------
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.doses import plot_verification

        return plot_verification(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import verification_html

        return verification_html(self)
