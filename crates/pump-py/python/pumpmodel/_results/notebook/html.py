"""Results as notebooks show them: a table of the main numbers, and a small picture."""

from collections.abc import Iterable
from html import escape
from itertools import islice

# A notebook need not hold more warnings than people read.
_NOTES = 10


def table(title: str, rows: Iterable[tuple[str, str]], picture: str = "", notes: Iterable[str] = ()) -> str:
    """Return a table with a title, and below it a picture and notes.

    Parameters
    ----------
    title : str
        Title, as plain text.
    rows : iterable of tuple
        Name and value of each row, as plain text.
    picture : str
        Picture as SVG; an empty text for none.
    notes : iterable of str
        Notes, as plain text, such as warnings.
    """
    left = 'style="text-align:left"'
    cells = "".join(
        f"<tr><th {left}>{escape(name)}</th><td {left}>{escape(_short(value))}</td></tr>"
        for name, value in rows
    )
    told = "".join(f"<p>{escape(_short(note))}</p>" for note in islice(notes, _NOTES))
    return f"<div><strong>{escape(_short(title))}</strong><table>{cells}</table>{picture}{told}</div>"


def _short(text: str) -> str:
    """Cut a text that a user's file may have made long."""
    return text if len(text) <= 300 else f"{text[:299]}…"
