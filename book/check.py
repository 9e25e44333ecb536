"""Check the built guide: every link resolves, headings included, and nothing is taken from another host."""

import base64
import binascii
import struct
import sys
import zlib
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# A browser fetches these by itself, by element and attribute. A link is followed only by a person.
FETCHED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "srcset", "object": "data"}
HOSTS = ("http:", "https:", "//")


class Page(HTMLParser):
    """One page: the anchors that it has, the links that it makes and what it fetches."""

    def __init__(self, text: str) -> None:
        """Read the page's text."""
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.runs_examples = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note the anchors and links of one element."""
        values = {name: value or "" for name, value in attrs}
        self.anchors.update(values[name] for name in ("id", "name") if name in values)
        self.runs_examples |= "playground" in values.get("class", "").split()
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if FETCHED.get(tag) in values:
            self.fetched.append(values[FETCHED[tag]])


def fault_of(link: str, file: Path, pages: dict[Path, Page]) -> str | None:
    """Return what is wrong with a link of the page in `file`, or None."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return None
    target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
    if not target.is_file():
        return "leads to no file"
    if parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
        return "leads to no heading"
    return None


PNG = "data:image/png;base64,"


def is_whole(picture: bytes) -> bool:
    """Return true for a PNG whose parts have the checksums that they state, up to its end."""
    place, name = 8, b""
    while place + 12 <= len(picture):
        (length,) = struct.unpack_from(">I", picture, place)
        name, body = picture[place + 4 : place + 8], picture[place + 8 : place + 8 + length]
        if picture[place + 8 + length : place + 12 + length] != struct.pack(">I", zlib.crc32(name + body)):
            return False
        place += 12 + length
    return picture.startswith(b"\x89PNG") and name == b"IEND"


def is_broken(link: str) -> bool:
    """Return true for a picture in a page itself that no browser can show."""
    if not link.startswith(PNG):
        return False
    try:
        return not is_whole(base64.b64decode(link.removeprefix(PNG), validate=True))
    except binascii.Error:
        return True


def pages_of(guide: Path) -> dict[Path, Page]:
    """Return the pages of the guide by their files."""
    return {file.resolve(): Page(file.read_text()) for file in sorted(guide.rglob("*.html"))}


def outward(pages: dict[Path, Page]) -> list[str]:
    """Return the links to other hosts, each with the pages that have it."""
    found: dict[str, set[str]] = {}
    for file, page in pages.items():
        for link in page.links:
            if link.startswith(HOSTS) and file.name != "print.html":
                found.setdefault(link, set()).add(file.name)
    return [f"{link}  {' '.join(sorted(names))}" for link, names in sorted(found.items())]


def faults(guide: Path, sources: Path) -> tuple[int, list[str]]:
    """Return the number of links within the guide, and what is wrong with it."""
    pages = pages_of(guide)
    found, count = [], 0
    for file, page in pages.items():
        for link in page.links + page.fetched:
            count += 1
            if fault := fault_of(link, file, pages):
                found.append(f"{file.name}: {link} {fault}")
        if page.runs_examples:
            found.append(f"{file.name}: an example asks a foreign host to run it")
        found += [f"{file.name}: a picture is broken: {link[:60]}" for link in page.fetched if is_broken(link)]
        found += [f"{file.name}: fetches {link}" for link in page.fetched if link.startswith(HOSTS)]
    for style in guide.rglob("*.css"):
        text = style.read_text()
        found += [f"{style.name}: fetches from {host}" for host in HOSTS if f"url({host}" in text.replace('"', "")]
    for source in sources.glob("*.md"):
        if source.name != "SUMMARY.md" and (guide / source.with_suffix(".html").name).resolve() not in pages:
            found.append(f"{source}: not in SUMMARY.md")
    return count, found


def main() -> None:
    """Check the guide in the folder that the first argument names, built from the second."""
    guide, sources = map(Path, sys.argv[1:])
    count, found = faults(guide, sources)
    if found:
        sys.exit("\n".join([*found, f"the guide has {len(found)} faults"]))
    outside = outward(pages_of(guide))
    (guide / "outside.txt").write_text("\n".join(outside) + "\n")
    print(f"{len(outside)} links lead to other hosts, and are not tried: {guide / 'outside.txt'}")
    print(f"{count} links of the guide resolve. Its first page: {guide / 'index.html'}")


if __name__ == "__main__":
    main()
