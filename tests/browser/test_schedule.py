"""The schedule is seen and edited at the page."""

import json
import re

import pytest
from playwright.sync_api import expect

from watching import SMALL, inspect

HEAD = """# Anna's doses.
schema = "schedule/1"
zone = "Europe/Berlin"
"""
FEED = """
[[entry]]  # by day
name = "feed"
pump = "acid"
dose = "1.5mL"     # as the sheet says
every = "30min"
between = ["08:00", "20:00"]
options = { rate = "0.5mL/s", smooth = true }
busy = "wait"
"""
SAVE = re.compile("Show the next runs|Save")


@pytest.fixture
def plan(laboratory):
    """Have the file of a schedule with one entry."""
    file = laboratory.folder / "schedule.toml"
    file.write_text(HEAD + FEED)
    return file


@pytest.fixture
def page(laboratory, plan, open_page):
    """Have the view of the schedule."""
    page = open_page(laboratory.serve("--schedule", str(plan)).url + "/#/schedule")
    expect(page.get_by_role("row")).to_have_count(2)
    return page


def press_tab_to(page, label):
    """Press Tab until the field of this label has the focus."""
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.get_by_role("dialog").get_by_label(label, exact=True).evaluate("(el) => el === document.activeElement"):
            return
    raise AssertionError(f"Tab leads to {label}")


def test_the_keyboard_adds_an_entry_sees_its_next_runs_and_removes_it(page, plan):
    page.get_by_role("button", name="Add an entry…").focus()
    page.keyboard.press("Enter")
    box = page.get_by_role("dialog", name="Add an entry")
    for label, words in (("Name", "night"), ("Volume", "2"), ("Times of day", "22:00, 25:00")):
        press_tab_to(page, label)
        page.keyboard.type(words)
    press_tab_to(page, "mon")
    page.keyboard.press("Space")
    box.get_by_label("Times of day").focus()
    page.keyboard.press("Enter")
    refused = box.get_by_role("alert")
    expect(refused).to_have_text(
        re.compile(r"^entry `night` of the schedule, at is `25:00`; allowed: 00:00 to 23:59:59")
    )
    field = box.get_by_label("Times of day")
    expect(field).to_be_focused()
    expect(field).to_have_attribute("aria-invalid", "true")
    found = inspect(page, "an entry that is refused")
    page.keyboard.press("Control+a")
    page.keyboard.type("22:00")
    page.keyboard.press("Enter")
    expect(box.get_by_role("heading", name="Next runs")).to_be_visible()
    expect(box.locator("ol li")).to_have_count(3)
    expect(refused).to_have_count(0)
    assert plan.read_text() == HEAD + FEED, "nothing is saved before it is seen"
    found += inspect(page, "an entry with its next runs")
    expect(box.get_by_role("button", name=SAVE)).to_have_text("Save")
    page.keyboard.press("Enter")
    expect(box).to_have_count(0)
    expect(page.get_by_role("row", name="night")).to_contain_text("at 22:00 on mon (Europe/Berlin)")
    night = '\n[[entry]]\nname = "night"\npump = "acid"\ndose = "2mL"\nat = ["22:00"]\ndays = ["mon"]\n'
    assert plan.read_text() == HEAD + FEED + night

    page.get_by_role("button", name="Edit… night").focus()
    page.keyboard.press("Enter")
    box = page.get_by_role("dialog", name="Edit night")
    box.get_by_role("button", name="Remove…").focus()
    page.keyboard.press("Enter")
    expect(box.get_by_role("button", name="Remove night")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("row")).to_have_count(2)
    expect(page.get_by_role("heading", name="Schedule")).to_be_focused()
    assert plan.read_text() == HEAD + FEED
    assert not found, "\n".join(found)


def test_the_form_is_saved_without_a_scroll_on_a_small_phone(page, plan):
    page.set_viewport_size(SMALL)
    page.get_by_role("button", name="Edit… feed").click()
    box = page.get_by_role("dialog", name="Edit feed")
    box.get_by_label("Volume").fill("2mL")
    box.get_by_role("button", name="Show the next runs").click(position={"x": 5, "y": 5})
    expect(box.get_by_role("heading", name="Next runs")).to_be_in_viewport()
    save = box.get_by_role("button", name="Save")
    expect(save).to_be_in_viewport(ratio=1)
    box.evaluate("(box) => box.scrollTo(0, 0)")
    expect(save).to_be_in_viewport(ratio=1)
    save.click()
    expect(box).to_have_count(0)
    assert 'dose = "2mL"' in plan.read_text()


def test_the_form_names_the_clock_of_its_times_and_asks_for_a_name(laboratory, plan, open_page):
    service = laboratory.serve("--schedule", str(plan))
    page = open_page(service.url + "/#/schedule", timezone_id="America/New_York")
    page.get_by_role("button", name="Add an entry…").click()
    box = page.get_by_role("dialog", name="Add an entry")
    expect(box).to_contain_text("Times are by the clock of Europe/Berlin.")
    for label, words in (("Volume", "2"), ("Times of day", "12:00"), ("Dates, in place of days", "2030-01-09")):
        if label.startswith("Dates"):
            box.locator("summary").click()
        box.get_by_label(label, exact=True).fill(words)
    page.keyboard.press("Enter")
    refused = box.get_by_role("alert")
    expect(refused).to_contain_text("name is missing; allowed: 1 to 64 of a-z")
    assert "quotes" not in refused.inner_text()
    expect(box.get_by_label("Name", exact=True)).to_be_focused()
    page.keyboard.type("noon")
    page.keyboard.press("Enter")
    expect(box.locator("ol li")).to_have_text("2030-01-09 12:00:00, here 2030-01-09 06:00:00")
    expect(box).to_contain_text("By the clock of Europe/Berlin; here is America/New_York.")
    box.get_by_label("Time zone").fill("Asia/Kathmandu")
    expect(box).to_contain_text("Times are by the clock of Asia/Kathmandu.")
    page.keyboard.press("Enter")
    expect(box.locator("ol li")).to_have_text("2030-01-09 12:00:00, here 2030-01-09 01:15:00")


def test_the_form_has_every_key_of_an_entry_and_changes_what_was_changed(page, plan):
    page.get_by_role("button", name="Edit… feed").click()
    box = page.get_by_role("dialog", name="Edit feed")
    expect(box.get_by_label("Options")).to_have_value("rate=0.5mL/s, smooth")
    box.get_by_role("button", name=SAVE).click()
    expect(box.locator("ol li")).to_have_count(3)
    box.get_by_role("button", name=SAVE).click()
    expect(box).to_have_count(0)
    assert plan.read_text() == HEAD + FEED, "an entry that was not changed is written as it was"

    page.get_by_role("button", name="Edit… feed").click()
    box.get_by_label("Volume").fill("3mL")
    box.get_by_label("When").select_option("every so often from a moment on")
    box.get_by_label("Every", exact=True).fill("8h")
    box.get_by_label("First run").fill("2026-03-01 06:00")
    box.get_by_text("More options").click()
    typed = {
        "First date": "2026-03-01",
        "Last date": "2199-05-31",
        "Time zone": "UTC",
        "Number of doses": "20",
        "One every": "30s",
        "Options": "smooth, rate 0.4mL/s",
    }
    for label, words in typed.items():
        box.get_by_label(label, exact=True).fill(words)
    box.get_by_label("Missed runs").select_option("are all made up for")
    box.get_by_label("At most so late").fill("2h")
    box.get_by_label("An interrupted dose").select_option("is delivered first")
    box.get_by_label("A pump that moves").select_option("has the run left out")
    box.get_by_role("button", name=SAVE).click()
    expect(box.locator("ol li")).to_have_count(3)
    box.get_by_role("button", name=SAVE).click()
    expect(box).to_have_count(0)
    kept = '\n[[entry]]  # by day\nname = "feed"\npump = "acid"\ndose = "3mL"     # as the sheet says\nevery = "8h"\n'
    text = plan.read_text()
    assert text.startswith(HEAD + kept)
    rest = set(text.removeprefix(HEAD + kept).splitlines())
    assert rest == {
        'options = { rate = "0.4mL/s", smooth = true }',
        'batch = { every = "30s", repeat = 20 }',
        'anchor = "2026-03-01 06:00"',
        'from = "2026-03-01"',
        'until = "2199-05-31"',
        'zone = "UTC"',
        'missed = "all"',
        'missed_within = "2h"',
        'unfinished = "resume"',
    }
    expect(page.get_by_role("row", name="feed")).to_contain_text("counted from 2026-03-01 06:00")


def test_an_entry_is_switched_off_and_on_and_the_button_keeps_the_focus(page, plan):
    page.get_by_role("button", name="Switch off feed").press("Enter")
    expect(page.get_by_role("row", name="feed")).to_contain_text("switched off")
    assert plan.read_text() == HEAD + FEED + "enabled = false\n"
    expect(page.get_by_role("button", name="Switch on feed")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Switch off feed")).to_be_focused()
    assert plan.read_text() == HEAD + FEED


def test_a_file_that_has_changed_meanwhile_is_not_overwritten(page, plan):
    page.get_by_role("button", name="Edit… feed").click()
    box = page.get_by_role("dialog", name="Edit feed")
    box.get_by_label("Volume").fill("3mL")
    plan.write_text(HEAD + "# By hand.\n" + FEED)
    box.get_by_role("button", name=SAVE).click()
    expect(box.get_by_role("alert")).to_contain_text("the schedule has changed since it was read")
    assert plan.read_text() == HEAD + "# By hand.\n" + FEED
    for words in ("Save", ""):
        box.get_by_role("button", name=SAVE).click()
        if words:
            expect(box.get_by_role("button", name=SAVE)).to_have_text(words)
    expect(box).to_have_count(0)
    assert plan.read_text() == HEAD + "# By hand.\n" + FEED.replace("1.5mL", "3mL"), "what was typed was kept"


def test_an_entry_that_would_be_refused_is_red_with_its_reason(page):
    def doubted(asked):
        told = asked.fetch().json()
        told["next"][0]["doubt"] = "there is no pump `acid`"
        asked.fulfill(body=json.dumps(told))

    page.route("**/api/v1/schedule", doubted)
    page.reload()
    row = page.get_by_role("row", name="feed")
    expect(row).to_contain_text("feed: its runs will be refused: there is no pump `acid`")
    expect(row).to_have_class("bad")
    found = inspect(page, "a doubted entry")
    assert not found, "\n".join(found)


def test_the_inputs_of_the_guard_are_listed_with_their_last_word(make_laboratory, open_page):
    guard = '[service]\n[[service.input]]\nname = "level"\nsilent = "1s"\npumps = ["acid"]\n'
    guard += '[[service.input]]\nname = "leak"\nsilent = "1h"\n'
    service = make_laboratory(pumps=("acid", "base"), more=guard).serve()
    service.post("/api/v1/inputs/leak", {"ok": True})
    page = open_page(service.url)
    leak = page.get_by_role("row", name="leak")
    expect(leak).to_contain_text(re.compile(r"alive: all is well.*\d+ s ago.*acid, base"))
    level = page.get_by_role("row", name="level")
    expect(level).to_contain_text("silent")
    expect(level).to_have_class("bad")
    found = inspect(page, "the guard")
    service.post("/api/v1/inputs/leak", {"ok": False, "reason": "water under the rack"})
    expect(leak).to_contain_text("not well: water under the rack")
    assert not found, "\n".join(found)
