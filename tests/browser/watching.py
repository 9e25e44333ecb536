"""What a person at the page sees."""

import math
import os
import re
import time
from pathlib import Path
from urllib.parse import urlsplit

from playwright.sync_api import expect

from laboratory import wait_for

HERE = Path(__file__).parent
AXE = HERE / "node_modules/axe-core/axe.min.js"
WIDE = {"width": 1280, "height": 900}
PHONE = {"width": 360, "height": 740}
SMALL = {"width": 360, "height": 640}
LAPTOP = {"width": 1366, "height": 768}
REACHES_STOP = """() => {
  const top = [...document.querySelectorAll('dialog[open]')].pop();
  const stop = top ? top.querySelector('.stops .stop') : document.getElementById('stop');
  const { left, top: y, width, height } = stop.getBoundingClientRect();
  return [0.1, 0.5, 0.9].every((part) => stop === document.elementFromPoint(left + part * width, y + part * height));
}"""
"""True if a press anywhere at the stop of what is in front meets it."""

DRAFT = os.environ.get("PAGE")
"""A folder whose files stand for the page's own, so that a change is seen without a build."""

SLOWER = 6
"""How many times slower than this machine's a phone's processor is taken to be."""

expect.set_options(timeout=20_000)


def watch(browser, url, size=WIDE, **options):
    """Open the page. It keeps the errors of its console, and each frame that it was shown."""
    context = browser.new_context(viewport=size, locale="en-GB", **options)
    context.set_default_timeout(20_000)
    if DRAFT:
        for address, name in {"/": "index.html", "/app.js": "app.js", "/style.css": "style.css"}.items():
            context.route(lambda asked, address=address: urlsplit(asked).path == address, draft(name))
    page = context.new_page()
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    page.on("dialog", lambda box: (page.faults.append(f"dialog {box.message}"), box.dismiss()))
    page.on("console", lambda told: page.faults.append(told.text) if is_fault(told) else None)
    page.goto(url)
    return page


def draft(name):
    """Return what answers a request with a file of the draft, under the head of the service."""
    return lambda route: route.fulfill(response=route.fetch(), body=(Path(DRAFT) / name).read_text())


def is_fault(told):
    """Return true for an error of the console, but not for one of a request that was lost or refused."""
    return told.type == "error" and not re.search(r"Failed to load resource|net::ERR_", told.text)


def live(page):
    """Wait until the page shows pumps that it hears of."""
    expect(page.locator("#link")).to_have_text("Live")
    expect(page.locator("main .panel").first).to_be_visible()
    return page


def panel(page, pump):
    """Return the panel of a pump: its card among others, or its view."""
    return page.get_by_role("article", name=pump, exact=True).or_(page.locator(".wide"))


def state(page, pump):
    """Return the line that says what a pump does."""
    return panel(page, pump).locator(".state")


def turns(page, pump):
    """Wait until a head is seen to turn."""
    before = angle(page, pump)
    end = time.monotonic() + 3
    while angle(page, pump) == before:
        assert time.monotonic() < end, "the head turns"
        page.wait_for_timeout(20)


def angle(page, pump):
    """Return the angle at which the rotor is drawn now, in degrees."""
    turned = "(rotor) => { const m = new DOMMatrix(getComputedStyle(rotor).transform); return Math.atan2(m.b, m.a); }"
    return math.degrees(panel(page, pump).locator(".rotor").evaluate(turned))


def barriers(page, where):
    """Return what axe-core finds: all rules, those of WCAG 2.2 AA and its best practices."""
    # The debugger puts it in, since the page's policy forbids other scripts.
    page.evaluate(AXE.read_text() + "; undefined")
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [
        f"{where}: {rule['id']}, {rule['help']}: {node['target']} {node['html'][:160]}"
        for rule in found
        for node in rule["nodes"]
    ]


def is_too_wide(page):
    """Return true if the page scrolls sideways."""
    return page.evaluate("document.documentElement.scrollWidth > document.documentElement.clientWidth")


def inspect(page, where):
    """Hold what is shown now against axe in light and dark, and against a phone's width."""
    found = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        found += barriers(page, f"{where}, {scheme}")
    page.set_viewport_size(PHONE)
    found += barriers(page, f"{where}, dark, phone")
    if is_too_wide(page):
        found.append(f"{where}: it scrolls sideways at 360 px")
    stop = page.locator("#stop").bounding_box()
    if stop["y"] + stop["height"] > PHONE["height"]:
        found.append(f"{where}: the stop is out of sight")
    for size in (SMALL, LAPTOP):
        page.set_viewport_size(size)
        if not page.evaluate(REACHES_STOP):
            found.append(f"{where}: no stop can be pressed at {size['width']} x {size['height']}")
    page.set_viewport_size(WIDE)
    page.emulate_media(color_scheme="light")
    # A busy computer lays the page out later than it is told to.
    page.wait_for_function("width => innerWidth === width && visualViewport.offsetTop === 0", arg=WIDE["width"])
    return found


def wait_for_dose(page, service, pump, volume="90mL"):
    """Let a pump dose by another program, until the page shows it."""
    service.dose(pump, volume)
    expect(state(page, pump)).to_have_text("Dosing")


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
