"""Make the pictures of docs/serve.md, docs/demo.md, README: `python tests/browser/pictures.py` after `make browser`."""

import tempfile
from pathlib import Path

from playwright.sync_api import expect

from conftest import launched
from laboratory import ROOT, Laboratory
from watching import PHONE, live, turns, watch

PUMPS = {"acid": "Acid, 0.1 M", "base": "Base, 0.1 M", "feed": "Feed of reactor 2"}


def take(browser, service, address, size, name, height):
    """Write a picture of what an address shows."""
    page = watch(browser, service.url + address, size=size | {"height": height})
    turns(live(page), "acid")
    # The rollers and the bar have come from where they stood.
    page.wait_for_timeout(1500)
    page.screenshot(path=ROOT / "docs" / name)
    page.context.close()


def take_demo(browser):
    """Write pictures of the demo in the middle of its dose, as wide as a README is shown and below 150 kB."""
    address, size = (ROOT / "target/demo/index.html").as_uri(), {"width": 1280, "height": 1225}
    for scheme, name in {"light": "demo.png", "dark": "demo_dark.png"}.items():
        page = watch(browser, address, size=size, device_scale_factor=0.7, color_scheme=scheme)
        expect(page.get_by_role("button", name="Pause")).to_be_visible()
        page.evaluate("seek(3)")
        page.screenshot(path=ROOT / "docs" / name)
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
            take(browser, service, "/", {"width": 1280}, "serve_wide.png", 640)
            take(browser, service, "/#/pump/acid", {"width": PHONE["width"]}, "serve_phone.png", PHONE["height"])
        finally:
            laboratory.end()


if __name__ == "__main__":
    main()
