"""Writes the licences of everything that is compiled into the command: `notices.py FEATURES >THIRD-PARTY.md`.

It fails at a licence that is not known here, so that nobody ships one unseen.
"""

import json
import re
import subprocess
import sys

PERMISSIVE = {
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-1-Clause",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
}
# The source must be offered with a binary (Mozilla Public License 2.0, section 3.2).
SOURCE_OFFERED = {"MPL-2.0"}


def is_permissive(licence: str) -> bool:
    """Tell if an SPDX expression asks for no more than notices: any part of an OR, each part of an AND."""
    expression = licence.replace("/", " OR ").strip()
    while match := re.search(r"\(([^()]*)\)", expression):
        inner = "MIT" if is_permissive(match[1]) else "unknown"
        expression = expression[: match.start()] + inner + expression[match.end() :]
    return any(all(part.strip() in PERMISSIVE for part in option.split(" AND ")) for option in expression.split(" OR "))


def dependencies(features: str) -> list[dict[str, str]]:
    """Return name, version, licence and source of each package that the command links, but for its own workspace."""
    tree = subprocess.run(
        [
            *("cargo", "tree", "--locked", "-p", "pump-dose", "--edges", "normal", "--prefix", "none"),
            *("--target", "all", "--format", "{p}", "--features"),
            features,
        ],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    linked = {tuple(line.split()[:2]) for line in tree.splitlines() if line}
    metadata = json.loads(
        subprocess.run(
            ["cargo", "metadata", "--locked", "--format-version", "1", "--features", features],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
    )
    return sorted(
        (
            package
            for package in metadata["packages"]
            if package["source"] and (package["name"], f"v{package['version']}") in linked
        ),
        key=lambda package: (package["name"], package["version"]),
    )


def main() -> int:
    """Print the notices, and return 1 at a licence that is not known here."""
    packages = dependencies(sys.argv[1] if len(sys.argv) > 1 else "serve")
    unknown = []
    print("# Licences of what is compiled into dose\n")
    print("pump-dose itself is under MIT or Apache-2.0, at your choice.\n")
    offered = [package for package in packages if package["license"] in SOURCE_OFFERED]
    if offered:
        print("These parts are under the Mozilla Public License 2.0 (https://mozilla.org/MPL/2.0/) and unchanged.")
        print("Their source is at the address beside each:\n")
        for package in offered:
            print(f"- {package['name']} {package['version']}: {package['repository']}")
        print()
    print("| part | version | licence | source |\n| --- | --- | --- | --- |")
    for package in packages:
        licence = package["license"] or "none stated"
        if not (is_permissive(licence) or (package in offered and package["repository"])):
            unknown.append(f"{package['name']} {package['version']}: {licence}")
        print(f"| {package['name']} | {package['version']} | {licence} | {package['repository'] or ''} |")
    for line in unknown:
        print(f"unknown licence, or a source to be offered that is not named: {line}", file=sys.stderr)
    return 1 if unknown else 0


if __name__ == "__main__":
    sys.exit(main())
