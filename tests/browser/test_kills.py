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
        re.compile(r"^last dose: 40 mL asked, .* mL before and [\d.]+ mL now")
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
