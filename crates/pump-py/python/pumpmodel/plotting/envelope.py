"""Long curves as their envelope: the extremes of each column of pixels."""

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]

# More columns than a picture of a page's width has pixels, at twice the density of a screen. A curve of more
# than 20,000 samples, four a column, is drawn as its envelope.
COLUMNS = 5_000


def envelope(x: _Array, y: _Array, columns: int = COLUMNS) -> tuple[_Array, _Array]:
    """Return the samples of a curve from which it looks the same in `columns` columns of pixels.

    Each column keeps its first, smallest, largest and last sample, in their order (the M4 aggregation of
    Jugel et al., VLDB 2014). A line through them paints the pixels that a line through all samples paints.

    Parameters
    ----------
    x : numpy.ndarray
        Places of the samples, rising, shape (n,).
    y : numpy.ndarray
        Values, shape (n,).
    columns : int
        Number of columns of equal width.

    Returns
    -------
    tuple of numpy.ndarray
        Places and values of the samples that are kept: all of them where n is at most four times the columns.
    """
    if len(x) <= 4 * columns:
        return x, y
    edges = np.searchsorted(x, np.linspace(x[0], x[-1], columns + 1)[1:-1])
    starts = np.unique(np.concatenate(([0], edges)))
    starts = starts[starts < len(x)]
    ends = np.append(starts[1:], len(x))
    kept = [starts, ends - 1]
    for furthest in (np.argmin, np.argmax):
        kept.append(
            np.array([start + furthest(y[start:end]) for start, end in zip(starts, ends, strict=True)])
        )
    chosen = np.unique(np.concatenate(kept))
    return x[chosen], y[chosen]
