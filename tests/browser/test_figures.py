"""Sizes and times of the page."""

import json
import os
import re
import signal
from itertools import pairwise

from playwright.sync_api import expect

from laboratory import ROOT
from watching import SLOWER, frames, is_too_wide, state


def test_the_page_is_small(service, open_page):
    page = open_page(service.url)
    files = ("", "app.js", "style.css", "icon.svg")
    sizes = {name or "index.html": len(page.request.get(f"{service.url}/{name}").body()) for name in files}
    assert sum(sizes.values()) < 100_000, sizes
    kept = {file.name for file in (ROOT / "crates/pump-service/src/page").iterdir()}
    assert kept == set(sizes), "each file of the page is counted"


def test_the_figure_fits_the_narrowest_phones(service, open_page):
    for volume, words in (
        ("9.693mL", "9.69 mL"),
        ("-0.3286mL", "\N{MINUS SIGN}0.328 mL"),
        ("-109.69mL", "\N{MINUS SIGN}109.7 mL"),
    ):
        service.post("/api/v1/pumps/acid/dose", {"volume": volume, "options": {"rate": "9mL/s"}})
        service.ended("acid")
        fits(service, open_page, words)


def fits(service, open_page, words):
    """See that the figure is whole on phones."""
    for view in ("", "/#/pump/acid"):
        page = open_page(service.url + view, size={"width": 360, "height": 740})
        for width in (390, 360, 320):
            page.set_viewport_size({"width": width, "height": 740})
            figure = page.locator(".face .big")
            expect(figure).to_have_text(words)
            shown, needed = figure.evaluate("(el) => [el.clientWidth, el.scrollWidth]")
            assert needed <= shown, f"{view} at {width} px: {needed} of {shown}"
            assert not is_too_wide(page)


def test_the_bounds_of_a_killed_dose_fit_the_narrowest_phones(laboratory, service, open_page):
    service.dose("acid", "90mL", rate="4mL/s")
    holder = json.loads(laboratory.run("status", "--format", "json"))["in_use_by"]
    os.kill(int(re.sub(r"\D", "", holder)), signal.SIGKILL)
    service.ended("acid")
    page = open_page(service.url + "/#/pump/acid", size={"width": 320, "height": 740})
    figure = page.locator(".face .big")
    expect(figure).to_have_text(re.compile(r"^[\d.]+ to [\d.]+ mL$"))
    shown, needed = figure.evaluate("(el) => [el.clientWidth, el.scrollWidth]")
    assert needed <= shown
    assert not is_too_wide(page)


def test_eight_turning_heads_are_drawn_smoothly_by_a_slow_phone(make_laboratory, open_page, capsys):
    pumps = [f"pump-{n}" for n in range(8)]
    service = make_laboratory(pumps=pumps).serve()
    page = open_page(service.url)
    session = page.context.new_cdp_session(page)
    session.send("Emulation.setCPUThrottlingRate", {"rate": SLOWER})
    for pump in pumps:
        service.dose(pump, "150mL")
    for pump in pumps:
        expect(state(page, pump)).to_have_text("Dosing")
    page.wait_for_timeout(1000)
    drawn = frames(page, session, 5)
    gaps = sorted(after - before for before, after in pairwise(drawn))
    rate = 1000 * len(gaps) / (drawn[-1] - drawn[0])
    with capsys.disabled():
        print(
            f"\n  8 pumps turn, processor {SLOWER} times slower: {rate:.1f} frames/s, "
            f"99 of 100 within {gaps[int(0.99 * len(gaps))]:.1f} ms, longest {gaps[-1]:.1f} ms"
        )
    service.stop()
    session.send("Emulation.setCPUThrottlingRate", {"rate": 1})
    page.wait_for_timeout(1500)
    still = frames(page, session, 2)
    assert rate >= 30, "frames/s"
    assert len(still) < 5, "nothing is drawn while nothing turns"
