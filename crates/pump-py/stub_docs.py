"""Docstrings of the compiled module in its stubs, for editors: `python stub_docs.py` writes them anew."""

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pumpmodel import _pumpmodel

FOLDER = Path(__file__).parent / "python/pumpmodel/_pumpmodel"

# Columns of a line, as everywhere in the repository.
_COLUMNS = 120

Node = ast.ClassDef | ast.FunctionDef


def documented(tree: ast.Module) -> Iterator[tuple[Node, str]]:
    """Yield every class and function of a stub that has a docstring in the compiled module, with that."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and hasattr(_pumpmodel, node.name):
            yield from _of(node, getattr(_pumpmodel, node.name))


def _of(node: Node, thing: Any) -> Iterator[tuple[Node, str]]:
    if thing.__doc__:
        yield node, inspect.cleandoc(thing.__doc__)
    if not isinstance(node, ast.ClassDef):
        return
    seen = set()
    for member in node.body:
        # An overload has the docstring once.
        if isinstance(member, ast.FunctionDef) and member.name[:2] != "__" and member.name not in seen:
            seen.add(member.name)
            yield from _of(member, getattr(thing, member.name))


def written(text: str) -> str:
    """Return the text of a stub with the docstrings of the compiled module."""
    lines = text.splitlines()
    for node, doc in sorted(documented(ast.parse(text)), key=lambda found: -found[0].lineno):
        indent = " " * (node.col_offset + 4)
        if len(indent) + len(doc.split("\n")[0]) + 2 * len('"""') > _COLUMNS:
            # The first line begins below its quotes.
            doc = "\0" + doc
        quoted = doc.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
        closing = "" if "\n" not in doc and doc[0] != "\0" else f"\n{indent}"
        quoted = quoted.replace("\0", "\\\n")
        body = "\n".join(f"{indent}{line}".rstrip() for line in f'"""{quoted}'.split("\n")) + f'{closing}"""'
        first = node.body[0]
        if ast.get_docstring(node) is not None:
            del lines[first.lineno - 1 : first.end_lineno]
            lines.insert(first.lineno - 1, body)
        elif isinstance(node, ast.FunctionDef):
            # The dots end the line of the signature.
            assert first.end_lineno is not None
            lines[first.end_lineno - 1] = lines[first.end_lineno - 1].removesuffix(" ...")
            lines.insert(first.end_lineno, body)
        else:
            lines.insert(first.lineno - 1 - len(getattr(first, "decorator_list", [])), body + "\n")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for stub in sorted(FOLDER.glob("*.pyi")):
        stub.write_text(written(stub.read_text(encoding="utf-8")), encoding="utf-8")
