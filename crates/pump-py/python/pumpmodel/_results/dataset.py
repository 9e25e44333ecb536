"""A dataset of a run that knows the former names of its variables. Needs xarray."""

from __future__ import annotations

from typing import Any

import xarray as xr

from pumpmodel._results.renamed import COLUMNS, column


class RunDataset(xr.Dataset):  # type: ignore[no-untyped-call]
    """A dataset whose variables can be read by their former names, with a warning."""

    __slots__ = ()

    def __getitem__(self, key: Any) -> Any:
        """Return variables, or a part of the dataset."""
        return super().__getitem__(column(key, self.variables))

    def __getattr__(self, name: str) -> Any:
        """Return the variable of a former name."""
        if name in COLUMNS:
            return super().__getattr__(column(name, self.variables))
        return super().__getattr__(name)

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Pickle as a plain Dataset, which needs no `pumpmodel` to be read."""
        return xr.Dataset, (), super().__reduce_ex__(max(2, protocol))[2]
