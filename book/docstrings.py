"""Docstrings in the form of NumPy, as Markdown."""

import inspect
import re
import textwrap

_HEADING = re.compile(r"^(\w[\w ]*)\n-{3,}$", re.MULTILINE)
_CODE = re.compile(r"(``.*?``|`[^`]*`)", re.DOTALL)
# Sections whose entries have a name or a type, and below it what it means.
_ENTRIES = ("Parameters", "Returns", "Raises", "Yields", "Warns", "Attributes")


def _prose(text: str) -> str:
    """Return a text with what Markdown takes for HTML escaped, but in code."""
    parts = _CODE.split(text)
    return "".join(part if index % 2 else part.replace("<", "&lt;") for index, part in enumerate(parts))


def _entries(text: str) -> str:
    lines = []
    for entry in re.split(r"\n(?=\S)", text.strip("\n")):
        first, _, rest = entry.partition("\n")
        name, colon, kind = first.partition(" : ")
        told = _prose(" ".join(textwrap.dedent(rest).split()))
        head = f"- `{name}`" + (f", *{_prose(kind)}*" if colon else "")
        lines.append(f"{head}: {told}" if told else head)
    return "\n".join(lines) + "\n"


def _examples(text: str) -> str:
    parts = re.split(r"\n\n(?=\S)", text.strip("\n"))
    return "\n\n".join(f"```python\n{part}\n```" if part.startswith(">>>") else _prose(part) for part in parts) + "\n"


def markdown(docstring: str) -> str:
    """Return a docstring as Markdown."""
    pieces = _HEADING.split(inspect.cleandoc(docstring))
    parts = [_prose(pieces[0]).strip() + "\n"]
    for title, text in zip(pieces[1::2], pieces[2::2], strict=True):
        if title == "Examples":
            body = _examples(text)
        elif title in _ENTRIES:
            body = _entries(text)
        else:
            body = _prose(text)
        parts.append(f"**{title}**\n\n{body}")
    return "\n".join(parts)
