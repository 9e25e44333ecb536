"""A table of a run that knows the former names of its columns. Needs pandas."""

from __future__ import annotations

from typing import Any

import pandas as pd

from pumpmodel._results.renamed import COLUMNS, column


class RunFrame(pd.DataFrame):
    """A table whose columns can be read by their former names, with a warning."""

    @property
    def _constructor(self) -> type[RunFrame]:
        return RunFrame

    def __getitem__(self, key: Any) -> Any:
        """Return columns or rows."""
        return super().__getitem__(column(key, self.columns))

    # Final in the types of pandas alone.
    def __getattr__(self, name: str) -> Any:  # type: ignore[misc]
        """Return the column of a former name."""
        if name in COLUMNS:
            return super().__getattr__(column(name, self.columns))
        return super().__getattr__(name)

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Pickle as a plain DataFrame, which needs no `pumpmodel` to be read."""
        return pd.DataFrame, (), super().__reduce_ex__(max(2, protocol))[2]
