"""Doses from the page: to their report, planned, refused, over a network that loses answers."""

import json
import math
import re

from playwright.sync_api import expect

from watching import PHONE, angle, panel, state, turns


def test_a_dose_runs_to_its_report_and_two_watchers_see_the_same(laboratory, service, open_page):
    pages = [open_page(service.url), open_page(service.url, size=PHONE)]
    card = panel(pages[0], "acid")
    card.get_by_label("Volume").fill("15")
    card.get_by_role("button", name="Dose").click()
    for page in pages:
        expect(state(page, "acid")).to_have_text("Dosing")
        turns(page, "acid")
    expect(card.locator(".said")).to_have_text("Done: dose 15mL.")
    for page in pages:
        expect(state(page, "acid")).to_have_text("Ready")
        expect(panel(page, "acid").locator(".read .what")).to_contain_text("last dose: 15 mL requested, ±")
    report = laboratory.log("acid")[-1]
    figures = [panel(page, "acid").locator(".big").inner_text() for page in pages]
    assert figures[0] == figures[1]
    assert abs(float(figures[0].removesuffix(" mL")) - report["delivered_ml"]) < 0.06, "the page tells the record"
    pages[0].wait_for_timeout(800)
    assert pages[0].evaluate("document.getAnimations().length") == 0, "nothing is animated while nothing turns"
    view = service.view("acid")
    for page in pages:
        # The rollers stand where the record says, but for whole pitches.
        off = (angle(page, "acid") - view["status"]["angle_deg"]) % view["pitch_deg"]
        assert min(off, view["pitch_deg"] - off) < 0.1


def test_the_options_of_a_dose_are_those_that_were_typed(laboratory, service, open_page):
    page = open_page(service.url + "/#/pump/acid")
    form = page.get_by_role("form", name="Dose with acid")
    form.get_by_text("More options").click()
    typed = {"Volume": "12", "Rate": "2.5", "Retract": "0.1", "Temperature": "20degC", "Fluid": "water"}
    for label, value in typed.items():
        form.get_by_label(label, exact=True).fill(value)
    form.get_by_label("Smooth flow").check()
    form.get_by_role("button", name="Plan").click()
    expect(form.get_by_role("heading", name="Plan (nothing has moved)")).to_be_focused()
    expect(form).to_contain_text("±")
    assert laboratory.log("acid") == [], "a plan moves nothing"
    order = service.get("/api/v1/orders")[0]
    options = {"rate": "2.5mL/s", "retract": "0.1mL", "temperature": "20degC", "fluid": "water", "smooth": True}
    assert order["options"] == options | {"dry-run": True}
    assert order["volume"] == "12mL"
    # Advice names the page's button in place of a command.
    form.get_by_label("Rate", exact=True).fill("0.05")
    form.get_by_label("Fluid", exact=True).fill("glycerol 90%")
    form.get_by_role("button", name="Plan").click()
    expect(form.locator(".plan li").last).to_contain_text("“Calibrate…” weighs")
    assert "dose calibrate" not in form.inner_text()


def test_what_the_command_refuses_is_said_beside_the_form(service, open_page):
    page = open_page(service.url)
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("5 gallons")
    card.get_by_role("button", name="Dose").click()
    expect(card.get_by_role("alert")).to_contain_text("gallons")
    card.get_by_label("Volume").fill("")
    card.get_by_role("button", name="Dose").click()
    expect(card.get_by_role("alert")).to_have_text("Enter a volume, such as 25mL.")
    expect(card.get_by_label("Volume")).to_be_focused()


LIMIT = "\n[safety]\nmax_ml_per_day = 45.0\n"


def test_a_plan_beyond_a_limit_says_that_the_pump_does_not_stand(make_laboratory, open_page):
    page = open_page(make_laboratory(lines={"acid": LIMIT}).serve().url)
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("20L")
    page.keyboard.press("Enter")
    told = card.get_by_role("alert")
    expect(told).to_contain_text("would stand at a safety limit")
    expect(told).to_contain_text("nothing has moved, and the pump does not stand for this plan")
    page.wait_for_timeout(500)
    expect(told).to_be_visible()
    expect(state(page, "acid")).to_have_text("Ready")
    expect(card.get_by_role("button", name="Clear…")).to_have_count(0)


def test_the_message_of_a_refusal_stays_while_its_reason_does(make_laboratory, open_page):
    service = make_laboratory(lines={"acid": LIMIT}).serve()
    page = open_page(service.url)
    card = panel(page, "acid")
    told = card.locator(".said").get_by_role("alert")
    # The record tells of the stand now before the answer, now after it.
    for _ in range(6):
        card.get_by_label("Volume").fill("90mL")
        page.keyboard.press("Enter")
        expect(told).to_contain_text("acid stands at a safety limit")
        assert "`dose" not in told.inner_text(), "the page has its own words"
        page.wait_for_timeout(300)
        expect(told).to_be_visible()
        service.post("/api/v1/pumps/acid/clear", {"reason": "looked", "by": "Ada"})
        expect(told).to_have_count(0)


def test_a_refusal_of_a_pump_in_use_goes_with_the_motion(service, open_page):
    page = open_page(service.url)
    service.dose("acid", "200mL")
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("1mL")
    card.get_by_role("button", name="Dose").click()
    expect(card.get_by_role("alert")).to_have_text(
        "In use: pump acid is dosing 200mL (by http); wait until it is done, or stop it"
    )
    service.stop()
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    expect(card.get_by_role("alert")).to_have_count(0)


def test_a_refusal_goes_once_the_dose_that_it_names_is_resumed(service, open_page):
    page = open_page(service.url)
    service.dose("acid", "20mL", rate="4mL/s")
    service.stop()
    card = panel(page, "acid")
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    card.get_by_label("Volume").fill("1mL")
    card.get_by_role("button", name="Dose").click()
    expect(card.locator(".said").get_by_role("alert")).to_contain_text("unfinished")
    card.locator(".notices").get_by_role("button", name="Resume").click()
    expect(state(page, "acid")).to_have_text("Delivering the rest of a dose")
    expect(card.get_by_role("alert")).to_have_count(0)
    expect(state(page, "acid")).to_have_text("Ready")
    expect(card.get_by_role("alert")).to_have_count(0)
    # A refusal of another kind goes too, once the pump moves for anybody.
    card.get_by_label("Volume").fill("1 furlong")
    card.get_by_role("button", name="Dose").click()
    expect(card.get_by_role("alert")).to_have_count(1)
    service.dose("acid", "2mL")
    expect(card.get_by_role("alert")).to_have_count(0)


def test_the_limits_count_while_the_pump_moves(make_laboratory, open_page):
    laboratory = make_laboratory(lines={"acid": LIMIT})
    service = laboratory.serve()
    page = open_page(service.url, size={"width": 360, "height": 740})
    service.dose("acid", "20mL", rate="2mL/s")
    facts = panel(page, "acid").locator("dl.facts")
    expect(facts).to_contain_text(re.compile(r"Last 24 h[1-9][\d.]* mL pumped, [\d.]+ mL left of 45 mL"))
    expect(facts).to_contain_text(re.compile(r"Under wayup to 1[\d.]+ mL more"))
    assert ", up to 1" in laboratory.run("safety", "--pump", "acid"), "the command tells the same"
    service.stop()
    expect(facts).not_to_contain_text("Under way")


def test_a_card_asks_before_a_dose_in_reverse(laboratory, service, open_page):
    page = open_page(service.url)
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("-2")
    page.keyboard.press("Enter")
    expect(card.locator(".notice")).to_contain_text("in reverse. Nothing moves yet.")
    assert laboratory.log("acid") == []
    card.get_by_role("button", name="Dose in reverse").click()
    expect(card.locator(".said")).to_have_text("Done: dose -2mL.")


def test_a_run_until_it_is_stopped_shows_no_end(service, open_page):
    page = open_page(service.url + "/#/pump/acid")
    form = page.get_by_role("form", name="Run: acid")
    form.get_by_label("Rate").fill("1")
    form.get_by_role("button", name="Run").click()
    expect(state(page, "acid")).to_have_text("Running")
    below = page.locator(".read .what")
    expect(below).to_have_text("so far")
    assert not page.locator(".read .time").is_visible()
    service.stop()
    expect(below).to_contain_text("last run: until stopped, ±")


def test_a_lost_answer_doses_once(laboratory, service, make_network, open_page):
    network = make_network(service)
    page = open_page(network.url)
    network.answers_to_lose = 2
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("3")
    page.keyboard.press("Enter")
    expect(card.locator(".said")).to_have_text("Done: dose 3mL.")
    assert len(network.orders) == 3
    assert len({key for _, key, _ in network.orders}) == 1, "the same key asks again"
    assert len(laboratory.log("acid")) == 1
    card.get_by_role("button", name="Dose").click()
    expect(state(page, "acid")).to_have_text("Dosing")
    expect(card.locator(".said")).to_have_text("Done: dose 3mL.")
    assert len(laboratory.log("acid")) == 2, "the same words, typed again, are another dose"


def test_a_form_keeps_its_words_while_others_dose(service, make_network, open_page):
    network = make_network(service)
    page = open_page(network.url)
    volume = panel(page, "acid").get_by_label("Volume")
    volume.fill("12.")
    service.dose("acid", "10mL")
    expect(state(page, "acid")).to_have_text("Dosing")
    network.has_events = False
    expect(page.locator("#link")).to_contain_text("Reconnecting")
    network.has_events = True
    expect(page.locator("#link")).to_have_text("Live")
    expect(state(page, "acid")).to_have_text("Ready")
    expect(volume).to_have_value("12.")
    expect(volume).to_be_focused()


def test_an_order_that_ends_unheard_is_told_once_the_page_hears_again(service, make_network, open_page):
    network = make_network(service)
    page = open_page(network.url)
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("10mL")
    page.keyboard.press("Enter")
    expect(card.locator(".said")).to_have_text("The service has the order: dose 10mL.")
    network.has_events = False
    expect(page.locator("#alert")).to_contain_text("Connection lost")
    service.ended("acid")
    network.has_events = True
    expect(card.locator(".said")).to_have_text("Done: dose 10mL.")
    expect(page.locator("#alert")).to_have_text("")


def test_a_dose_says_when_it_ends_and_one_of_hours_is_asked_about(laboratory, service, open_page):
    page = open_page(service.url)
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("20L")
    page.keyboard.press("Enter")
    expect(card.locator(".said")).to_contain_text("This takes 1 h 7 min, until ")
    assert laboratory.log("acid") == []
    assert not service.view("acid")["order"], "nothing moves before the second answer"
    expect(card.get_by_role("button", name="Dose for 1 h 7 min")).to_be_focused()
    page.keyboard.press("Enter")
    expect(state(page, "acid")).to_have_text("Dosing")
    expect(card.locator(".read .time")).to_have_text(
        re.compile(r"^ends (\d{4}-\d\d-\d\d )?\d\d:\d\d, 1 h \d min left$")
    )
    service.stop()
    expect(card.locator(".read .time")).to_be_hidden()


def test_a_volume_has_the_digits_of_its_uncertainty(laboratory, service, open_page):
    page = open_page(service.url)
    card = panel(page, "acid")
    card.get_by_label("Volume").fill("0.0015")
    page.keyboard.press("Enter")
    expect(card.locator(".said")).to_have_text("Done: dose 0.0015mL.")
    dose = laboratory.log("acid")[-1]
    digits = 1 - math.floor(math.log10(dose["expanded_uncertainty_ml"]))
    expect(card.locator(".big")).to_have_text(f"{dose['delivered_ml']:.{digits}f} mL")
    expect(card.locator(".what").last).to_contain_text(f"±\u00a0{dose['expanded_uncertainty_ml']:.{digits}f}\u00a0mL")


def test_a_rack_is_planned_and_run(make_laboratory, open_page):
    rack = """schema = "rack/1"
[pumps]
acid = "acid"
base = "base"
[[step]]
ratio = { acid = 2, base = 1 }
volume = "24mL"
rate = "6mL/s"
"""
    service = make_laboratory(pumps=("acid", "base"), racks=rack).serve()
    page = open_page(service.url)
    page.get_by_role("button", name="Plan rack mix").click()
    expect(page.get_by_role("heading", name="Plan (nothing has moved)")).to_be_visible()
    page.get_by_role("button", name="Run rack mix").click()
    page.get_by_role("dialog").get_by_role("button", name="Run the rack").click()
    for pump in ("acid", "base"):
        expect(state(page, pump)).to_have_text("Running in a rack")
    for pump, volume in (("acid", "16 mL (24mL, 2 of 3)"), ("base", "8 mL (24mL, 1 of 3)")):
        expect(state(page, pump)).to_have_text("Ready")
        expect(panel(page, pump).locator(".read .what")).to_contain_text(f"{volume} requested")


def test_a_head_stands_for_who_wants_no_motion(service, open_page):
    page = open_page(service.url, reduced_motion="reduce")
    service.dose("acid", "40mL")
    expect(state(page, "acid")).to_have_text("Dosing")
    figure = panel(page, "acid").locator(".big")
    turned, number = angle(page, "acid"), figure.inner_text()
    page.wait_for_timeout(600)
    assert angle(page, "acid") == turned
    assert figure.inner_text() != number


def test_the_log_has_all_pumps_together_and_who_accepted_a_dose(make_laboratory, open_page):
    service = make_laboratory(pumps=("acid", "base")).serve()
    page = open_page(service.url + "/#/log")
    service.dose("base", "20mL", rate="4mL/s")
    service.stop()
    service.post("/api/v1/pumps/base/accept")
    service.ended("base")
    service.ended(service.dose("acid", "2mL") and "acid")
    rows = page.get_by_role("table").first.get_by_role("row")
    expect(rows).to_have_count(3)
    expect(rows.nth(1).get_by_role("cell").first).to_have_text("acid")
    expect(rows.nth(2)).to_contain_text("; accepted by HTTP")
    expect(page.locator("main")).to_contain_text("the interrupted dose of base was accepted, by http")
    expect(page.get_by_role("link", name="Export CSV")).to_have_count(0)
    page.get_by_label("Pump").select_option("base")
    expect(rows).to_have_count(2)
    expect(page.get_by_role("link", name="Export CSV")).to_be_visible()


def test_the_log_has_the_doses_and_their_export(laboratory, service, open_page):
    page = open_page(service.url)
    panel(page, "acid").get_by_label("Volume").fill("2mL")
    page.keyboard.press("Enter")
    expect(panel(page, "acid").locator(".said")).to_have_text("Done: dose 2mL.")
    page.get_by_role("link", name="Log").click()
    expect(page.get_by_role("heading", name="Log")).to_be_focused()
    expect(page.get_by_role("table").first.get_by_role("row")).to_have_count(2)
    for name, begins in (("Export CSV", "number,time,"), ("Export JSON", "{")):
        with page.expect_download() as download:
            page.get_by_role("link", name=name).click()
        text = download.value.path().read_text()
        assert text.startswith(begins), text[:200]
    assert json.loads(text) == laboratory.log("acid")[0] | {"origin": "page", "weighed": False, "accepted": None}
    # A dose that ends elsewhere is there without a reload.
    service.ended(service.dose("acid", "3mL") and "acid")
    expect(page.get_by_role("table").first.get_by_role("row")).to_have_count(3)
    laboratory.run("1mL", "--no-service")
    expect(page.get_by_role("table").first.get_by_role("row")).to_have_count(4)
    page.go_back()
    expect(panel(page, "acid")).to_be_visible()
