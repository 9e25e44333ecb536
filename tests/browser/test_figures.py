"""Sizes and times of the page."""

from itertools import pairwise

from playwright.sync_api import expect

from laboratory import ROOT
from watching import SLOWER, frames, state


def test_the_page_is_small(service, open_page):
    page = open_page(service.url)
    files = ("", "app.js", "style.css", "icon.svg")
    sizes = {name or "index.html": len(page.request.get(f"{service.url}/{name}").body()) for name in files}
    assert sum(sizes.values()) < 100_000, sizes
    kept = {file.name for file in (ROOT / "crates/pump-service/src/page").iterdir()}
    assert kept == set(sizes), "each file of the page is counted"


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
