"""Derivatives of both pressures by five parameters, by three methods in one run.

The exact solution with its derivatives stands beside central differences of that solution and beside SciPy
on the system augmented by the sensitivity equations.
"""

import math
import statistics
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import pumpmodel as pm

Array = NDArray[np.float64]
# Start and end, s, and the flow of inlet and outlet over time since the start, highest order first.
Segment = tuple[float, float, list[float], list[float]]

PARAMETERS = 5
TARGET_MS = 0.3
# An end that stands on an edge leaves a piece of rounding.
SHORTEST_S = 1e-9
SIGNS = (-1.0, 1.0)
# States of a port: pressure and flow, then the derivatives of both by each parameter.
STATES = 2 * (1 + PARAMETERS)


def blocks(line: pm.Line, sign: float) -> tuple[Array, Array]:
    """Return the matrix of a port, and how flow, its derivatives by angle and by roller volume act."""
    r, c, inertance = line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml
    matrix = np.array([[0, -sign / c], [sign / inertance, -r / inertance]])
    by_line = [
        np.array([[0, 0], [0, -1 / inertance]]),
        np.array([[0, sign / c**2], [0, 0]]),
        np.array([[0, 0], [-sign / inertance**2, r / inertance**2]]),
    ]
    whole = np.kron(np.eye(1 + PARAMETERS), matrix)
    for n, slope in enumerate(by_line):
        whole[2 * n + 2 : 2 * n + 4, :2] = slope
    inputs = np.zeros((STATES, 3))
    inputs[0, 0] = inputs[8, 1] = inputs[10, 2] = sign / c
    inputs[4, 0] = -sign / c**2
    return whole, inputs


def solve(
    pump: pm.Pump, pieces: list[Segment], speed_rad_s: float, tolerance: float, samples: int, dt_s: float
) -> Array:
    """Return the derivatives of both pressures, shape (2, 5, samples), by DOP853 in every piece."""
    matrix = np.zeros((2 * STATES, 2 * STATES))
    inputs = np.zeros((2 * STATES, 6))
    for n, (line, sign) in enumerate(zip((pump.inlet, pump.outlet), SIGNS, strict=True)):
        place = slice(n * STATES, (n + 1) * STATES)
        matrix[place, place], inputs[place, 3 * n : 3 * n + 3] = blocks(line, sign)
    roller_ml = pump.roller_volume_ml
    bare_ml_s = (pump.volume_per_revolution_ml + pump.rollers * roller_ml) / math.tau * speed_rad_s
    state = np.zeros(2 * STATES)
    found = np.empty((2 * STATES, samples))
    due = 0
    for number, (start, end, *flows) in enumerate(pieces):
        end = min(end, samples * dt_s)
        if end - start < SHORTEST_S:
            break
        if number > 0:
            # Where the flow jumps, the derivative by the angle does.
            for n, flow in enumerate(flows):
                before = pieces[number - 1]
                jump = flow[-1] - np.polyval(before[2 + n], before[1] - before[0])
                state[n * STATES + 8] += inputs[n * STATES + 8, 3 * n + 1] * jump / speed_rad_s
        forcing = []
        for flow in flows:
            bare = [0.0, 0.0, 0.0, 0.0, bare_ml_s]
            slope = np.concatenate([[0.0], np.polyder(flow)]) / speed_rad_s
            forcing += [flow, slope, (np.array(flow) - bare) / roller_ml]
        acting = inputs @ np.array(forcing)

        def rate(t: float, y: Array, acting: Array = acting, start: float = start) -> Array:
            powers = np.array([(t - start) ** n for n in (4, 3, 2, 1, 0)])
            slopes: Array = matrix @ y + acting @ powers
            return slopes

        last = min(math.ceil(end / dt_s - 1e-9), samples) - 1
        times = np.append(np.maximum(np.arange(due, last + 1) * dt_s, start), end)
        run = solve_ivp(rate, (start, end), state, "DOP853", t_eval=times, rtol=tolerance, atol=tolerance)
        if not run.success:
            raise ArithmeticError(run.message)
        found[:, due : last + 1] = run.y[:, :-1]
        state = run.y[:, -1]
        due = last + 1
    return found.reshape(2, 1 + PARAMETERS, 2, samples)[:, 1:, 0]


def pressures(run: pm.Run) -> Array:
    return np.stack([run.inlet_kpa, run.outlet_kpa])


def with_roller_volume(pump: pm.Pump, factor: float) -> pm.Pump:
    tables = pump.to_dict()
    roller = tables["roller_volume"]
    roller["polynomial_ml_deg"] = [factor * c for c in roller["polynomial_ml_deg"]]
    return pm.Pump.from_dict(tables)


def compare(
    pump: pm.Pump,
    pieces: list[Segment],
    speed_rad_s: float,
    samples: int,
    dt_s: float,
    rounds: int,
    seconds: Callable[[Callable[[], object], int], float],
) -> None:
    """Print the time of the derivatives of all pressures by every parameter, by three methods."""
    options = {"speed_rad_s": speed_rad_s, "duration_s": (samples - 1) * dt_s, "dt_s": dt_s}
    line = pump.outlet
    step = 1e-4
    names = ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml")
    sides: list[tuple[tuple[pm.Pump, float], tuple[pm.Pump, float], float]] = []
    for name in names:
        size = getattr(line, name)
        more, less = (line.replace(**{name: size * (1 + change)}) for change in (step, -step))
        both = [pump.replace(inlet=side, outlet=side) for side in (more, less)]
        sides.append(((both[0], 0.0), (both[1], 0.0), 2 * step * size))
    sides.append(((pump, step), (pump, -step), 2 * step))
    rollers = [with_roller_volume(pump, 1 + change) for change in (step, -step)]
    sides.append(((rollers[0], 0.0), (rollers[1], 0.0), 2 * step * pump.roller_volume_ml))

    def plain() -> pm.Run:
        return pump.simulate(**options)

    def ours() -> pm.Sensitivity:
        return pump.simulate(**options, sensitivity=True).sensitivity

    def differences() -> Array:
        def at(side: tuple[pm.Pump, float]) -> Array:
            return pressures(side[0].simulate(**options, start_angle_rad=side[1]))

        return np.stack([(at(more) - at(less)) / width for more, less, width in sides], axis=1)

    def peer() -> Array:
        return solve(pump, pieces, speed_rad_s, 1e-9, samples, dt_s)

    found = ours()
    exact = np.stack([found.inlet_kpa_by, found.outlet_kpa_by])
    # A sample on an edge is on either side of the jump by the angle.
    starts = np.array([start for start, *_ in pieces])
    inside = np.abs(found.time_s[:, None] - starts).min(axis=1) > 1e-9
    scale = np.abs(exact[..., inside]).max(axis=2, keepdims=True)

    def error(other: Array, rows: slice) -> float:
        return float((np.abs(other - exact) / scale)[:, rows][..., inside].max())

    peer_error = error(peer(), slice(None))
    # The start lies on an edge, where a central difference by the angle has no limit.
    by_differences = np.delete(np.abs(differences() - exact) / scale, 3, axis=1)[..., inside].max()
    times = [
        (seconds(plain, 100), seconds(ours, 100), seconds(differences, 20), seconds(peer, 1))
        for _ in range(rounds)
    ]
    plain_ms, ours_ms, differences_ms, peer_ms = (
        1e3 * statistics.median(column) for column in zip(*times, strict=True)
    )
    more_ms = ours_ms - plain_ms
    print(f"\n| {2 * samples:,} pressures by R, C, L, angle and V_r | relative error | ms | / exact |")
    print("| --- | --- | --- | --- |")
    print(f"| pumpmodel, run without derivatives | | {plain_ms:.3f} | {plain_ms / ours_ms:.2f} |")
    print(f"| pumpmodel, run with derivatives, of the volume too | | {ours_ms:.3f} | 1 |")
    ratio = differences_ms / ours_ms
    print(f"| central differences of ten runs | {by_differences:.1e} | {differences_ms:.3f} | {ratio:.1f} |")
    print(f"| SciPy DOP853, augmented system | {peer_error:.1e} | {peer_ms:.0f} | {peer_ms / ours_ms:.0f} |")
    met = "met" if more_ms <= TARGET_MS else "missed"
    print(f"\nThe derivatives add {more_ms:.3f} ms to the run. Target: at most {TARGET_MS} ms; {met}")
