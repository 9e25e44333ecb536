"""A preprocessor of mdBook: pages and links that lie outside docs/.

The documents on top of the repository become pages of the guide. A link to one of them, or to a page or picture of
docs/, leads to its place in the guide. A link to any other file of the repository, which the guide does not have, shows
the name of the file. The sources stay as GitHub renders them.
"""

import json
import posixpath
import re
import sys
from collections.abc import Iterator
from typing import Any

FENCED = re.compile(r"^(```+|~~~+).*?^\1\s*?$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"(?<!`)(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
LINK = re.compile(r"!?\[([^\[\]]*)\]\(\s*([^)\s]+)\s*\)")
PICTURE = re.compile(r'(<(?:img|source) [^>]*?src(?:set)?=")([^"]+)')


def page_name(source: str) -> str:
    """Return the path of a page in the guide, from its path below docs/ (`../DESIGN.md`).

    The contents stand beside each page, so a link to them leads to the first.
    """
    name = source.removeprefix("../")
    return "index.md" if name in ("README.md", "SUMMARY.md") else name


def masked(text: str) -> str:
    """Return a text of the same length with code blanked, so that no link is seen in it."""
    for code in (FENCED, INLINE):
        text = code.sub(lambda found: "\0" * len(found.group()), text)
    return text


def link_in_guide(label: str, whole: str, target: str, source: str, pages: set[str]) -> str:
    """Return a link of the page `source` as it holds in the guide."""
    file, anchor, heading = target.partition("#")
    if "://" in target or not file:
        return whole
    path = posixpath.normpath(posixpath.join("docs", posixpath.dirname(source), file))
    below_docs = posixpath.relpath(path, "docs")
    if below_docs in pages or below_docs == "SUMMARY.md":
        return whole.replace(target, page_name(below_docs) + anchor + heading)
    if path.startswith("docs/"):
        return whole.replace(target, below_docs + anchor + heading)
    return f"`{path}`" if label.strip("`") == path else f"{label} (`{path}`)"


def picture_in_guide(target: str, source: str) -> str:
    """Return the place in the guide of a picture that HTML of the page `source` shows."""
    path = posixpath.normpath(posixpath.join("docs", posixpath.dirname(source), target))
    # An address or data of its own has a scheme.
    return target if ":" in target or not path.startswith("docs/") else posixpath.relpath(path, "docs")


def text_in_guide(text: str, source: str, pages: set[str]) -> str:
    """Return the text of the page `source` with its links as they hold in the guide."""
    parts, end = [], 0
    for found in LINK.finditer(masked(text)):
        begin, after = found.span()
        label = text[slice(*found.span(1))]
        parts += [text[end:begin], link_in_guide(label, text[begin:after], found.group(2), source, pages)]
        end = after
    whole = "".join([*parts, text[end:]])
    return PICTURE.sub(lambda found: found[1] + picture_in_guide(found[2], source), whole)


def chapters(items: list[Any]) -> Iterator[dict[str, Any]]:
    """Yield every chapter that has a file."""
    for item in items:
        if isinstance(item, dict) and (chapter := item.get("Chapter")) and chapter["path"]:
            yield chapter
            yield from chapters(chapter["sub_items"])


def main() -> None:
    """Answer as mdBook asks: `supports RENDERER`, or the book on standard input."""
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0 if sys.argv[2] == "html" else 1)
    _, book = json.load(sys.stdin)
    found = list(chapters(book["items"]))
    pages = {chapter["source_path"] for chapter in found}
    for chapter in found:
        chapter["content"] = text_in_guide(chapter["content"], chapter["source_path"], pages)
        chapter["path"] = page_name(chapter["source_path"])
    json.dump(book, sys.stdout)


if __name__ == "__main__":
    main()
