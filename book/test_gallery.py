"""The gallery as notebooks: cells of scripts, an error that ends the run, pages with their output."""

import asyncio
from pathlib import Path
from typing import Any

import pytest
from gallery import page_of, pages_of
from nbclient.exceptions import CellExecutionError
from notebooks import cells_of, execute, notebook_of

SCRIPT = (
    '"""A title.\n\nMore.\n"""\n\n# %%\nimport sys\n\n# %% [markdown]\n# One `line`.\n# Another.\n\n# %%\nprint(1)\n'
)


def executed(script: str, site: Path) -> Any:
    notebook = notebook_of(script)
    asyncio.run(execute(notebook, str(site)))
    return notebook


def test_cells_are_those_of_the_script_and_its_docstring_is_text() -> None:
    assert cells_of(SCRIPT) == [
        ("markdown", "A title.\n\nMore."),
        ("code", "import sys"),
        ("markdown", "One `line`.\nAnother."),
        ("code", "print(1)"),
    ]
    with pytest.raises(SystemExit, match=r"`# %% \[raw\]`"):
        cells_of('"""A."""\n# %% [raw]\n')


def test_a_cell_that_fails_fails_the_run(tmp_path: Path) -> None:
    # Stands for matplotlib, which this environment lacks.
    (tmp_path / "matplotlib.py").touch()
    told = "import sys\nprint(sys.argv[1:])\n"
    done = executed(f'"""A."""\n# %%\n{told}', tmp_path)
    assert [cell.cell_type for cell in done.cells] == ["markdown", "code"]
    with pytest.raises(CellExecutionError, match="division by zero"):
        executed('"""A."""\n# %%\n1 / 0\n', tmp_path)


def test_a_page_has_text_code_output_and_pictures_of_their_size() -> None:
    picture = {"output_type": "display_data", "data": {"image/png": "aGk=\n"}, "metadata": {"image/png": {"width": 7}}}
    notebook = {
        "cells": [
            {"cell_type": "markdown", "source": ["A title.\n", "More."]},
            {"cell_type": "code", "source": "f()", "outputs": [{"output_type": "stream", "text": "1\n"}, picture]},
        ]
    }
    title, text = page_of(notebook, "dose_error")
    assert title == "Dose error"
    assert "A title.\nMore.\n\n```python\nf()\n```\n\n```text\n1\n```\n" in text
    assert '<img alt="Dose error" width="7" src="data:image/png;base64,aGk=">' in text
    assert "(gallery/dose_error.ipynb)" in text
    picture["data"] = {"text/html": "<div>a <b>table</b></div>", "text/plain": "a table"}
    assert "\n<div>a <b>table</b></div>\n" in page_of(notebook, "dose_error")[1]
    picture["data"] = {"text/html": "<div><script></script></div>", "text/plain": "a page"}
    assert "```text\na page\n```" in page_of(notebook, "dose_error")[1]
    picture["data"] = {}
    with pytest.raises(SystemExit, match="allowed: text and pictures"):
        page_of(notebook, "dose_error")


def test_without_notebooks_the_guide_says_how_to_make_them(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="has no notebooks; `make docs` executes them"):
        pages_of(tmp_path)
