"""Doubts of a function that is taken for the volume of a roller."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]

# A rise between two samples is a jump if it is this part of the volume, and so many times those beside it.
_JUMP_PART, _JUMP_TIMES = 0.01, 5.0

# A sample is an outlier if it is this part of the volume off the middle of its neighbours, and so many times
# as far off as the samples beyond them.
_OUTLIER_PART, _OUTLIER_TIMES = 1e-3, 5.0

# Part of the engagement over which a volume may be constant at an end, as a gentle one nearly is.
_CONSTANT_PART = 0.05

# A rise is none within this part of the largest volume.
_ROUNDING = 1e-9


def doubts_of(angles: _Array, volumes: _Array) -> Iterator[str]:
    """Yield what makes samples of a function doubtful: a jump, an outlier, or a constant at an end.

    Parameters
    ----------
    angles : numpy.ndarray
        Angles since the first contact, deg, at even distances, shape (n,).
    volumes : numpy.ndarray
        Volumes, mL, that do not fall, shape (n,).
    """
    total = volumes[-1]
    rises = np.diff(volumes)
    outliers = _outliers(volumes, total)
    for at in outliers:
        yield (
            f"function has an outlier, {volumes[at]:.6g} mL at {angles[at]:.6g} deg between "
            f"{volumes[at - 1]:.6g} and {volumes[at + 1]:.6g} mL; the fit smooths it"
        )
    for at in _jumps(rises, total):
        if at not in outliers and at + 1 not in outliers:
            yield (
                f"function jumps from {volumes[at]:.6g} mL at {angles[at]:.6g} deg to "
                f"{volumes[at + 1]:.6g} mL at {angles[at + 1]:.6g} deg; the fit smooths it over 1/24 of the "
                "engagement"
            )
    rising = np.flatnonzero(rises > _ROUNDING * total)
    begin, end = angles[rising[0]], angles[rising[-1] + 1]
    if begin > _CONSTANT_PART * angles[-1]:
        yield (
            f"function is constant, 0 mL, up to {begin:.6g} deg; a roller displaces volume from its first "
            "contact at 0 deg on"
        )
    if end < (1 - _CONSTANT_PART) * angles[-1]:
        yield (
            f"function is constant, {total:.6g} mL, from {end:.6g} deg on; engagement_deg is "
            f"{angles[-1]:.6g}, and a roller that engages over {end:.6g} deg displaces the same"
        )


def _jumps(rises: _Array, total: float) -> list[int]:
    """Return the rises that stand out of those on either side."""
    beside = np.maximum(np.append(0.0, rises[:-1]), np.append(rises[1:], 0.0))
    is_jump = (rises > _JUMP_PART * total) & (rises > _JUMP_TIMES * beside)
    found: list[int] = np.flatnonzero(is_jump).tolist()
    return found


def _outliers(volumes: _Array, total: float) -> list[int]:
    """Return the samples that stand out of their neighbours, to which an outlier does half of the same."""
    off = np.zeros_like(volumes)
    off[1:-1] = volumes[1:-1] - 0.5 * (volumes[:-2] + volumes[2:])
    padded = np.pad(off, 2)
    before, after = padded[1:-3], padded[3:-1]
    beyond = np.maximum(abs(padded[:-4]), abs(padded[4:]))
    # An outlier of e puts both neighbours off by -e/2; beside a jump one of them is off by as much as itself.
    least = 0.2 * abs(off)
    is_half = (abs(before + 0.5 * off) < least) & (abs(after + 0.5 * off) < least)
    is_outlier = is_half & (abs(off) > _OUTLIER_PART * total) & (abs(off) > _OUTLIER_TIMES * beyond)
    found: list[int] = np.flatnonzero(is_outlier).tolist()
    return found
