"""Who may use the page, and names that try to be more than text."""

from urllib.parse import quote

from playwright.sync_api import expect

from watching import PHONE, inspect, is_too_wide, live, panel, state

TOKEN = "0123456789abcdef0123456789abcdef"
EVIL = "<img src=x onerror=alert(1)>"


def test_a_token_is_asked_for_and_a_login_keeps_it(laboratory, open_page):
    token = laboratory.folder / "token"
    token.write_text(TOKEN + "\n")
    token.chmod(0o600)
    service = laboratory.serve("--token-file", str(token))
    page = open_page(service.url, is_live=False)
    expect(page.get_by_role("heading", name="Log in")).to_be_visible()
    found = inspect(page, "log in")
    page.get_by_label("Token").fill("wrong")
    page.keyboard.press("Enter")
    expect(page.get_by_role("alert").last).to_contain_text("not the service's token")
    page.get_by_label("Token").fill(TOKEN)
    page.keyboard.press("Enter")
    live(page)
    cookie = page.context.cookies()[0]
    assert cookie["httpOnly"]
    assert cookie["sameSite"] == "Strict"
    assert TOKEN not in cookie["value"]
    page.reload()
    panel(live(page), "acid").get_by_label("Volume").fill("2mL")
    page.keyboard.press("Enter")
    expect(panel(page, "acid").locator(".said")).to_have_text("Done: dose 2mL.")
    found += inspect(page, "logged in")
    page.get_by_role("button", name="Log out everywhere").click()
    expect(page.get_by_role("heading", name="Log in")).to_be_visible()
    page.reload()
    expect(page.get_by_role("heading", name="Log in")).to_be_visible()
    assert not found, "\n".join(found)


def test_hostile_names_are_text(make_laboratory, open_page):
    limit = "\n[safety]\nmax_ml_per_day = 20.0\n"
    laboratory = make_laboratory(titles={"acid": EVIL + " " + "x" * 80}, lines={"acid": limit})
    plan = laboratory.folder / f"{EVIL.replace('/', '')}.toml"
    plan.write_text(
        'schema = "schedule/1"\nzone = "UTC"\n[[entry]]\nname = "a"\npump = "acid"\ndose = "1mL"\nat = "07:00"'
    )
    service = laboratory.serve("--schedule", str(plan))
    page = open_page(service.url)
    card = panel(page, "acid")
    expect(card).to_contain_text(EVIL)
    card.get_by_label("Volume").fill(EVIL)
    card.get_by_role("button", name="Dose").click()
    expect(card.get_by_role("alert")).to_contain_text("<img")
    card.get_by_label("Volume").fill("50mL")
    card.get_by_role("button", name="Dose").click()
    expect(state(page, "acid")).to_have_text("Stands at a limit")
    service.post("/api/v1/pumps/acid/clear", {"reason": EVIL, "by": EVIL})
    page.set_viewport_size(PHONE)
    strange = [f"pump/{quote(EVIL, safe='')}", "pump/%E0%A4%A", EVIL]
    for where in ["", "pump/acid", "log", "schedule", *strange]:
        page.goto(f"{service.url}/#/{where}")
        expect(page.locator("main .panel, main h1").first).to_be_visible()
        page.wait_for_timeout(300)
        assert page.locator("img").count() == 0
        assert not is_too_wide(page), where


def test_the_page_may_load_and_be_framed_by_nothing_else(service, open_page):
    page = open_page(service.url, is_live=False)
    policy = page.request.get(service.url).headers["content-security-policy"]
    assert "default-src 'self'" in policy or "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
