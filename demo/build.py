"""Make one file of the page and its module: `build.py MODULE.wasm PAGE.html`."""

import base64
import gzip
import sys
from pathlib import Path

HERE = Path(__file__).parent


def page(module):
    """Return the page with its parts, and the module as base64 of its gzip."""
    text = (HERE / "page.html").read_text()
    packed = base64.b64encode(gzip.compress(module, mtime=0)).decode()
    names = ("page.css", "engine.js", "head.js", "chart.js", "page.js")
    parts = {"pump_demo.wasm": packed} | {name: (HERE / name).read_text() for name in names}
    for name, part in parts.items():
        place = f"/* {name} */"
        if text.count(place) != 1:
            sys.exit(f"page.html has {text.count(place)} places for {name}; it needs one")
        if "</script" in part or "</style" in part:
            sys.exit(f"{name} would end the element that it stands in")
        text = text.replace(place, part)
    return text


def main():
    """Write the page, and say its sizes."""
    module, to = Path(sys.argv[1]).read_bytes(), Path(sys.argv[2])
    made = page(module)
    to.parent.mkdir(parents=True, exist_ok=True)
    to.write_text(made)
    sizes = f"module {len(module):,} bytes, {len(gzip.compress(module)):,} in gzip; page {len(made.encode()):,} bytes"
    print(f"{to}: {sizes}")


if __name__ == "__main__":
    main()
