"""The tools of the guide: links out of docs/ hold in it, and a link that leads nowhere is found."""

from pathlib import Path

import pytest
from check import faults
from outside import text_in_guide

# A picture of one black point.
DOT = (
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg=="
)


def told(text: str, source: str = "start.md") -> str:
    """Return the text of the page `source` as the guide has it."""
    return text_in_guide(text, source, {"start.md", "log.md", "../README.md", "../DESIGN.md"})


def test_a_document_on_top_is_a_page_of_the_guide() -> None:
    assert told("[why](../DESIGN.md#why-so)") == "[why](DESIGN.md#why-so)"
    assert told("[first](../README.md), [contents](SUMMARY.md)") == "[first](index.md), [contents](index.md)"
    assert told("[the\nlog](docs/log.md#a)", "../README.md") == "[the\nlog](log.md#a)"
    assert told("![A dose](docs/dose.svg)", "../README.md") == "![A dose](dose.svg)"


def test_a_picture_of_a_document_on_top_has_its_place_in_the_guide() -> None:
    html = '<picture><source media="x" srcset="docs/a_dark.png"><img src="docs/a.png"></picture>'
    assert told(html, "../README.md") == html.replace("docs/", "")
    assert told('<img src="a.png">', "start.md") == '<img src="a.png">'
    data = '<img src="data:image/png;base64,aa//bb/../cc=">'
    assert told(data, "gallery.md") == data


def test_a_file_that_the_guide_lacks_is_shown_by_name() -> None:
    assert told("a [pump file](../examples/a.toml).") == "a pump file (`examples/a.toml`)."
    assert told("[`examples/a.toml`](../examples/a.toml)") == "`examples/a.toml`"


@pytest.mark.parametrize(
    "text",
    [
        "[a](https://example.org/DESIGN.md)",
        "[b](#heading) and [c](log.md)",
        "`[d](../DESIGN.md)`",
        "```text\n[e](../DESIGN.md)\n```\n",
    ],
)
def test_other_links_and_code_stay(text: str) -> None:
    assert told(text) == text


@pytest.mark.parametrize(
    ("page", "fault"),
    [
        ('<h2 id="b">B</h2><a href="a.html#b">B</a> <a href="#b">B</a> <a href="https://example.org">C</a>', None),
        ('<a href="c.html">C</a>', "c.html leads to no file"),
        ('<img src="c.svg">', "c.svg leads to no file"),
        ('<picture><source srcset="dark.png"><img src="a.html"></picture>', "dark.png leads to no file"),
        ('<a href="a.html#c">C</a>', "a.html#c leads to no heading"),
        ('<a href="#c">C</a>', "#c leads to no heading"),
        ('<script src="https://example.org/a.js"></script>', "fetches https://example.org/a.js"),
        ('<link href="//example.org/a.css">', "fetches //example.org/a.css"),
        ('<pre class="x playground"></pre>', "an example asks a foreign host to run it"),
        (f'<img src="{DOT}">', None),
        (f'<img src="{DOT[:-8] + DOT[-4:]}">', f"a picture is broken: {DOT[:60]}"),
    ],
)
def test_a_link_that_leads_nowhere_or_fetches_from_a_foreign_host_is_a_fault(
    page: str, fault: str | None, tmp_path: Path
) -> None:
    (tmp_path / "a.html").write_text(page)
    assert faults(tmp_path, tmp_path)[1] == ([f"a.html: {fault}"] if fault else [])


def test_a_page_without_a_place_in_the_guide_is_a_fault(tmp_path: Path) -> None:
    for page in ["lost.md", "SUMMARY.md", "a.md", "a.html"]:
        (tmp_path / page).touch()
    assert faults(tmp_path, tmp_path)[1] == [f"{tmp_path / 'lost.md'}: not in SUMMARY.md"]
