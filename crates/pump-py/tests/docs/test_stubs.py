"""Docstrings of the stubs, which editors show."""

import ast
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))
import stub_docs


@pytest.mark.parametrize("stub", sorted(stub_docs.FOLDER.glob("*.pyi")), ids=lambda stub: stub.stem)
def test_docstrings_of_the_stubs_are_those_of_the_compiled_module(stub: Path) -> None:
    tree = ast.parse(stub.read_text(encoding="utf-8"))
    wrong = [
        node.name
        for node, doc in stub_docs.documented(tree)
        if (ast.get_docstring(node) or "").rstrip() != doc
    ]
    assert wrong == [], "run `python stub_docs.py`"


def test_every_public_class_of_the_compiled_module_has_its_docstring_in_a_stub() -> None:
    found = {
        node.name: doc
        for stub in stub_docs.FOLDER.glob("*.pyi")
        for node, doc in stub_docs.documented(ast.parse(stub.read_text(encoding="utf-8")))
    }
    assert {"Balance", "Pump", "Doser", "Plan", "Run", "Line", "plan", "steps", "rmse"} <= set(found)
