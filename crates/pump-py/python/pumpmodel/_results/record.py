"""Reports of the compiled half as immutable objects, read from JSON."""

import json
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, ClassVar, Self


def plain(value: Any) -> Any:
    """Convert to numbers, texts, lists and dicts only."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, tuple):
        return [plain(item) for item in value]
    return value


@dataclass(frozen=True)
class Record:
    """Base of reports, whose fields have the names of the command's JSON."""

    # Types of the fields that are records, or tuples of records.
    _records: ClassVar[dict[str, "type[Record]"]] = {}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Return the record of the data that `to_dict` gave.

        Parameters
        ----------
        data : dict
            Data that `to_dict` returned.

        Raises
        ------
        TypeError
            If a key is missing or unknown.
        """
        return cls(**{name: _value(cls._records.get(name), value) for name, value in data.items()})

    @classmethod
    def _from_json(cls, text: str) -> Self:
        return cls.from_dict(json.loads(text))

    def to_dict(self) -> dict[str, Any]:
        """Return the record as plain data.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only, as in the command's JSON.
        """
        data: dict[str, Any] = plain(self)
        return data


def _value(record: type[Record] | None, value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_value(record, item) for item in value)
    if record is not None and isinstance(value, dict):
        return record.from_dict(value)
    return value
