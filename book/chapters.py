"""Chapters that a preprocessor of mdBook adds below a page of docs/."""

import json
import sys
from collections.abc import Callable
from typing import Any


def add_below(items: list[Any], parent: str, prefix: str, pages: dict[str, str]) -> None:
    """Add pages, by their titles, below the chapter of a page, and links to them at its end.

    Exit with a message if the guide has no such page.
    """
    found = _chapter(items, parent)
    if found is None:
        sys.exit(f"the guide has no page {parent}, below which others come; it belongs into docs/SUMMARY.md")
    for title, text in pages.items():
        path = f"{prefix}_{title.lower().replace(' ', '_')}.md"
        found["sub_items"].append(
            {
                "Chapter": {
                    "name": title,
                    "content": text,
                    "number": None,
                    "sub_items": [],
                    "path": path,
                    "source_path": path,
                    "parent_names": [*found["parent_names"], found["name"]],
                }
            }
        )
    links = [f"- [{each['Chapter']['name']}]({each['Chapter']['path']})" for each in found["sub_items"]]
    found["content"] += "\n" + "\n".join(links) + "\n"


def _chapter(items: list[Any], path: str) -> dict[str, Any] | None:
    for item in items:
        chapter = item.get("Chapter") if isinstance(item, dict) else None
        if chapter is None:
            continue
        if chapter["path"] == path:
            return chapter
        if (below := _chapter(chapter["sub_items"], path)) is not None:
            return below
    return None


def answered(change: Callable[[dict[str, Any]], None]) -> None:
    """Answer as mdBook asks: `supports RENDERER`, or the book on standard input, changed."""
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0 if sys.argv[2] == "html" else 1)
    _, book = json.load(sys.stdin)
    change(book)
    json.dump(book, sys.stdout)
