"""Bought heads whose volume of a revolution is published, each with the document of its figures."""

import json
from dataclasses import dataclass
from typing import ClassVar

from pumpmodel import _pumpmodel as core
from pumpmodel._results.record import Record
from pumpmodel.choices import Provenance


@dataclass(frozen=True, kw_only=True)
class HeadSource(Record):
    """Document that the figures of a head are from.

    Parameters
    ----------
    kind : {"maker", "quoted", "program"}
        Kind of the document: the maker's own, one that quotes the maker's figures, or the table of a program.
    document : str
        Title of the maker's document.
    table : str
        Table or page of the document; of a program, its own table.
    quoted_by : str or None
        Page, file or program that quotes the document; None for a document of the maker's that was at hand.
    address : str
        Address of the document, or of the page that quotes it.
    remark : str or None
        Conditions of the figures, and what else bears on them.
    """

    kind: Provenance
    document: str
    table: str
    quoted_by: str | None
    address: str
    remark: str | None


@dataclass(frozen=True, kw_only=True)
class Head(Record):
    """Bought head with one tubing, as published. A value that its document does not state is None.

    Parameters
    ----------
    name : str
        Name in the catalogue: lower-case letters, digits and `-`.
    maker : str
        Maker of the head.
    head : str
        Head, in the maker's words.
    rollers : int or None
        Number of rollers.
    tubing : str
        Tubing, in the document's words.
    bore_mm : float or None
        Diameter of the tube's bore, mm.
    wall_mm : float or None
        Thickness of the tube's wall, mm.
    ml_per_rev : float
        Volume of a revolution, mL: as published, or the published flow divided by its speed.
    least_rpm, most_rpm : float or None
        Smallest and largest speed of the head, r/min.
    published : str
        Figures as the document states them.
    note : str or None
        Remark on the row.
    source : HeadSource
        Document that the figures are from.
    """

    _records: ClassVar[dict[str, type[Record]]] = {"source": HeadSource}

    name: str
    maker: str
    head: str
    rollers: int | None
    tubing: str
    bore_mm: float | None
    wall_mm: float | None
    ml_per_rev: float
    least_rpm: float | None
    most_rpm: float | None
    published: str
    note: str | None
    source: HeadSource


def heads(*words: str) -> tuple[Head, ...]:
    """Return the heads of the catalogue, as `dose pumps list --catalogue` lists them.

    Parameters
    ----------
    *words : str
        Words that all stand in a head's name, maker, head or tubing. Small and capital letters count alike.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> head = pm.heads("masterflex", "16")[0]
    >>> head.ml_per_rev, head.rollers, head.source.kind
    (0.8, None, 'program')
    >>> pump = pm.Pump.from_ml_per_rev("acid", ml_per_rev=head.ml_per_rev, rollers=3)
    """
    return tuple(Head.from_dict(head) for head in json.loads(core._heads(list(words)))["heads"])
