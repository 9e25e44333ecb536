"""PyLabRobot's own pumps, which version 1.0 keeps in a legacy module."""

from importlib.util import find_spec
from typing import Any

from pumpmodel._results.optional import optional

optional("pylabrobot", "pylabrobot")
_place = "pylabrobot.legacy.pumps" if find_spec("pylabrobot.legacy") else "pylabrobot.pumps"
_backends = optional(f"{_place}.backend", "pylabrobot")

# PyLabRobot has no types: type checkers treat these bases as Any.
Pump: Any = optional(f"{_place}.pump", "pylabrobot").Pump
PumpArray: Any = optional(f"{_place}.pumparray", "pylabrobot").PumpArray
PumpBackend: Any = _backends.PumpBackend
PumpArrayBackend: Any = _backends.PumpArrayBackend
