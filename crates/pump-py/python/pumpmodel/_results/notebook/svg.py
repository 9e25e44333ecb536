"""Small pictures for notebooks: SVG of a few kilobytes, without matplotlib."""

from collections.abc import Sequence
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pumpmodel._results.words import number
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION
from pumpmodel.plotting.envelope import envelope

_WIDTH, _HEIGHT = 320, 120
_LEFT, _RIGHT, _TOP, _BOTTOM = 48, 8, 18, 20
# Columns of pixels of a curve, of which each keeps four points.
_COLUMNS = _WIDTH - _LEFT - _RIGHT

__all__ = ["BLUE", "GREEN", "VERMILION", "Bar", "Curve", "bars", "curves"]


class Curve(NamedTuple):
    """A curve, or dots: name, colour and values."""

    name: str
    colour: str
    x: ArrayLike
    y: ArrayLike
    dots: bool = False


class Bar(NamedTuple):
    """A bar: name, length and the text at its end."""

    name: str
    length: float
    text: str


def _picture(title: str, height: float, parts: list[str]) -> str:
    # The text has the colour of the page, so it can be read on a light and on a dark one.
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{escape(title)}" '
        f'viewBox="0 0 {_WIDTH} {height:g}" width="{_WIDTH}" height="{height:g}" '
        'style="font:10px sans-serif;fill:currentColor">' + "".join(parts) + "</svg>"
    )


def _text(x: float, y: float, words: str, *, anchor: str = "start", fill: str = "") -> str:
    colour = f' fill="{fill}"' if fill else ""
    return f'<text x="{x:.4g}" y="{y:.4g}" text-anchor="{anchor}"{colour}>{escape(words)}</text>'


def curves(x_label: str, y_label: str, drawn: Sequence[Curve]) -> str:
    """Return a picture of curves over a common axis; an empty text if no value is finite.

    Parameters
    ----------
    x_label, y_label : str
        Names with units of the axes.
    drawn : sequence of Curve
        Curves of one or more values each.
    """
    finite = []
    for curve in drawn:
        x, y = (
            np.ravel(np.asarray(curve.x, dtype=np.float64)),
            np.ravel(np.asarray(curve.y, dtype=np.float64)),
        )
        kept = np.isfinite(x) & np.isfinite(y)
        if kept.any():
            finite.append((curve, *envelope(x[kept], y[kept], _COLUMNS)))
    if not finite:
        return ""
    x_least, x_most = min(x.min() for _, x, _ in finite), max(x.max() for _, x, _ in finite)
    y_least, y_most = min(y.min() for *_, y in finite), max(y.max() for *_, y in finite)
    x_span, y_span = (x_most - x_least) or 1.0, (y_most - y_least) or 1.0
    wide, high = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    base = _HEIGHT - _BOTTOM
    parts = [
        f'<path d="M{_LEFT} {_TOP}V{base}H{_WIDTH - _RIGHT}" fill="none" stroke="currentColor" opacity=".4"/>'
    ]
    for curve, x, y in finite:
        places = zip(
            (_LEFT + wide * (x - x_least) / x_span).tolist(),
            (base - high * (y - y_least) / y_span).tolist(),
            strict=True,
        )
        if curve.dots or len(x) == 1:
            parts += [
                f'<circle cx="{px:.1f}" cy="{py:.1f}" r="2" fill="{curve.colour}"/>' for px, py in places
            ]
        else:
            # A long curve needs no parts of its columns, and is half as many bytes without them.
            decimals = 0 if len(x) > _COLUMNS else 1
            path = " ".join(f"{px:.{decimals}f},{py:.1f}" for px, py in places)
            style = f'fill="none" stroke="{curve.colour}" stroke-width="1.3" opacity=".85"'
            parts.append(f'<polyline points="{path}" {style}/>')
    parts += [
        _text(_LEFT - 4, _TOP + 6, number(float(y_most)), anchor="end"),
        _text(_LEFT - 4, base, number(float(y_least)), anchor="end"),
        _text(_LEFT, _HEIGHT - 6, number(float(x_least))),
        _text(_WIDTH - _RIGHT, _HEIGHT - 6, number(float(x_most)), anchor="end"),
        _text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 6, x_label, anchor="middle"),
        _text(4, 10, y_label),
    ]
    # Names stand from right to left above the curves.
    at = float(_WIDTH - _RIGHT)
    for curve, _, _ in reversed(finite):
        parts.append(_text(at, 10, curve.name, anchor="end", fill=curve.colour))
        at -= (8 + 6 * len(curve.name)) if curve.name else 0
    return _picture(f"{y_label} over {x_label}", _HEIGHT, parts)


def bars(title: str, drawn: Sequence[Bar]) -> str:
    """Return a picture of bars, one below the other; an empty text if none has a length."""
    most = max((bar.length for bar in drawn), default=0.0)
    if not most > 0:
        return ""
    row, left = 14, 110
    parts = []
    for place, bar in enumerate(drawn):
        y = 4 + row * place
        length = (_WIDTH - left - 80) * bar.length / most
        parts += [
            _text(left - 6, y + 9, bar.name, anchor="end"),
            f'<rect x="{left}" y="{y}" width="{length:.1f}" height="10" fill="{GREEN}"/>',
            _text(left + length + 4, y + 9, bar.text),
        ]
    return _picture(title, 8 + row * len(drawn), parts)
