"""The page for everyone: by keyboard, on a phone, in light and dark, and without a barrier that axe knows."""

from playwright.sync_api import expect

from watching import inspect, live, panel, state, wait_for_dose, watch

RACK = """schema = "rack/1"
[pumps]
acid = "acid"
[[step]]
pump = "acid"
volume = "12mL"
"""
SCHEDULE = """schema = "schedule/1"
zone = "Europe/Berlin"
[[entry]]
name = "ph-down"
pump = "acid"
dose = "25mL"
at = ["06:00", "18:00"]
days = ["mon", "tue"]
missed = "once"
missed_within = "2h"
[[entry]]
name = "fill-line"
enabled = false
pump = "feed"
prime = "20mL"
at = "07:00"
"""


def test_every_view_and_dialog_suits_everyone(make_laboratory, open_page):
    limit = "\n[safety]\nmax_ml_per_day = 20.0\nvessel_ml = 1000.0\n"
    laboratory = make_laboratory(pumps=("acid", "base", "feed"), racks=RACK, lines={"base": limit})
    (laboratory.folder / "schedule.toml").write_text(SCHEDULE)
    laboratory.run("home", "--unknown", "--pump", "feed")
    service = laboratory.serve("--schedule", str(laboratory.folder / "schedule.toml"))
    page = open_page(service.url)
    found = inspect(page, "pumps at rest")
    card = panel(page, "base")
    card.get_by_label("Volume").fill("50mL")
    card.get_by_role("button", name="Dose").click()
    expect(state(page, "base")).to_have_text("Stands at a limit")
    wait_for_dose(page, service, "acid", volume="300mL")
    found += inspect(page, "pumps that move and stand")
    page.get_by_role("link", name="acid", exact=True).click()
    expect(page.locator(".wide")).to_be_visible()
    found += inspect(page, "a pump that moves")
    page.get_by_role("button", name="Stop acid").click()
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    found += inspect(page, "a pump with an unfinished dose")
    page.get_by_role("button", name="Accept…").click()
    found += inspect(page, "accept")
    page.get_by_role("dialog").get_by_role("button", name="Accept", exact=True).click()
    expect(state(page, "acid")).to_have_text("Ready")
    page.get_by_text("More options").click()
    form = page.get_by_role("form", name="Dose with acid")
    form.get_by_label("Volume").fill("3mL")
    form.get_by_role("button", name="Plan").click()
    expect(form.get_by_role("heading", name="Plan (nothing has moved)")).to_be_visible()
    found += inspect(page, "a plan")
    page.get_by_role("button", name="Vessel emptied…").click()
    found += inspect(page, "vessel emptied")
    page.keyboard.press("Escape")
    found += calibration(page)
    for view in ("Log", "Schedule"):
        page.get_by_role("link", name=view).click()
        expect(page.get_by_role("table").first).to_be_visible()
        found += inspect(page, view)
    page.get_by_role("link", name="Pumps", exact=True).click()
    page.get_by_role("button", name="Clear…").first.click()
    found += inspect(page, "clear")
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    page.get_by_role("button", name="Run rack mix").click()
    found += inspect(page, "run a rack")
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    page.goto(f"{service.url}/#/pump/none")
    expect(page.get_by_role("heading", name="No such pump")).to_be_visible()
    found += inspect(page, "no such pump")
    page.goto(f"{service.url}/#/")
    service.kill()
    page.locator("#stop").click()
    expect(page.locator("#stop-said")).to_contain_text("NOT stopped")
    found += inspect(page, "a lost service")
    assert not found, "\n".join(found)


def calibration(page):
    """Inspect the steps of a guided calibration."""
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    found = inspect(page, "calibrate, step 1")
    box.get_by_label("Volume").fill("20mL")
    box.get_by_role("button", name="Dose", exact=True).click()
    expect(box.get_by_role("heading", name="Step 2 of 3: wait")).to_be_visible()
    found += inspect(page, "calibrate, step 2")
    expect(box.get_by_role("heading", name="Step 3 of 3: weigh")).to_be_visible()
    found += inspect(page, "calibrate, step 3")
    box.get_by_label("Reading").fill("20.31g")
    page.keyboard.press("Enter")
    expect(box.get_by_role("heading", name="Calibration saved")).to_be_visible()
    found += inspect(page, "calibration kept")
    box.get_by_role("button", name="Use another calibration…").click()
    expect(page.get_by_role("option", name="number 1 of")).to_have_count(1)
    found += inspect(page, "another calibration")
    page.keyboard.press("Escape")
    return found


def test_the_keyboard_alone_doses_and_stops(service, open_page):
    page = open_page(service.url)
    active = "document.activeElement"
    page.keyboard.press("Tab")
    assert page.evaluate(f"{active}.textContent") == "Skip to the pumps"
    page.keyboard.press("Enter")
    assert page.evaluate(f"{active}.id") == "main"
    for _ in range(3):
        page.keyboard.press("Tab")
        if page.evaluate(f"{active}.tagName") == "INPUT":
            break
    page.keyboard.type("30mL")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(state(page, "acid")).to_have_text("Dosing")
    page.keyboard.press("Tab")
    assert page.evaluate(f"{active}.textContent") == "Stop acid"
    page.keyboard.press("Space")
    expect(state(page, "acid")).to_have_text("A dose is unfinished")


def test_a_dialog_closes_with_its_view(service, open_page):
    page = open_page(service.url + "/#/pump/acid")
    page.get_by_role("button", name="Calibrate…").click()
    expect(page.get_by_role("dialog")).to_be_visible()
    page.evaluate("location.hash = '#/log'")
    expect(page.get_by_role("heading", name="Log")).to_be_focused()
    expect(page.get_by_role("dialog")).to_have_count(0)


def test_a_page_without_its_script_says_what_works(service, chromium):
    page = watch(chromium, service.url, java_script_enabled=False)
    expect(page.locator("noscript p")).to_contain_text("The command dose works without it.")
    page.context.close()


def test_a_later_view_is_reached_by_its_address(service, open_page):
    page = open_page(service.url + "/#/log")
    expect(page.get_by_role("heading", name="Log")).to_be_visible()
    page.reload()
    expect(live(page).get_by_role("heading", name="Log")).to_be_visible()
