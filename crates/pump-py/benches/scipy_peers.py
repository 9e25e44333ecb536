"""The exact solution against SciPy's solvers, on the benchmark case, in one run.

Three rollers at 100 r/min from rest, both pressures every millisecond for 10 s. SciPy is used as well as it
can be: both ports as one system, stopped at the edges of the flow, with the flow's own polynomial between
them, the exact Jacobian, and the loosest tolerance that reaches the goal.

Then the likelihood of R, C and L for 1,000 samples of a port, by the best of these solvers in the same way,
and the derivatives of all pressures by five parameters.
"""

import argparse
import itertools
import math
import statistics
import time
from collections.abc import Callable
from functools import partial

import augmented
import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import pumpmodel as pm

SPEED_RAD_S = 100 * math.tau / 60
SAMPLES = 10_000
DT_S = 1e-3
END_S = SAMPLES * DT_S
SHORTEST_S = 1e-9
GOAL_KPA = 1e-6
TARGET = 500
LIKELIHOOD_SAMPLES = 1_000
LIKELIHOOD_TARGET_US = 100
NOISE_KPA = 0.3
PORTS: tuple[pm.choices.Port, ...] = ("inlet", "outlet")
METHODS = ("BDF", "Radau", "LSODA", "DOP853", "RK45")

Array = NDArray[np.float64]
# Start and end, s, and the flow of inlet and outlet over time since the start, highest order first.
Segment = tuple[float, float, list[float], list[float]]


def quartic(curve: Callable[[Array], Array], start: float, end: float) -> Polynomial:
    """Quartic through five points of the curve, none of them on an edge."""
    x = 0.5 * (start + end) + 0.5 * (end - start) * np.cos(np.pi * (np.arange(5) + 0.5) / 5)
    return Polynomial.fit(x, curve(x), 4, domain=[start, end])


def edges(curve: Callable[[Array], Array], pitch: float) -> list[float]:
    """Angles at which the curve changes its polynomial, found by bisection."""

    def one_piece(start: float, end: float) -> bool:
        x = np.linspace(start, end, 60)[1:]
        return bool(np.all(np.abs(quartic(curve, start, end)(x) - curve(x)) < 1e-9))

    found = [0.0]
    almost = pitch * (1 - 1e-12)
    while not one_piece(found[-1], almost):
        # A piece is at least 1e-3 of the pitch long.
        low = high = found[-1] + 1e-3 * pitch
        while one_piece(found[-1], min(high, almost)):
            low, high = high, high + 0.02 * pitch
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if one_piece(found[-1], middle) else (low, middle)
        found.append(high)
    return found


def segments(pump: pm.Pump) -> list[Segment]:
    pitch = pump.pitch_rad
    curves = (pump.inlet_flow_ml_rad, pump.outlet_flow_ml_rad)
    angles = sorted({angle for curve in curves for angle in edges(curve, pitch)} | {pitch})
    pieces: list[Segment] = []
    for start, end in itertools.pairwise(angles):
        shift = Polynomial([start, SPEED_RAD_S])
        flows = [
            list(map(float, (SPEED_RAD_S * quartic(curve, start, end))(shift).coef[::-1])) for curve in curves
        ]
        pieces.append((start / SPEED_RAD_S, end / SPEED_RAD_S, flows[0], flows[1]))
    period_s = pitch / SPEED_RAD_S
    pitches = round(END_S / period_s)
    return [
        (n * period_s + start, n * period_s + end, inlet, outlet)
        for n in range(pitches)
        for start, end, inlet, outlet in pieces
    ]


def constants(line: pm.Line) -> tuple[float, float, float]:
    return line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml


def jacobian(pump: pm.Pump) -> Array:
    """Return the Jacobian of (pressure above the reservoir, flow of the line), inlet first."""
    (ri, ci, li), (ro, co, lo) = constants(pump.inlet), constants(pump.outlet)
    return np.array(
        [
            [0, 1 / ci, 0, 0],
            [-1 / li, -ri / li, 0, 0],
            [0, 0, 0, -1 / co],
            [0, 0, 1 / lo, -ro / lo],
        ]
    )


def slope(pump: pm.Pump, segment: Segment) -> Callable[[float, Array], tuple[float, float, float, float]]:
    """Make the right-hand side inside a segment, in plain floats: four states are too few for arrays."""
    (ri, ci, li), (ro, co, lo) = constants(pump.inlet), constants(pump.outlet)
    start, _, (i4, i3, i2, i1, i0), (o4, o3, o2, o1, o0) = segment

    def evaluate(t: float, y: Array) -> tuple[float, float, float, float]:
        t -= start
        pi, qi, po, qo = y.tolist()
        flow_in = (((i4 * t + i3) * t + i2) * t + i1) * t + i0
        flow_out = (((o4 * t + o3) * t + o2) * t + o1) * t + o0
        return (qi - flow_in) / ci, (-pi - ri * qi) / li, (flow_out - qo) / co, (po - ro * qo) / lo

    return evaluate


def solve(
    pump: pm.Pump, pieces: list[Segment], method: str, tolerance: float, samples: int = SAMPLES
) -> Array:
    """Pressures of inlet and outlet, kPa absolute."""
    options: dict[str, object] = {}
    if method not in ("DOP853", "RK45"):
        matrix = jacobian(pump)
        options = {"jac": (lambda t, y: matrix) if method == "LSODA" else matrix}
    state = np.zeros(4)
    pressures = np.empty((2, samples + 1))
    due = 0
    for segment in pieces:
        start, end, _, _ = segment
        end = min(end, samples * DT_S)
        # An end that stands on an edge leaves a piece of rounding, which LSODA refuses.
        if end - start < SHORTEST_S:
            break
        # A sample on an edge is the first of the next segment; the last edge is the last sample.
        last = math.ceil(end / DT_S - 1e-9) - 1
        times = np.append(np.maximum(np.arange(due, last + 1) * DT_S, start), end)
        run = solve_ivp(
            slope(pump, segment),
            (start, end),
            state,
            method,
            t_eval=times,
            rtol=tolerance,
            atol=tolerance,
            **options,
        )
        if not run.success:
            raise ArithmeticError(run.message)
        pressures[:, due : last + 1] = run.y[::2, :-1]
        state = run.y[:, -1]
        due = last + 1
    pressures[:, due] = state[::2]
    return np.add(pressures, [[pump.inlet.reservoir_kpa], [pump.outlet.reservoir_kpa]])


def seconds(run: Callable[[], object], repetitions: int) -> float:
    start = time.perf_counter()
    for _ in range(repetitions):
        run()
    return (time.perf_counter() - start) / repetitions


def likelihoods(pump: pm.Pump, pieces: list[Segment], method: str, tolerance: float, rounds: int) -> None:
    """Print the time of a likelihood of 1,000 samples of one port, beside that of SciPy's best solver."""
    run = pump.simulate(speed_rad_s=SPEED_RAD_S, duration_s=(LIKELIHOOD_SAMPLES - 1) * DT_S, dt_s=DT_S)
    noise = np.random.default_rng(1).normal(0, NOISE_KPA, (2, LIKELIHOOD_SAMPLES))
    measured = np.stack([run.inlet_kpa, run.outlet_kpa]) + noise
    both = [
        pm.LineLikelihood(
            pump,
            time_s=run.time_s,
            pressure_kpa=pressure_kpa,
            standard_kpa=NOISE_KPA,
            port=port,
            speed_rad_s=SPEED_RAD_S,
            begin="step",
        )
        for port, pressure_kpa in zip(PORTS, measured, strict=True)
    ]
    line = pump.outlet.replace(compliance_ml_kpa=0.03, inertance_kpa_s2_ml=0.005)
    other = pump.replace(inlet=line, outlet=line)
    resistance, compliance, inertance = constants(line)

    def ours() -> float:
        return sum(
            port.log_likelihood(
                resistance_kpa_s_ml=resistance, compliance_ml_kpa=compliance, inertance_kpa_s2_ml=inertance
            )
            for port in both
        )

    def peer() -> float:
        residual = measured - solve(other, pieces, method, tolerance, LIKELIHOOD_SAMPLES)[:, :-1]
        constant = measured.size * math.log(math.tau * NOISE_KPA**2)
        return float(-0.5 * (np.sum((residual / NOISE_KPA) ** 2) + constant))

    difference = abs(ours() - peer())
    times = [(seconds(ours, 500), seconds(peer, 3)) for _ in range(rounds)]
    # Both ports in one call, so half of it is one likelihood.
    ours_us, peer_us = (1e6 * statistics.median(column) / 2 for column in zip(*times, strict=True))
    met = "met" if ours_us <= LIKELIHOOD_TARGET_US else "missed"
    print("\n| likelihood of 1,000 samples of a port | µs | / exact |\n| --- | --- | --- |")
    print(f"| pumpmodel, LineLikelihood | {ours_us:.1f} | 1 |")
    print(f"| SciPy {method} | {peer_us:.0f} | {peer_us / ours_us:.0f} |")
    print(f"\nThe two differ by {difference:.1e}. Target: at most {LIKELIHOOD_TARGET_US} µs; {met}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    rounds = parser.parse_args().rounds
    pump = pm.Pump.three_roller()
    pieces = segments(pump)
    ours = partial(pump.simulate, speed_rad_s=SPEED_RAD_S, duration_s=END_S, dt_s=DT_S, method="exact")
    run = ours()
    exact = np.stack([run.inlet_kpa, run.outlet_kpa])

    print("| what | tolerance | error, kPa | ms | / exact |\n| --- | --- | --- | --- | --- |")
    runs: dict[str, Callable[[], object]] = {}
    tolerances: dict[str, float] = {}
    notes: dict[str, str] = {}
    for method in METHODS:
        for halves in range(10, 28):
            tolerance = 10 ** (-halves / 2)
            error = np.abs(solve(pump, pieces, method, tolerance) - exact).max()
            if error <= GOAL_KPA:
                runs[method] = partial(solve, pump, pieces, method, tolerance)
                tolerances[method] = tolerance
                notes[method] = f"{tolerance:.1e} | {error:.1e}"
                break
        else:
            print(f"| SciPy {method} | | never {GOAL_KPA:.0e} | | |")
    # By turns, so that what slows the machine slows both.
    exact_s: list[float] = []
    times: dict[str, list[float]] = {method: [] for method in runs}
    for _ in range(rounds):
        for method, peer in runs.items():
            exact_s.append(seconds(ours, 200))
            times[method].append(seconds(peer, 1))
    base = statistics.median(exact_s)
    print(f"| pumpmodel, exact, with flows and volume | | | {1e3 * base:.3f} | 1 |")
    ratios = {method: statistics.median(times[method]) / base for method in runs}
    for method, ratio in ratios.items():
        print(f"| SciPy {method} | {notes[method]} | {1e3 * ratio * base:.1f} | {ratio:.0f} |")
    best = min(ratios, key=lambda method: ratios[method])
    met = "met" if ratios[best] >= TARGET else "missed"
    print(f"\nSciPy's best, {best} / exact: {ratios[best]:.0f} (target: at least {TARGET}; {met})")
    likelihoods(pump, pieces, best, tolerances[best], rounds)
    augmented.compare(pump, pieces, SPEED_RAD_S, SAMPLES, DT_S, rounds, seconds)


if __name__ == "__main__":
    main()
