"""Gain of a second thread: equal solves in one thread and in two, in turn, in one run."""

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import pumpmodel as pm

ROUNDS = 5
# Tasks a round; long enough that starting threads costs nothing.
TASKS = 8

PUMP = pm.Pump.three_roller()
DOSER = pm.Doser(PUMP)
SPEEDS_RPM = np.linspace(20, 150, 400)

SOLVES: dict[str, Callable[[int], object]] = {
    "simulate, exact, 200 s": lambda _: PUMP.simulate(speed_rpm=100, duration_s=200),
    "simulate, rodas5p, 50 s": lambda _: PUMP.simulate(speed_rpm=100, duration_s=50, method="rodas5p"),
    "steady_state, 400 speeds": lambda _: PUMP.steady_state(speed_rpm=SPEEDS_RPM),
    "plan within 60 s, 1 L": lambda _: DOSER.plan("1L", within="60s"),
}


def seconds(solve: Callable[[int], object], threads: int) -> float:
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(solve, range(threads)))
        started = time.perf_counter()
        list(pool.map(solve, range(TASKS)))
        return time.perf_counter() - started


def main() -> None:
    print(f"{'':28}{'1 thread':>12}{'2 threads':>12}{'ratio':>8}   ({TASKS} tasks, best of {ROUNDS})")
    for name, solve in SOLVES.items():
        rounds = [(seconds(solve, 1), seconds(solve, 2)) for _ in range(ROUNDS)]
        one, two = (min(times) for times in zip(*rounds, strict=True))
        print(f"{name:28}{one:10.3f} s{two:10.3f} s{one / two:8.2f}")


if __name__ == "__main__":
    main()
