import contextlib
import io
import re
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib import pyplot as plt

ROOT = Path(__file__).parents[4]
PICTURES = ROOT / "docs" / "python"
BLOCK = re.compile(r"```python\n(?P<code>.*?)```\n(?:\n```text\n(?P<expected>.*?)```)?", re.DOTALL)

mpl.use("Agg")


@pytest.mark.parametrize(("page", "blocks"), [("README.md", 1), ("docs/python.md", 19)])
def test_a_pages_examples_print_and_draw_what_it_shows(
    page: str, blocks: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DOSE_STATE_DIR", str(tmp_path / "state"))
    found = list(BLOCK.finditer((ROOT / page).read_text(encoding="utf-8")))
    assert len(found) == blocks
    for block in found:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block["code"], page, "exec"), {})
        assert printed.getvalue() == (block["expected"] or "")
    plt.close("all")
    drawn = sorted([*tmp_path.glob("*.png"), *tmp_path.glob("*.gif")])
    shown = re.findall(r"\bpython/(\w+\.(?:png|gif))", (ROOT / page).read_text(encoding="utf-8"))
    assert [picture.name for picture in drawn] == sorted(shown)
    for picture in drawn:
        assert plt.imread(picture).shape == plt.imread(PICTURES / picture.name).shape
