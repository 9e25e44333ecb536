"""Former names, which still work and warn."""

import warnings
from typing import Any

# Former names of columns, and their names.
COLUMNS = {
    "q_in_ml_s": "inlet_flow_ml_s",
    "q_out_ml_s": "outlet_flow_ml_s",
    "p_in_kpa": "inlet_kpa",
    "p_out_kpa": "outlet_kpa",
}


def renamed(former: str, now: str, depth: int = 2) -> None:
    """Warn of a former name. The warning names the code `depth` calls above this function."""
    warnings.warn(f"{former} is deprecated; use {now}", DeprecationWarning, stacklevel=depth + 1)


def column(name: Any, names: Any, depth: int = 3) -> Any:
    """Return the name of a column that may be asked for by its former name, which warns."""
    if isinstance(name, list):
        return [column(each, names, depth + 2) for each in name]
    if isinstance(name, str) and name in COLUMNS and name not in names:
        renamed(f"the column {name}", COLUMNS[name], depth)
        return COLUMNS[name]
    return name


class Columns(dict[str, Any]):
    """Columns by their names. A former name returns its column, with a warning."""

    def __missing__(self, name: str) -> Any:
        """Return the column of a former name."""
        if name in COLUMNS and COLUMNS[name] in self:
            renamed(f"the column {name}", COLUMNS[name])
            return self[COLUMNS[name]]
        raise KeyError(name)

    def get(self, name: str, default: Any = None) -> Any:
        """Return a column, also by its former name."""
        if name in self or COLUMNS.get(name) not in self:
            return super().get(name, default)
        renamed(f"the column {name}", COLUMNS[name])
        return self[COLUMNS[name]]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as a plain dict, which needs no `pumpmodel` to be read."""
        return dict, (dict(self),)
