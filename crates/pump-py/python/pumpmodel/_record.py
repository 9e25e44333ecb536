"""What the compiled half reports as JSON, as immutable objects."""

import json
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, ClassVar, Self


def plain(value: Any) -> Any:
    """Numbers, texts, lists and dicts alone."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, tuple):
        return [plain(item) for item in value]
    return value


@dataclass(frozen=True)
class Record:
    """Base of reports: fields as in the command's JSON."""

    # Fields that are records themselves, or tuples of them.
    _records: ClassVar[dict[str, "type[Record]"]] = {}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Build the record of what `to_dict` gave.

        Parameters
        ----------
        data : dict
            What `to_dict` returned.

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
            Numbers, texts, lists and dicts alone, as in the command's JSON.
        """
        data: dict[str, Any] = plain(self)
        return data


def _value(record: type[Record] | None, value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_value(record, item) for item in value)
    if record is not None and isinstance(value, dict):
        return record.from_dict(value)
    return value
