"""A pump head that turns: rollers, squeezed tube and pressures over time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pumpmodel._pumpmodel import Plan, Pump, Run, _number
from pumpmodel._results.optional import optional
from pumpmodel.plotting.axes import BLUE, VERMILION, finish, ink
from pumpmodel.plotting.envelope import envelope
from pumpmodel.plotting.section import draw_head

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from numpy.typing import NDArray

# Frames beyond which a notebook or a GIF has no use of the animation: more than a minute of them.
_MOST_FRAMES = 2000


def animate(
    pump: Pump, result: Run | Plan, *, slower: float = 1.0, frames_per_s: float = 25.0
) -> FuncAnimation:
    """Animate the head over a run or a plan: rollers and tube turn, pressures and delivered volume grow.

    In a notebook `IPython.display.HTML(animation.to_jshtml())` shows it with buttons, and
    `animation.save("head.gif")` makes a GIF by pillow, which matplotlib brings.

    Parameters
    ----------
    pump : Pump
        Pump whose head is drawn.
    result : Run or Plan
        Run of this pump, or a plan, of which the predicted trace is shown until the line has settled.
    slower : float
        Time of the animation over that of the run: 1 is real time, 5 five times slower.
    frames_per_s : float
        Frames per second of the animation.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        Animation. It draws as long as it is referred to, so keep it in a variable.

    Raises
    ------
    ValueError
        If `slower` or `frames_per_s` is not positive, the run has fewer than 2 samples, or there would be
        more than 2,000 frames.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    if not isinstance(pump, Pump):
        message = f"pump must be a Pump, not {type(pump).__name__}"
        raise TypeError(message)
    if not isinstance(result, Run | Plan):
        message = f"a Run or a Plan can be animated, not {type(result).__name__}"
        raise TypeError(message)
    slower = _number("slower", slower, "times the run")
    frames_per_s = _number("frames_per_s", frames_per_s, "1/s")
    for name, value in (("slower", slower), ("frames_per_s", frames_per_s)):
        if not (value > 0 and math.isfinite(value)):
            message = f"{name} is {value:g}; allowed: a finite number above 0"
            raise ValueError(message)
    begin_s, end_s = (0.0, result.settled_s) if isinstance(result, Plan) else _span(result)
    frames = (end_s - begin_s) * slower * frames_per_s
    count = math.ceil(min(frames, 1e15)) + 1
    if count > _MOST_FRAMES:
        told = f"{count:,}" if frames < 1e9 else f"{frames:.3g}"
        message = (
            f"the animation has {told} frames; allowed: at most {_MOST_FRAMES:,}; give a shorter run, "
            "a smaller slower or fewer frames_per_s"
        )
        raise ValueError(message)
    # A plan that takes no longer than 2,000 frames is short, but for frames that are seconds apart.
    run = result if isinstance(result, Run) else result.trace(dt_s=max(1e-3, end_s / 1e6))
    return _animation(pump, run, np.linspace(begin_s, end_s, count), 1000 / frames_per_s)


def _span(run: Run) -> tuple[float, float]:
    if len(run) < 2:
        message = f"the run has {len(run)} samples; allowed: 2 at least"
        raise ValueError(message)
    return float(run.time_s[0]), float(run.time_s[-1])


def _animation(pump: Pump, run: Run, times_s: NDArray[np.float64], interval_ms: float) -> FuncAnimation:
    pyplot = optional("matplotlib.pyplot", "plot")
    animation = optional("matplotlib.animation", "plot")
    figure, axes = pyplot.subplot_mosaic(
        [["head", "pressure"], ["head", "delivered"]], figsize=(9.0, 4.6), layout="constrained"
    )
    growing: list[tuple[Any, Any, Any, Any]] = []
    for name, columns, label in (
        (
            "pressure",
            (("inlet", "inlet_kpa", BLUE), ("outlet", "outlet_kpa", VERMILION)),
            "pressure\n(kPa absolute)",
        ),
        ("delivered", (("vessel", "delivered_ml", VERMILION),), "delivered\n(mL)"),
    ):
        axis = axes[name]
        for port, column, colour in columns:
            x, y = envelope(run.time_s, getattr(run, column))
            axis.plot(x, y, color=colour, linewidth=1, alpha=0.3)
            (line,) = axis.plot([], [], color=colour, linewidth=1.4, label=port)
            (dot,) = axis.plot([], [], "o", color=colour, markersize=4)
            growing.append((line, dot, x, y))
        axis.set_ylabel(label)
        finish(axis, legend=name == "pressure")
    axes["delivered"].set_xlabel("time (s)")
    axes["pressure"].tick_params(labelbottom=False)

    def draw(frame: int) -> list[Any]:
        time_s = times_s[frame]
        head = axes["head"]
        head.clear()
        draw_head(head, pump, float(np.interp(time_s, run.time_s, run.angle_rad)))
        head.set_axis_off()
        delivered_ml = np.interp(time_s, run.time_s, run.delivered_ml)
        head.set_title(f"{time_s:.2f} s, {delivered_ml:.2f} mL", fontsize="medium", color=ink(head))
        for line, dot, x, y in growing:
            until = int(np.searchsorted(x, time_s, side="right"))
            now = np.interp(time_s, x, y)
            line.set_data(np.append(x[:until], time_s), np.append(y[:until], now))
            dot.set_data([time_s], [now])
        return [part for line, dot, _, _ in growing for part in (line, dot)]

    draw(0)
    # The layout stands still while the head turns.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    made: FuncAnimation = animation.FuncAnimation(
        figure, draw, frames=len(times_s), interval=interval_ms, cache_frame_data=False
    )
    return made
