import sys
from pathlib import Path

import pytest

from pumpmodel._results.optional import optional


def test_a_package_that_is_missing_is_told_with_its_extra() -> None:
    with pytest.raises(
        ModuleNotFoundError, match=r'nonesuch is not installed; .*: pip install "./crates/pump-py\[plot\]"'
    ):
        optional("nonesuch.part", "plot")


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        ("import nonesuch", ModuleNotFoundError, "No module named 'nonesuch'"),
        ("raise ImportError('libX.so is missing')", ImportError, "libX.so is missing"),
    ],
)
def test_a_package_that_is_there_and_fails_raises_its_own_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, error: type[Exception], message: str
) -> None:
    (tmp_path / "broken_package.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(error, match=message) as raised:
        optional("broken_package", "plot")
    assert "pip install" not in str(raised.value)
    sys.modules.pop("broken_package", None)
