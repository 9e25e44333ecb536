"""A preprocessor of mdBook: the executed notebooks of the gallery, below docs/gallery.md.

`make docs` executes them into target/notebooks and copies them beside the pages.
"""

import json
import sys
from pathlib import Path
from typing import Any

from chapters import add_below, answered

NOTEBOOKS = Path(__file__).parent.parent / "target/notebooks"
PARENT = "gallery.md"


def page_of(notebook: dict[str, Any], name: str) -> tuple[str, str]:
    """Return the title and the Markdown of an executed notebook."""
    title = name.replace("_", " ").capitalize()
    parts = [f"# {title}\n", f"[The notebook](gallery/{name}.ipynb) of this page, to be run.\n"]
    for cell in notebook["cells"]:
        text = _text(cell["source"])
        parts.append(f"```python\n{text}\n```\n" if cell["cell_type"] == "code" else f"{text}\n")
        for output in cell.get("outputs", ()):
            parts.append(_output(output, title))
    return title, "\n".join(parts)


def _text(lines: str | list[str]) -> str:
    return lines if isinstance(lines, str) else "".join(lines)


def _output(output: dict[str, Any], title: str) -> str:
    if output["output_type"] == "stream":
        return f"```text\n{_text(output['text']).rstrip()}\n```\n"
    data = output.get("data", {})
    if picture := data.get("image/png"):
        # Pictures have twice the density of the page.
        width = output.get("metadata", {}).get("image/png", {}).get("width")
        sized = f' width="{width}"' if width else ""
        return f'<img alt="{title}"{sized} src="data:image/png;base64,{"".join(_text(picture).split())}">\n'
    # Tables of results are one line of HTML. A page of scripts, as an animation is, has no place in the guide.
    html = _text(data.get("text/html", ""))
    if html.startswith("<div>") and "\n" not in html and "<script" not in html:
        return f"{html}\n"
    if "text/plain" in data:
        return f"```text\n{_text(data['text/plain'])}\n```\n"
    sys.exit(f"an output of {title} is {output['output_type']}; allowed: text and pictures")


def pages_of(folder: Path) -> dict[str, str]:
    """Return the pages of the executed notebooks in a folder, by their titles."""
    files = sorted(folder.glob("*.ipynb"))
    if not files:
        sys.exit(f"{folder} has no notebooks; `make docs` executes them")
    return dict(page_of(json.loads(file.read_text(encoding="utf-8")), file.stem) for file in files)


if __name__ == "__main__":
    answered(lambda book: add_below(book["items"], PARENT, "gallery", pages_of(NOTEBOOKS)))
