"""Print the notes of a version, its section of CHANGELOG.md: `release_notes.py VERSION ADDRESS`.

ADDRESS is where the files of the version are read, such as https://github.com/OWNER/REPOSITORY/blob/v1.2.3.
"""

import re
import sys
from pathlib import Path

# GitHub refuses the notes of a release above 125,000 characters.
MOST = 125_000


def section(changelog, version):
    """Return the text below the heading of a version, up to the next one."""
    heading = rf"^## \[{re.escape(version)}\](.*)\n((?:(?!## ).*\n?)*)"
    found = re.search(heading, changelog, re.MULTILINE)
    if not found or not found[2].strip():
        sys.exit(f"CHANGELOG.md says nothing of {version}: give its changes the heading `## [{version}] - DATE`")
    if "not published" in found[1]:
        sys.exit(f"CHANGELOG.md says that {version} is not published")
    return found[2].strip() + "\n"


def notes(changelog, version, address, most=MOST):
    """Return the notes of a version. Links lead to its files; notes that are too long end with a link to the whole."""
    text = re.sub(r"\]\((?![a-z]+:|#)", f"]({address}/", section(changelog, version))
    if len(text) <= most:
        return text
    rest = f"\nThe list is longer than a release may say: [CHANGELOG.md]({address}/CHANGELOG.md) has all of it.\n"
    # Whole items alone: the last one may be cut off.
    kept = text[: most - len(rest)]
    return kept[: kept.rindex("\n- ") + 1] + rest


if __name__ == "__main__":
    here = Path(__file__).resolve().parent.parent
    print(notes((here / "CHANGELOG.md").read_text(), *sys.argv[1:]), end="")
