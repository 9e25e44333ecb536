"""The reference of the Python module: signatures of stubs, docstrings as Markdown, every public name on a page."""

import re
from pathlib import Path

import pytest
from api import LAST, PACKAGE, PAGES, pages_of
from api_sources import Sources
from chapters import add_below
from docstrings import markdown

PAGES_OF_GUIDE = pages_of(Sources(PACKAGE))


def test_every_public_name_has_a_section_with_its_docstring() -> None:
    names = re.findall(r'^    "(\w+)",$', (PACKAGE / "__init__.py").read_text(), re.MULTILINE)
    assert len(names) > 50
    text = "\n".join(PAGES_OF_GUIDE.values())
    for name in set(names) - {"__version__", "choices"}:
        (found,) = re.findall(rf"^## {name}\n\n```python\n[^`]+```\n\n(.+)", text, re.MULTILINE)
        assert found


def test_a_page_lists_no_name_that_is_gone() -> None:
    public = Sources(PACKAGE).public("pumpmodel")
    assert [name for names in PAGES.values() for name in names if name not in public] == []
    assert list(PAGES_OF_GUIDE)[: len(PAGES)] == list(PAGES)
    assert LAST not in PAGES


def test_signatures_are_those_of_the_stubs_and_overloads_are_one(tmp_path: Path) -> None:
    (tmp_path / "__init__.py").write_text('from pumpmodel.core import A\n__all__ = ["A"]\n')
    (tmp_path / "core.pyi").write_text(
        "class _Base:\n"
        '    def kept(self) -> int:\n        """Kept of a base."""\n'
        "    def changed(self) -> int: ...\n"
        "class A(_Base):\n"
        '    """An A."""\n'
        "    #: Its size, mm.\n"
        "    size_mm: float\n"
        "    @property\n"
        '    def mass_g(self) -> float | None:\n        """Mass, g."""\n'
        "    @overload\n"
        '    def f(self, *, a: _Number, b: None = None) -> float:\n        """Tell `f`."""\n'
        "    @overload\n"
        "    def f(self, *, a: None = None, b: _Numbers) -> _Array: ...\n"
        '    def changed(self, x: int = 1) -> str:\n        """Changed."""\n'
        "    def _hidden(self) -> None: ...\n"
    )
    found = Sources(tmp_path).public("pumpmodel")["A"]
    assert {each.name: each.signature(each.name) for each in found.methods()} == {
        "f": "f(*, a: float | None = None, b: ArrayLike | None = None) -> float | NDArray[float64]",
        "changed": "changed(x: int = 1) -> str",
        "kept": "kept() -> int",
    }
    assert list(found.attributes()) == [("size_mm", "float", "Its size, mm."), ("mass_g", "float | None", "Mass, g.")]


def test_a_docstring_becomes_lists_and_code() -> None:
    text = markdown(
        """Return a <b>.

        Parameters
        ----------
        a : float
            Angle, rad,
            of `x<y`.

        Raises
        ------
        ValueError
            If `a` < 0.

        Examples
        --------
        >>> f(1)
        2
        """
    )
    assert text == (
        "Return a &lt;b>.\n\n**Parameters**\n\n- `a`, *float*: Angle, rad, of `x<y`.\n\n"
        "**Raises**\n\n- `ValueError`: If `a` &lt; 0.\n\n**Examples**\n\n```python\n>>> f(1)\n2\n```\n"
    )


def test_pages_come_below_the_page_of_docs_with_links_to_them() -> None:
    parent = {"name": "Reference", "path": "api.md", "sub_items": [], "parent_names": [], "content": ""}
    add_below(["Separator", {"Chapter": parent}], "api.md", "api", {"Pumps and lines": "text"})
    assert parent["sub_items"][0]["Chapter"]["path"] == "api_pumps_and_lines.md"
    assert "[Pumps and lines](api_pumps_and_lines.md)" in str(parent["content"])
    with pytest.raises(SystemExit, match=r"no page gallery\.md"):
        add_below([{"Chapter": parent}], "gallery.md", "gallery", {})


@pytest.mark.parametrize("page", list(PAGES_OF_GUIDE))
def test_every_block_of_code_is_closed(page: str) -> None:
    assert PAGES_OF_GUIDE[page].count("```") % 2 == 0
