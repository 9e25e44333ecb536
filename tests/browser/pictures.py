"""Make the pictures of docs/serve.md, docs/demo.md, README: `python tests/browser/pictures.py` after `make browser`."""

import tempfile
from pathlib import Path

from playwright.sync_api import expect

from conftest import launched
from laboratory import ROOT, Laboratory
from watching import PHONE, live, turns, watch

PUMPS = {"acid": "Acid, 0.1 M", "base": "Base, 0.1 M", "feed": "Feed of reactor 2"}


# Documents show each picture at half the width that it has.
TWICE = 2
SCHEMES = {"light": "", "dark": "_dark"}


def take(browser, service, address, size, name):
    """Write pictures of what an address shows, light and dark."""
    for scheme, suffix in SCHEMES.items():
        page = watch(browser, service.url + address, size=size, device_scale_factor=TWICE, color_scheme=scheme)
        turns(live(page), "acid")
        # The rollers and the bar have come from where they stood.
        page.wait_for_timeout(1500)
        page.screenshot(path=ROOT / "docs" / f"{name}{suffix}.png")
        page.context.close()


def take_demo(browser):
    """Write pictures of the demo in the middle of its dose, which README shows 640 px wide."""
    address, size = (ROOT / "target/demo/index.html").as_uri(), {"width": 1280, "height": 1225}
    for scheme, suffix in SCHEMES.items():
        page = watch(browser, address, size=size, device_scale_factor=TWICE * 640 / 1280, color_scheme=scheme)
        expect(page.get_by_role("button", name="Pause")).to_be_visible()
        page.evaluate("seek(3)")
        page.screenshot(path=ROOT / "docs" / f"demo{suffix}.png")
        page.context.close()


def main():
    """Let pumps move, and take their pictures."""
    with tempfile.TemporaryDirectory() as folder, launched() as browser:
        take_demo(browser)
        limit = "\n[safety]\nmax_ml_per_day = 500.0\nvessel_ml = 1000.0\n"
        laboratory = Laboratory(Path(folder), pumps=tuple(PUMPS), titles=PUMPS, lines={"base": limit})
        try:
            service = laboratory.serve()
            service.dose("feed", "12mL")
            service.ended("feed")
            service.dose("base", "60mL", rate="3mL/s")
            service.dose("acid", "80mL")
            take(browser, service, "/", {"width": 1280, "height": 600}, "serve_wide")
            take(browser, service, "/#/pump/acid", PHONE, "serve_phone")
        finally:
            laboratory.end()


if __name__ == "__main__":
    main()
