"""A service that is killed, and one that begins again."""

import re

from playwright.sync_api import expect

from watching import live, panel, state, wait_for_dose


def test_a_page_comes_back_after_a_kill_and_resumes_the_dose(laboratory, service, open_page):
    page = open_page(service.url)
    wait_for_dose(page, service, "acid", volume="40mL")
    page.wait_for_timeout(1000)
    service.kill()
    expect(page.locator("#link")).to_contain_text("Reconnecting… Values as of ")
    again = laboratory.serve_again(service)
    live(page)
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    expect(page.locator("main")).to_contain_text("the service ended before order")
    panel(page, "acid").get_by_role("button", name="Resume").click()
    expect(state(page, "acid")).to_have_text("Delivering the rest of a dose")
    expect(state(page, "acid")).to_have_text("Ready")
    first, rest = laboratory.log("acid")[-2:]
    assert rest["resumed"]
    read = panel(page, "acid").locator(".read")
    expect(read.locator(".what")).to_contain_text(
        re.compile(r"^last dose: 40 mL requested, .* mL before and [\d.]+ mL now")
    )
    assert abs(float(read.locator(".big span").inner_text()) - 40) < 0.5, "the whole dose"
    assert abs(first["delivered_ml"] + rest["delivered_ml"] - 40) < 0.5
    assert again.view("acid")["status"]["unfinished"] is None


def test_an_unfinished_dose_is_accepted(service, open_page):
    page = open_page(service.url + "/#/pump/acid")
    wait_for_dose(page, service, "acid")
    page.get_by_role("button", name="Stop acid").click()
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    page.get_by_role("button", name="Accept…").click()
    page.get_by_role("dialog").get_by_role("button", name="Accept", exact=True).click()
    expect(state(page, "acid")).to_have_text("Ready")
    expect(page.get_by_role("dialog")).to_have_count(0)


def test_the_dialog_accepts_the_dose_that_it_was_opened_for_alone(service, open_page):
    page = open_page(service.url)
    service.dose("acid", "60mL", rate="5mL/s")
    service.post("/api/v1/pumps/acid/stop")
    page.get_by_role("button", name="Accept…").click()
    box = page.get_by_role("dialog")
    expect(box).to_contain_text(re.compile(r"[\d.]+ mL delivered of 60 mL requested; unfinished; begun \d{4}-"))
    # Another watcher resumes it to its end, and has another dose stopped.
    service.post("/api/v1/pumps/acid/resume", {"options": {"rate": "max"}})
    service.ended("acid")
    service.dose("acid", "40mL", rate="5mL/s")
    service.post("/api/v1/pumps/acid/stop")
    service.ended("acid")
    expect(box).to_contain_text("This dose is not unfinished any more")
    expect(box.get_by_role("button", name="Accept", exact=True)).to_have_count(0)
    assert service.view("acid")["status"]["unfinished"]["requested_ml"] == 40


def test_a_refusal_goes_with_its_cause(service, open_page):
    page = open_page(service.url)
    form = page.get_by_role("form", name="Dose with acid")
    for volume in ("60mL", "2mL"):
        form.get_by_label("Volume").fill(volume)
        form.get_by_role("button", name="Dose").click()
        expect(state(page, "acid")).to_have_text("Dosing")
    expect(form.locator(".said")).to_contain_text("In use: pump acid is dosing 60mL")
    page.get_by_role("button", name="Stop acid").click()
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    expect(form.locator(".said")).to_have_text("")
