"""A bench: one pump, its driver, and its record."""

from pumpmodel.bench.asynchronous import AsyncBench
from pumpmodel.bench.bench import Bench
from pumpmodel.bench.planning import Progress

__all__ = ["AsyncBench", "Bench", "Progress"]
