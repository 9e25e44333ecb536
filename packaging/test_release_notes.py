"""Tests of the notes of a release."""

import re
from pathlib import Path

import pytest
from release_notes import MOST, notes

CHANGELOG = """# Changelog

## [Unreleased]

- Later.

## [0.2.0] - 2027-01-02

### Added

- The first, in [the guide](docs/start.md) and [elsewhere](https://example.org).
- The second.

## [0.1.0] - 2026-11-21, not published

- Earlier.
"""
ADDRESS = "https://example.org/blob/v0.2.0"


def test_notes_are_the_section_of_the_version_alone_and_their_links_lead_to_its_files():
    assert notes(CHANGELOG, "0.2.0", ADDRESS) == (
        f"### Added\n\n- The first, in [the guide]({ADDRESS}/docs/start.md) and [elsewhere](https://example.org).\n"
        "- The second.\n"
    )


@pytest.mark.parametrize("version", ["0.3.0", "0.2", "0.1.0"])
def test_a_version_without_changes_or_that_is_not_published_is_refused(version):
    with pytest.raises(SystemExit, match=version):
        notes(CHANGELOG, version, ADDRESS)


@pytest.mark.parametrize("most", [320, 350])
def test_notes_that_are_too_long_end_with_whole_items_and_a_link_to_the_file(most):
    short = notes(CHANGELOG.replace("The second.", "The second is long. " * 20), "0.2.0", ADDRESS, most)
    assert len(short) <= most
    assert "elsewhere](https://example.org).\n\nThe list is longer" in short
    assert "The second" not in short
    assert f"({ADDRESS}/CHANGELOG.md)" in short


def test_what_is_unreleased_now_can_be_released():
    changelog = (Path(__file__).parent.parent / "CHANGELOG.md").read_text()
    released = re.sub(r"^## \[Unreleased\]", "## [9.9.9] - 2027-01-01", changelog, flags=re.MULTILINE)
    text = notes(released, "9.9.9", ADDRESS)
    assert 1000 < len(text) <= MOST
    assert "\n## " not in text
