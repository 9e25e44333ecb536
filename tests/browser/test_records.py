"""Changes of a pump's record: a calibration, a stand that is cleared, an angle that nobody knows."""

import re

from playwright.sync_api import expect

from watching import PHONE, panel, state


def test_a_calibration_is_guided_until_it_is_in_use(laboratory, service, open_page):
    page = open_page(service.url + "/#/pump/acid", size=PHONE)
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    for weighing in range(1, 9):
        box.get_by_label("Volume").fill("25mL")
        box.get_by_role("button", name="Dose", exact=True).click()
        expect(box.get_by_role("heading", name="Step 2 of 3: wait")).to_be_visible()
        expect(box.get_by_role("heading", name="Step 3 of 3: weigh")).to_be_visible()
        box.get_by_label("Reading").fill(f"25.{30 + weighing % 3}g")
        page.keyboard.press("Enter")
        expect(box.get_by_role("heading", name="Calibration saved")).to_be_focused()
        expect(box).to_contain_text(f"Doses weighed{weighing}")
        said = box.inner_text()
        factor, revolution = (float(re.search(rf"{name}\s+([\d.]+)", said)[1]) for name in ("Factor", "Revolution"))
        order = service.get("/api/v1/orders?pump=acid&limit=1")[0]["id"]
        [made] = [one for one in service.get(f"/api/v1/orders/{order}")["reports"] if one["schema"] == "calibration/1"]
        assert factor != 1
        assert abs(revolution / (made["revolution_ml"] * factor) - 1) < 1e-3, (
            "the revolution is that of the calibration"
        )
        if "Doses use it from now on." in box.inner_text():
            break
        box.get_by_role("button", name="Weigh one more dose").click()
    page.keyboard.press("Escape")
    expect(box).to_have_count(0)
    assert 1 < weighing < 8
    assert "doses use calibration" in laboratory.run("status")
    expect(page.get_by_role("row").nth(1)).to_contain_text("calibration25 mL")
    form = page.get_by_role("form", name="Dose with acid")
    form.get_by_label("Volume").fill("5mL")
    form.get_by_role("button", name="Dose").click()
    expect(form.locator(".said")).to_have_text("Done: dose 5mL.")
    assert laboratory.log("acid")[-1]["calibration"] == weighing
    expect(page.locator("dl.facts").first).to_contain_text(f"Calibrationnumber {weighing} of ")


def test_a_reading_that_is_refused_is_said_in_plain_words(laboratory, service, open_page):
    laboratory.run("25mL")
    page = open_page(service.url + "/#/pump/acid")
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    box.get_by_role("button", name="Weigh the last dose instead").click()
    box.get_by_label("Reading").fill("1.02 pints")
    page.keyboard.press("Enter")
    expect(box.get_by_role("alert")).to_contain_text("unknown mass or volume unit `pints`")
    assert "READING" not in box.inner_text()


def test_a_reading_far_from_what_was_expected_is_taken_by_a_word_of_the_page(laboratory, service, open_page):
    laboratory.run("25mL")
    page = open_page(service.url + "/#/pump/acid")
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    box.get_by_role("button", name="Weigh the last dose instead").click()
    # A number alone is in g, as the hint says.
    box.get_by_label("Reading").fill("12.5")
    page.keyboard.press("Enter")
    word = "Use it although it is far from what was expected"
    expect(box.get_by_role("alert")).to_contain_text(f"if it is right, tick “{word}” under “More options”")
    assert "--anyway" not in box.inner_text()
    box.locator("summary").click()
    box.get_by_label(word).check()
    box.get_by_role("button", name="Calibrate", exact=True).click()
    expect(box.get_by_role("heading", name="Calibration saved")).to_be_visible()


def test_a_careless_reading_is_asked_about_and_the_calibration_before_is_used_again(laboratory, service, open_page):
    service.dose("acid", "25mL")
    service.ended("acid")
    laboratory.run("calibrate", "last", "25.31g", "--scale", "0.01g")
    laboratory.run("calibrate", "use", "1")
    service.dose("acid", "2mL")
    service.ended("acid")
    page = open_page(service.url + "/#/pump/acid", size=PHONE)
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    box.get_by_role("button", name="Weigh the last dose instead").click()
    box.get_by_label("Reading").fill("2")
    page.keyboard.press("Enter")
    expect(box.locator(".notice")).to_contain_text("Nothing is saved yet. By 2g one dose would be ±")
    assert len(service.get("/api/v1/pumps/acid/calibrations")["calibrations"]) == 1
    box.get_by_role("button", name="Save it all the same").click()
    expect(box.get_by_role("heading", name="Calibration saved")).to_be_visible()
    box.get_by_role("button", name="Use another calibration…").click()
    box = page.get_by_role("dialog", name="Calibration of acid")
    expect(box.get_by_label("Doses use")).to_have_value("1")
    box.get_by_role("button", name="Use it").click()
    expect(box).to_have_count(0)
    expect(page.locator("dl.facts").first).to_contain_text("Calibrationnumber 1 of ")
    assert service.get("/api/v1/pumps/acid/calibrations")["active"] == 1


def test_a_stand_is_cleared_by_name_and_reason(make_laboratory, open_page):
    limit = "\n[safety]\nmax_ml_per_day = 20.0\n"
    service = make_laboratory(pumps=("acid", "base"), lines={"base": limit}).serve()
    page = open_page(service.url)
    card = panel(page, "base")
    card.get_by_label("Volume").fill("50mL")
    card.get_by_role("button", name="Dose").click()
    expect(state(page, "base")).to_have_text("Stands at a limit")
    expect(page.locator("#alert")).to_contain_text("base stands at its limit of 24 h")
    card.get_by_role("button", name="Clear…").first.click()
    box = page.get_by_role("dialog", name="Clear base")
    box.get_by_label("Name of the pump").fill("acid")
    box.get_by_label("Reason").fill("the tank was changed")
    box.get_by_label("Your name").fill("Anna")
    box.get_by_role("button", name="Clear the pump").click()
    expect(box.get_by_role("alert")).to_contain_text("Type the name of this pump")
    box.get_by_label("Name of the pump").fill("base")
    page.keyboard.press("Enter")
    expect(state(page, "base")).to_have_text("Ready")
    expect(box).to_have_count(0)
    expect(card.get_by_role("alert")).to_have_count(0)
    assert service.get("/api/v1/orders?pump=base")[0]["task"] == "clear"
    order = service.get("/api/v1/orders?pump=base")[0]
    assert (order["reason"], order["by"]) == ("the tank was changed", "Anna")
    expect(page.get_by_text("base was cleared by Anna: the tank was changed")).to_be_visible()


def test_a_pump_that_was_put_to_stand_shows_the_reason(make_laboratory, open_page):
    laboratory = make_laboratory(pumps=("acid", "base"))
    page = open_page(laboratory.serve().url)
    laboratory.run("safety", "stand", "base", "--reason", "leak: water under the rack")
    expect(state(page, "base")).to_have_text("Put to stand")
    card = panel(page, "base")
    expect(card).to_contain_text("leak: water under the rack")
    card.get_by_role("button", name="Clear…").first.click()
    box = page.get_by_role("dialog", name="Clear base")
    expect(box).to_contain_text("base was ordered to stand")
    expect(box).to_contain_text("leak: water under the rack")


def test_a_pump_whose_input_is_not_well_is_not_cleared(make_laboratory, open_page):
    service = make_laboratory(more='[[service.input]]\nname = "leak"\nsilent = "10min"\n').serve()
    page = open_page(service.url)
    service.post("/api/v1/inputs/leak", {"ok": False, "reason": "water"})
    expect(state(page, "acid")).to_have_text("Put to stand")
    panel(page, "acid").get_by_role("button", name="Clear…").click()
    box = page.get_by_role("dialog", name="Clear acid")
    for label, words in (("Name of the pump", "acid"), ("Reason", "it is dry"), ("Your name", "Anna")):
        box.get_by_label(label).fill(words)
    page.keyboard.press("Enter")
    expect(box.get_by_role("alert")).to_have_text("input leak is not well: water; pump acid stands until it is")
    service.post("/api/v1/inputs/leak", {"ok": True})
    page.keyboard.press("Enter")
    expect(box).to_have_count(0)
    expect(state(page, "acid")).to_have_text("Ready")


def test_an_unknown_angle_is_shown_as_unknown(laboratory, open_page):
    laboratory.run("home", "--unknown")
    page = open_page(laboratory.serve().url)
    card = panel(page, "acid")
    expect(card.locator(".head")).to_have_accessible_name("Pump head with 3 rollers, standing; the angle is unknown")
    expect(card.locator(".roller")).to_have_count(0)
    expect(card.locator("dl.facts")).to_contain_text("Angleunknown")


def test_a_reading_is_refused_once_another_dose_came(laboratory, service, open_page):
    page = open_page(service.url + "/#/pump/acid")
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    expect(box.get_by_role("button", name="Weigh the last dose instead")).to_have_count(0)
    box.get_by_label("Volume").fill("2mL")
    box.get_by_role("button", name="Dose", exact=True).click()
    expect(box.get_by_role("heading", name="Step 3 of 3: weigh")).to_be_visible()
    laboratory.run("1.5mL", "--pump", "acid")
    expect(box.get_by_role("heading", name="another dose was made since")).to_be_focused()
    time = r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d"
    expect(box).to_contain_text(
        re.compile(rf"1\.\d+ mL delivered, {time}, done, by command\. A reading would be of both")
    )
    expect(box.get_by_label("Reading")).to_have_count(0)
    box.get_by_role("button", name="Dose again").click()
    expect(box.get_by_role("heading", name="Step 1 of 3: dose")).to_be_focused()
    box.get_by_role("button", name="Close").click()
    row = page.get_by_role("row").filter(has_text="1.5 mL")
    expect(row.get_by_role("cell").last).to_have_text("command")
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    expect(box).to_contain_text("done, by command")


def test_a_calibration_that_was_stopped_goes_on_with_the_rest_of_its_dose(service, open_page):
    page = open_page(service.url + "/#/pump/acid")
    page.get_by_role("button", name="Calibrate…").click()
    box = page.get_by_role("dialog", name="Calibrate acid")
    box.get_by_label("Volume").fill("20mL")
    box.get_by_role("button", name="Dose", exact=True).click()
    expect(box.get_by_role("heading", name="Step 2 of 3: wait")).to_be_visible()
    box.get_by_role("button", name="Stop all").click()
    expect(box.get_by_role("heading", name="the dose was not completed")).to_be_visible()
    assert "`dose" not in box.inner_text()
    expect(box.get_by_role("button", name="Accept…")).to_be_visible()
    box.get_by_role("button", name="Resume").click()
    expect(box.get_by_role("heading", name="Step 3 of 3: weigh")).to_be_visible()
    box.get_by_label("Reading").fill("20.31g")
    page.keyboard.press("Enter")
    expect(box.get_by_role("heading", name="Calibration saved")).to_be_visible()
