"""The schedule of a batch."""

import time
import warnings
from collections.abc import Iterator

from pumpmodel._pumpmodel import _Call, _Schedule
from pumpmodel._results.numbers import Number
from pumpmodel.choices import Missed

# Longest time until a wait hears of a stop, s.
_LOOK_S = 0.05


def due(count: int, every_s: Number | None, missed: Missed, call: _Call) -> Iterator[None]:
    """Yield once for each dose of a batch, when the dose is due.

    Parameters
    ----------
    count : int
        Number of doses, 1 to 1,000,000.
    every_s : float or None
        Time from the start of a dose to the start of the next, s; None: one follows the other.
    missed : {"skip", "now"}
        "skip" leaves out a dose whose time has passed, "now" makes it at once.
    call : _Call
        Call of the batch. Once it is stopped no dose is due.

    Yields
    ------
    None
        Once for each dose.

    Raises
    ------
    ValueError
        If an argument is not allowed.

    Warns
    -----
    RuntimeWarning
        For each dose that was left out. It names the caller of the generator that iterates over this one.
    """
    schedule = _Schedule(count, every_s, missed)
    started = time.monotonic()
    while not call.stopped:
        action, number = schedule.next(time.monotonic() - started)
        if action == "done":
            return
        if action == "wait":
            time.sleep(min(_LOOK_S, max(0.0, number - (time.monotonic() - started))))
        elif action == "skip":
            message = f"dose {number:.0f} of {count} was skipped: its time had passed"
            warnings.warn(message, RuntimeWarning, stacklevel=3)
        else:
            yield
