"""The demo of `make demo`: the bits of the command, what people do, barriers, and frames per second."""

import csv
import re
import subprocess
from itertools import pairwise

import pytest
from playwright.sync_api import expect

from laboratory import DOSE, PATIENCE, ROOT
from watching import AXE, PHONE, SLOWER, barriers, frames, is_too_wide

PAGE = ROOT / "target/demo/index.html"


@pytest.fixture
def demo(open_page):
    """Open the demo as a file, and wait for its dose."""

    def opened(link="", **options):
        assert PAGE.exists(), "`make demo` makes the page"
        page = open_page(f"{PAGE.as_uri()}{link}", is_live=False, **options)
        expect(page.locator("#theirs")).not_to_have_text("…")
        return page

    return opened


def column(file, name):
    """Return a column of a CSV file as numbers, each of the bits that were written."""
    with file.open() as rows:
        return [float(row[name]) for row in csv.DictReader(line for line in rows if not line.startswith("#"))]


NAMES = {
    "time": "time_s",
    "angle": "angle_rad",
    "speed": "speed_rad_s",
    "qIn": "q_in_ml_s",
    "qOut": "q_out_ml_s",
    "pIn": "p_in_kpa",
    "pOut": "p_out_kpa",
    "vessel": "delivered_ml",
}


@pytest.mark.parametrize(("link", "steps"), [("", 15287), ("#smooth=1&angle=61.5", 0), ("#head=2&volume=7&rate=9", 0)])
def test_the_browser_plans_the_bits_of_the_command(demo, tmp_path, link, steps):
    page = demo(link)
    pump = "two-roller" if "head=2" in link else "three-roller"
    expect(page.locator("#command")).to_contain_text(f"--pump {pump} --dry-run")
    words = page.locator("#command").text_content().split()[1:]
    home = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    outputs = ["--no-service", "--steps", "steps.csv", "--trace", "trace.csv", "--dt", "1ms"]
    subprocess.run([DOSE, *words, *outputs], cwd=tmp_path, env=home, check=True, capture_output=True, timeout=PATIENCE)
    # The debugger puts the planner in, since the page's policy forbids other scripts.
    page.evaluate((ROOT / "demo/engine.js").read_text() + "; globalThis.Engine = Engine; undefined")
    found = page.evaluate(
        """async () => {
            const engine = await Engine.load(document.getElementById('module').textContent);
            const facts = engine.plan(settings);
            const trace = engine.trace(0.001);
            const lists = Object.entries(trace).map(([name, all]) => [name, Array.from(all)]);
            return { facts, steps: Array.from(engine.stepTimes(facts.steps)), trace: Object.fromEntries(lists) };
        }"""
    )
    times = column(tmp_path / "steps.csv", "time_s")
    assert found["facts"]["steps"] == len(times) == (steps or len(times))
    assert found["steps"] == times
    for name, there in NAMES.items():
        assert found["trace"][name] == column(tmp_path / "trace.csv", there), name


def test_a_slow_phone_draws_the_dose_smoothly(demo, capsys):
    page = demo(size=PHONE)
    session = page.context.new_cdp_session(page)
    session.send("Emulation.setCPUThrottlingRate", {"rate": SLOWER})
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    drawn = frames(page, session, 4)
    gaps = sorted(after - before for before, after in pairwise(drawn))
    rate = 1000 * len(gaps) / (drawn[-1] - drawn[0])
    with capsys.disabled():
        print(
            f"\n  the dose plays, processor {SLOWER} times slower: {rate:.1f} frames/s, "
            f"99 of 100 within {gaps[int(0.99 * len(gaps))]:.1f} ms, longest {gaps[-1]:.1f} ms"
        )
    assert rate >= 45, "frames/s"


def test_a_slow_phone_shows_twenty_changes_of_a_slider_a_second(demo, capsys):
    page = demo(size=PHONE)
    session = page.context.new_cdp_session(page)
    # Time of the processor, so that other work on this machine changes little.
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    # A finger moves the slider at each frame.
    page.evaluate(
        """() => {
            globalThis.answers = 0;
            const shows = planner.onmessage;
            planner.onmessage = (event) => { answers += 1; shows(event); };
            const slider = document.querySelector('[data-for=angle]');
            const move = (now) => {
                slider.value = 60 + 59 * Math.sin(now / 700);
                slider.dispatchEvent(new Event('input', { bubbles: true }));
                requestAnimationFrame(move);
            };
            requestAnimationFrame(move);
        }"""
    )

    def spent():
        metrics = session.send("Performance.getMetrics")["metrics"]
        return next(one["value"] for one in metrics if one["name"] == "TaskDuration"), page.evaluate("answers")

    before = spent()
    page.wait_for_timeout(4000)
    after = spent()
    answers = after[1] - before[1]
    change_ms = 1000 * (after[0] - before[0]) / answers
    with capsys.disabled():
        print(
            f"\n  a slider moves: {answers / 4:.0f} plans a second are shown, {change_ms:.2f} ms of the page for each"
        )
    assert answers > 20
    assert SLOWER * change_ms < 50, "ms"


def test_nothing_is_drawn_while_the_dose_stands(demo):
    page = demo("#volume=1&rate=5")
    expect(page.get_by_role("button", name="Play again")).to_be_visible()
    page.wait_for_timeout(800)
    assert len(frames(page, page.context.new_cdp_session(page), 1)) < 5


def inspected(page, where):
    """Hold what is shown against axe in light and dark, wide and on a phone."""
    found = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        found += barriers(page, f"{where}, {scheme}")
    size = page.viewport_size
    page.set_viewport_size(PHONE)
    found += barriers(page, f"{where}, phone")
    if is_too_wide(page):
        found.append(f"{where}: it scrolls sideways at 360 px")
    page.set_viewport_size(size)
    return found


def test_the_demo_suits_everyone(demo):
    assert AXE.exists(), "npm has put axe-core in place"
    page = demo()
    found = inspected(page, "a dose")
    page.get_by_label("Pump head", exact=True).select_option("another head, by its volume")
    page.get_by_label("Rollers, 2 to 24").fill("8")
    expect(page.locator("#head .roller")).to_have_count(8)
    page.get_by_text("Line at inlet and outlet").click()
    found += inspected(page, "another head")
    page.get_by_label("Rate, mL/s", exact=True).fill("90")
    expect(page.get_by_role("alert")).to_contain_text("a rate of 90 mL/s needs")
    found += inspected(page, "a refusal")
    page.get_by_role("button", name="Usual settings").click()
    expect(page.get_by_role("alert")).to_be_hidden()
    expect(page.locator("#ours-error")).to_contain_text("15,287 steps")
    assert not found, "\n".join(found)


def test_the_keyboard_alone_sets_and_plays(demo):
    page = demo(reduced_motion="reduce")
    # A person who wants no motion sees the whole dose at once.
    expect(page.get_by_role("button", name="Play again")).to_be_visible()
    expect(page.locator("#now-volume")).to_have_text("25.00")
    page.keyboard.press("Tab")
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Pause")).to_be_focused()
    expect(page.locator("#now-volume")).not_to_have_text("25.00")
    page.keyboard.press("Space")
    for _ in range(3):
        page.keyboard.press("Tab")
    expect(page.get_by_label("Volume, mL", exact=True)).to_be_focused()
    page.keyboard.press("ControlOrMeta+a")
    page.keyboard.type("1")
    expect(page.locator("#ours")).to_contain_text("1.000")
    page.keyboard.press("Tab")
    page.keyboard.press("ArrowRight")
    expect(page.get_by_label("Volume, mL", exact=True)).to_have_value("1.5")


def test_a_link_carries_the_settings(demo, chromium):
    page = demo()
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_label("Volume, mL", exact=True).fill("2.5")
    page.get_by_label("Smooth").check()
    page.get_by_text("Line at inlet and outlet").click()
    page.get_by_label("Compliance C").fill("0.05")
    page.get_by_role("button", name="Copy a link").click()
    expect(page.locator("#link-said")).to_have_text("The link is copied.")
    link = page.evaluate("navigator.clipboard.readText()")
    assert re.search(r"index\.html#volume=2.5&smooth=1&c=0.05$", link), link
    other = demo(link.partition("index.html")[2])
    expect(other.get_by_label("Volume, mL", exact=True)).to_have_value("2.5")
    expect(other.get_by_label("Smooth")).to_be_checked()
    expect(other.get_by_label("Compliance C")).to_have_value("0.05")
    expect(other.locator("#ours")).to_have_text(page.locator("#ours").text_content())


def test_a_link_that_cannot_be_read_says_so_and_doses_as_usual(demo):
    page = demo("#volume=abc&speed=3&rate=90")
    said = page.locator("#link-wrong")
    expect(said).to_contain_text("volume is “abc” in the link; it must be a number, so 25 is used instead")
    expect(said).to_contain_text("“speed”, which is no setting")
    # The first dose is refused: the curves of the usual one stand in, paler, without its figures.
    expect(page.get_by_role("alert").first).to_contain_text("a rate of 90 mL/s needs")
    expect(page.locator("#head .roller")).to_have_count(3)
    expect(page.locator("body")).to_have_class("stale")
    expect(page.locator("#refusal")).to_contain_text("The pale curves are those of another dose.")
    expect(page.locator("#ours")).to_have_text("\u2013")
    assert page.evaluate("document.getAnimations().filter((motion) => motion.playState === 'running').length") == 0
    # The pause before a dose plays passes.
    page.wait_for_timeout(1500)
    assert page.evaluate("motions.length") == 0, "a dose that is not shown does not play"


def test_a_dose_that_plays_stops_where_the_next_is_refused(demo):
    page = demo()
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    page.get_by_label("Rate, mL/s", exact=True).fill("90")
    expect(page.locator("#refusal")).to_be_visible()
    assert page.evaluate("motions.map((motion) => motion.playState)") == ["paused"] * 4


@pytest.mark.parametrize("width", [360, 1280])
def test_the_largest_dose_keeps_to_its_boxes(demo, width):
    page = demo("#volume=100000", size={"width": width, "height": 900})
    expect(page.locator("#ours")).to_have_text("100,000.00 mL")
    page.evaluate("seek(total())")
    expect(page.locator("#now-volume")).to_have_text("100,000")
    cut = """() => [...document.querySelectorAll('.view p, .view dd, .result, form input[type=number]')]
        .filter((box) => box.clientWidth && box.scrollWidth > box.clientWidth + 1).map((box) => box.id)"""
    assert [page.evaluate(cut), is_too_wide(page)] == [[], False]
    # The numbers of the axis have room: the plot begins right of the widest one.
    page.locator(".chart").last.scroll_into_view_if_needed()
    expect(page.locator(".plot").last).to_have_attribute("style", re.compile(r"--left: [56]\dpx"))
    page.get_by_label("Volume, mL", exact=True).fill("1000000000")
    expect(page.locator("#refusal")).to_contain_text("volume in mL is 1000000000")
    assert page.evaluate(cut) == []


def test_a_refused_dose_leaves_no_figures_of_the_one_before(demo):
    page = demo()
    expect(page.locator("#said")).to_contain_text("inlet")
    volume = page.get_by_label("Volume, mL", exact=True)
    volume.fill("1e9")
    expect(page.locator("#refusal")).to_contain_text("Not planned: ")
    for figure in ["#ours", "#theirs"]:
        expect(page.locator(figure)).to_have_text("\u2013")
    for words in ["#ours-error", "#theirs-error", "#said"]:
        expect(page.locator(words)).to_be_empty()
    for hidden in ["#command-line", "#caution", "#now-volume"]:
        expect(page.locator(hidden)).to_be_hidden()
    volume.fill("2.5")
    expect(page.locator("#ours")).to_contain_text("2.5")
    expect(page.locator("#refusal")).to_be_hidden()
    expect(page.locator("#now-volume")).to_be_visible()


def test_a_link_with_a_head_that_is_none_says_so(demo):
    page = demo("#head=9&smooth=2&volume=2.5")
    expect(page.locator("#link-wrong")).to_contain_text("head is “9” in the link; it must be one of 3, 2, 0")
    expect(page.locator("#link-wrong")).to_contain_text("smooth is “2”")
    expect(page.get_by_label("Volume, mL", exact=True)).to_have_value("2.5")
    page.get_by_label("Volume, mL", exact=True).fill("3")
    expect(page.locator("#link-wrong")).to_be_hidden()


LINE = (
    "resistance_kpa_s_ml = 0.1108\ncompliance_ml_kpa = 0.0361\ninertance_kpa_s2_ml = 0.0042\nreservoir_kpa = 88.637\n"
)


@pytest.mark.parametrize("link", ["#head=0&rate=5&smooth=1", "#smooth=1"])
def test_a_smooth_flow_is_warned_of_as_by_the_command(demo, tmp_path, link):
    home = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    run = {"cwd": tmp_path, "env": home, "check": True, "capture_output": True, "text": True, "timeout": PATIENCE}
    pump = "three-roller"
    if "head=0" in link:
        pump = "other.toml"
        head = ["--ml-per-rev", "6.3mL", "--rollers", "6", "--steps-per-rev", "12800"]
        subprocess.run([DOSE, "pumps", "new", *head, pump], **run)
        with (tmp_path / pump).open("a") as file:
            file.write(f"\n[inlet]\n{LINE}\n[outlet]\n{LINE}")
    words = ["25mL", "--rate", "5mL/s", "--start-angle", "17.19deg+-0deg", "--smooth", "--dry-run", "--no-service"]
    told = subprocess.run([DOSE, *words, "--pump", pump], **run).stdout
    caution = demo(link).locator("#caution")
    expect(caution).to_contain_text("widens the swing of the inlet pressure")
    said = caution.text_content()
    swing = re.search(r"inlet pressure: (.* at constant speed) \(absolute\)", told)[1]
    assert swing in said, f"{said}\n{told}"
    unsure = re.search(r"expected to be (\d+ %) peak to peak \((at most \d+ %).*and (\d+ %) at constant", told)
    assert bool(unsure) == ("not known well enough" in said) == ("head=0" in link), f"{said}\n{told}"
    for part in unsure.groups() if unsure else ():
        assert part in said, f"{said}\n{told}"


def test_each_roller_is_drawn_at_its_angle(demo):
    page = demo("#angle=30", reduced_motion="reduce")
    page.evaluate("seek(0)")
    # A roller at 0 degrees stands 120 degrees clockwise from the top, where the backplate of the paper ends.
    assert abs(turned(page) - (120 + 30)) < 0.01
    page.evaluate("seek(shown.facts.motion)")
    end = page.evaluate("degrees(shown.facts.end)")
    assert abs(turned(page) - (120 + end) % 360) < 0.05


def turned(page):
    """Return the angle by which the rotor is turned, in degrees."""
    matrix = "(rotor) => { const m = new DOMMatrix(getComputedStyle(rotor).transform); return Math.atan2(m.b, m.a); }"
    return page.locator(".rotor").evaluate(matrix) * 180 / 3.141592653589793 % 360


def test_the_demo_asks_no_server(chromium):
    context = chromium.new_context()
    asked = []
    page = context.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.goto(PAGE.as_uri())
    expect(page.locator("#ours")).to_contain_text("25.000")
    context.close()
    assert [url for url in asked if not url.startswith(("file:", "blob:", "data:"))] == []
