"""The wheel as it is installed: what a package index shows, and the licences."""

import tomllib
from importlib.metadata import distribution, metadata
from pathlib import Path

ROOT = Path(__file__).parents[4]


def test_the_wheel_has_both_licence_texts_of_the_repository() -> None:
    files = {
        Path(file).name: file for file in distribution("pumpmodel").files or [] if "licenses" in str(file)
    }
    for name in ("LICENSE-APACHE", "LICENSE-MIT"):
        assert files[name].read_text() == (ROOT / name).read_text(encoding="utf-8")


def test_the_readme_of_the_wheel_tells_the_rust_that_a_build_needs() -> None:
    cargo = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    rust = cargo["workspace"]["package"]["rust-version"]
    build = tomllib.loads((ROOT / "crates/pump-py/pyproject.toml").read_text(encoding="utf-8"))
    assert build["build-system"]["build-backend"] == "maturin"
    readme = (ROOT / "crates/pump-py/README.md").read_text(encoding="utf-8")
    assert f"needs Rust {rust} or later" in " ".join(readme.split())
    assert "`maturin`" in readme


def test_the_wheel_tells_a_package_index_what_it_is() -> None:
    told = metadata("pumpmodel")
    assert told["License-Expression"] == "MIT OR Apache-2.0"
    assert told["Author"] == "pump-dose contributors"
    assert told["Description-Content-Type"].startswith("text/markdown")
    assert told["Description"].startswith("# pumpmodel")
    classifiers = told.get_all("Classifier") or []
    assert {"Typing :: Typed", "Programming Language :: Python :: 3.11"} <= set(classifiers)
    assert told["Requires-Python"] == ">=3.11"
