"""Examples of the pages as a user's own scripts, by mypy in its strict mode."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[4]
# Types of the packages that the pages import are read once.
CACHE = ROOT / "crates/pump-py/.mypy_cache/pages"
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)

# SciPy has no types, and PyLabRobot's are not exported.
CONFIG = """
[mypy]
strict = true
[mypy-control.*,scipy.*]
ignore_missing_imports = true
"""


def test_every_python_example_of_the_pages_type_checks_strictly(tmp_path: Path) -> None:
    (tmp_path / "mypy.ini").write_text(CONFIG)
    scripts = []
    for page in ("README.md", "docs/python.md", "crates/pump-py/README.md"):
        blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
        assert blocks
        for number, block in enumerate(blocks):
            name = re.sub(r"\W", "_", f"{page}_{number}")
            (tmp_path / f"{name}.py").write_text(block, encoding="utf-8")
            scripts.append(f"{name}.py")
    # A block reveals that PyLabRobot's pump is ours and not Any.
    robot = next(script for script in scripts if "BenchPump(" in (tmp_path / script).read_text())
    text = (tmp_path / robot).read_text()
    (tmp_path / robot).write_text(re.sub(r"(        )(dose = await)", r"\1reveal_type(pump)\n\1\2", text))
    told = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", "mypy.ini", "--cache-dir", str(CACHE), *scripts],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert told.returncode == 0, told.stdout
    assert 'Revealed type is "pumpmodel.pylabrobot.pump.BenchPump"' in told.stdout
