"""The gallery of the Python module as notebooks: `notebooks.py GALLERY SITE TARGET`.

GALLERY has scripts whose cells begin with `# %%`; they are the source. A docstring and a cell `# %% [markdown]` become
text. Each script is executed cell by cell in a kernel of its own, which finds packages in the folder SITE too, and is
written with its output to TARGET as a notebook.
"""

import ast
import asyncio
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from traitlets.config import Config

MARK = "# %%"
# Kernels that work at the same time: one a core of CI.
AT_ONCE = 2


def cells_of(script: str) -> list[tuple[str, str]]:
    """Return kind ("markdown" or "code") and text of each cell of a script."""
    first, *parts = ("\n" + script).split("\n" + MARK)
    cells = [("markdown", ast.get_docstring(ast.parse(first)) or "")]
    for part in parts:
        head, _, text = part.partition("\n")
        if head.strip() == "[markdown]":
            lines = [line.removeprefix("#").removeprefix(" ") for line in text.strip().splitlines()]
            cells.append(("markdown", "\n".join(lines)))
        elif head.strip():
            sys.exit(f"a cell begins with `{MARK}{head}`; allowed: `{MARK}` and `{MARK} [markdown]`")
        else:
            cells.append(("code", text.strip()))
    return [(kind, text) for kind, text in cells if text]


def notebook_of(script: str) -> Any:
    """Return the notebook of a script, not yet executed."""
    cells = []
    for number, (kind, text) in enumerate(cells_of(script)):
        make = nbformat.v4.new_markdown_cell if kind == "markdown" else nbformat.v4.new_code_cell
        # Numbers keep the file the same from run to run.
        cells.append(make(text, id=f"cell-{number}"))
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})


async def execute(notebook: Any, site: str) -> None:
    """Execute a notebook in place. An error of a cell is raised."""
    with tempfile.TemporaryDirectory() as folder:
        # The scripts take the folder of their pictures. Packages of this environment come first.
        before = f"import sys\nsys.path.append({site!r})\nsys.argv[1:] = [{folder!r}]"
        notebook.cells.insert(0, nbformat.v4.new_code_cell(before))
        client = NotebookClient(
            notebook,
            timeout=120,
            kernel_name="python3",
            # Pictures of twice the density of a page.
            extra_arguments=["--InlineBackend.figure_formats=retina"],
            resources={"metadata": {"path": folder}},
            # Files rather than ports, which other users of this computer could reach.
            config=Config({"KernelManager": {"transport": "ipc", "ip": f"{folder}/kernel"}}),
        )
        await client.async_execute()
        del notebook.cells[0]
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.execution_count = None
            for output in cell.outputs:
                if "execution_count" in output:
                    output.execution_count = None


async def make(script: Path, site: str, target: Path, turn: asyncio.Semaphore) -> None:
    """Execute one script and write its notebook."""
    async with turn:
        begun = time.monotonic()
        notebook = notebook_of(script.read_text(encoding="utf-8"))
        await execute(notebook, site)
        nbformat.validate(notebook)
        nbformat.write(notebook, target / f"{script.stem}.ipynb")
        print(f"{script.stem}: executed in {time.monotonic() - begun:.0f} s")


async def main(gallery: Path, site: str, target: Path) -> None:
    """Execute every script of the gallery."""
    target.mkdir(parents=True, exist_ok=True)
    for old in target.glob("*.ipynb"):
        old.unlink()
    turn = asyncio.Semaphore(AT_ONCE)
    await asyncio.gather(*(make(script, site, target, turn) for script in sorted(gallery.glob("*.py"))))


if __name__ == "__main__":
    asyncio.run(main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])))
