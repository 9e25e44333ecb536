"""Every stop of the page, over a good network and a bad one."""

import os
import re
import signal

import pytest
from playwright.sync_api import expect

from laboratory import wait_for
from watching import PHONE, live, state, wait_for_dose

# In the page, from the event of the mouse to the request, and to its answer.
WATCH_STOP = """() => {
  addEventListener('pointerdown', (event) => { window.pressed = event.timeStamp; }, true);
  addEventListener('keydown', (event) => { window.pressed = event.timeStamp; }, true);
}"""
STOP_TIMES = """() => {
  const [stop] = performance.getEntriesByType('resource').filter((one) => one.name.endsWith('/api/v1/stop'));
  return stop && stop.responseEnd ? [stop.startTime - window.pressed, stop.responseEnd - window.pressed] : null;
}"""


@pytest.mark.parametrize("how", ["button", "keys"])
def test_all_pumps_stop_at_one_press(how, service, open_page, capsys):
    page = open_page(service.url)
    page.evaluate(WATCH_STOP)
    sent = []
    page.on("request", lambda asked: sent.append(asked.url) if asked.url.endswith("/api/v1/stop") else None)
    wait_for_dose(page, service, "acid")
    if how == "button":
        # The stop acts when it is pressed, not when it is let go.
        page.locator("#stop").hover()
        page.mouse.down()
    else:
        page.keyboard.press("Escape")
        page.keyboard.press("Escape")
    expect(page.locator("#stop-said")).to_have_text("Stopped 1 order.")
    expect(state(page, "acid")).to_have_text("A dose is unfinished", timeout=5000)
    page.mouse.up()
    page.wait_for_timeout(100)
    assert len(sent) == 1, "one press is one stop"
    asked_ms, answered_ms = page.evaluate(STOP_TIMES)
    with capsys.disabled():
        print(f"\n  stop by {how}: asked for after {asked_ms:.0f} ms, answered after {answered_ms:.0f} ms")
    assert asked_ms < 200


def test_one_pump_stops_alone(make_laboratory, open_page):
    service = make_laboratory(pumps=("acid", "base")).serve()
    page = open_page(service.url)
    for pump in ("acid", "base"):
        wait_for_dose(page, service, pump)
    page.get_by_role("button", name="Stop acid").click()
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    expect(state(page, "base")).to_have_text("Dosing")


def test_a_stop_leads_to_the_rest_of_the_dose(service, open_page):
    page = open_page(service.url + "/#/pump/acid", size=PHONE)
    form = page.get_by_role("form", name="Dose with acid")
    form.get_by_label("Volume").fill("60mL")
    page.keyboard.press("Enter")
    expect(state(page, "acid")).to_have_text("Dosing")
    page.wait_for_timeout(500)
    page.locator("#stop").click()
    expect(form.locator(".said")).to_have_text(re.compile(r"^Stopped: dose 60mL; [\d.]+ mL delivered\.$"))
    resume = page.locator(".notices").get_by_role("button", name="Resume")
    expect(resume).to_be_in_viewport()
    named = page.locator(".notices p").first.inner_text()
    page.wait_for_timeout(1000)
    resume.click()
    expect(state(page, "acid")).to_have_text("Delivering the rest of a dose")
    expect(form.locator(".said")).to_have_text("")
    expect(page.locator(".read .what")).to_contain_text(
        re.compile(r"^of 60 mL requested.* at the end; [\d.]+ mL before$")
    )
    page.locator("#stop").click()
    # The dose has the time of its order, not that of its rest.
    expect(page.locator(".notices p").first).to_have_text(named)


def test_all_pumps_stop_at_a_tap(service, open_page):
    page = open_page(service.url, size=PHONE, has_touch=True)
    wait_for_dose(page, service, "acid")
    page.locator("#stop").tap()
    expect(page.locator("#stop-said")).to_have_text("Stopped 1 order.")
    expect(state(page, "acid")).to_have_text("A dose is unfinished")


def test_the_stop_works_while_the_events_are_lost(service, make_network, open_page):
    network = make_network(service)
    page = open_page(network.url)
    wait_for_dose(page, service, "acid")
    network.has_events = False
    expect(page.locator("#link")).to_contain_text("Reconnecting… Values as of ")
    page.locator("#stop").click()
    expect(page.locator("#stop-said")).to_have_text("Stopped 1 order.")
    wait_for("the dose to end", lambda: service.get("/api/v1/orders")[0]["state"] != "running", 5)
    network.has_events = True
    expect(state(page, "acid")).to_have_text("A dose is unfinished")


def test_a_stop_that_reaches_nobody_says_so_and_tries_again(service, make_network, open_page):
    network = make_network(service)
    page = open_page(network.url)
    wait_for_dose(page, service, "acid", volume="200mL")
    network.is_down = True
    page.locator("#stop").click()
    expect(page.locator("#stop-said")).to_contain_text("NOT stopped")
    expect(page.locator("#alert")).to_contain_text("Connection lost")
    network.is_down = False
    expect(page.locator("#stop-said")).to_have_text("Stopped 1 order.")
    expect(state(live(page), "acid")).to_have_text("A dose is unfinished")


def test_a_page_says_within_5_s_that_a_service_hangs(service, open_page):
    page = open_page(service.url)
    # A quiet service is heard all the same.
    page.wait_for_timeout(6000)
    expect(page.locator("#link")).to_have_text("Live")
    service.signal(signal.SIGSTOP)
    expect(page.locator("#link")).to_contain_text("Reconnecting", timeout=5500)
    service.signal(signal.SIGCONT)
    live(page)


def test_a_service_that_hangs_is_not_taken_for_a_stop(service, open_page):
    page = open_page(service.url)
    wait_for_dose(page, service, "acid", volume="200mL")
    service.signal(signal.SIGSTOP)
    page.locator("#stop").click()
    expect(page.locator("#stop-said")).to_contain_text("NOT stopped", timeout=8000)
    service.signal(signal.SIGCONT)
    expect(page.locator("#stop-said")).to_contain_text("Stopped 1 order.")
    expect(state(page, "acid")).to_have_text("A dose is unfinished")


def test_a_process_that_hangs_is_seen_and_a_stop_of_it_has_an_outcome(service, open_page):
    page = open_page(service.url)
    wait_for_dose(page, service, "acid", volume="200mL")
    os.kill(service.worker(), signal.SIGSTOP)
    expect(state(page, "acid")).to_have_text(re.compile(r"^No word from its worker for [5-9] s$"), timeout=9000)
    page.get_by_role("button", name="Stop acid").click()
    said = page.locator("#stop-said")
    expect(said).to_have_text("NOT stopped yet: acid. The service ends what does not answer.")
    expect(said).to_have_text("Did not answer, and was ended: acid. Look whether the motor stands.")
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
    expect(page.locator(".notices").first).to_contain_text("the service ended the process of the order")
    expect(page.locator(".read .big").first).to_have_text(re.compile(r"^[\d.]+ to [\d.]+ mL$"))
    # The log has no row of it yet, and says so.
    page.goto(service.url + "/#/log")
    expect(page.locator("main")).to_contain_text(re.compile(r"acid: cut off, [\d.]+ to [\d.]+ mL delivered of 200 mL"))
    assert service.view("acid")["status"]["unfinished"]["number"] == 1


def test_a_pump_that_another_program_moves_is_not_said_to_be_unfinished(service, laboratory, open_page):
    page = open_page(service.url)
    with laboratory.start("200mL", "--pump", "acid", "--no-service", "--pace", "real") as other:
        expect(state(page, "acid")).to_contain_text("Another program moves it: ")
        expect(page.locator(".read .what").first).to_have_text(
            "delivered of 200 mL requested; another program moves it"
        )
        page.get_by_role("button", name="Stop acid").click()
        expect(page.locator("#stop-said")).to_contain_text("another program, which this page cannot stop: acid.")
        other.send_signal(signal.SIGINT)
    expect(state(page, "acid")).to_have_text("A dose is unfinished")
