"""Sizes and times of the page."""

from itertools import pairwise

from playwright.sync_api import expect

from laboratory import ROOT, wait_for
from watching import state

SLOWER = 6
"""How many times slower than this machine's a phone's processor is taken to be."""


def test_the_page_is_small(service, open_page):
    page = open_page(service.url)
    files = ("", "app.js", "style.css", "icon.svg")
    sizes = {name or "index.html": len(page.request.get(f"{service.url}/{name}").body()) for name in files}
    assert sum(sizes.values()) < 100_000, sizes
    kept = {file.name for file in (ROOT / "crates/pump-service/src/page").iterdir()}
    assert kept == set(sizes), "each file of the page is counted"


def frames(page, session, seconds):
    """Return the times of the frames that were drawn, by the browser's own trace, in ms."""
    events, ended = [], []
    session.on("Tracing.dataCollected", lambda part: events.extend(part["value"]))
    session.on("Tracing.tracingComplete", lambda _: ended.append(True))
    categories = "disabled-by-default-devtools.timeline.frame,devtools.timeline.frame"
    session.send("Tracing.start", {"transferMode": "ReportEvents", "categories": categories})
    page.wait_for_timeout(1000 * seconds)
    session.send("Tracing.end")

    def is_over():
        page.wait_for_timeout(20)
        return ended

    wait_for("the trace", is_over)
    return sorted(event["ts"] / 1000 for event in events if event["name"] == "DrawFrame")


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
