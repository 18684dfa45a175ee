"""One's own account: preferences that hold in every browser, the password, tokens, sessions."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser


def account(page: Page) -> Page:
    page.goto("/account")
    page.locator("html[data-loaded]").wait_for(state="attached")
    return page


def newcomer(visitor: Visitor, name: str, role: str = "operator") -> Page:
    """Somebody who came in by an invitation: other tests' people keep their passwords and preferences."""
    page = visitor.signs_in("ada")
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    invitation = page.request.post("/api/v1/invitations", data={"role": role}, headers={"X-CSRFToken": token}).json()
    guest = visitor.opens(invitation["link"])
    guest.get_by_label("User name").fill(name)
    guest.get_by_label("Password", exact=True).fill(PASSWORD)
    guest.get_by_label("Repeat").fill(PASSWORD)
    guest.get_by_role("button", name="Make the account").click()
    expect(guest.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    return guest


@pytest.mark.long
def test_preferences_are_kept_at_once_and_hold_in_another_browser(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "pia"))
    page.get_by_role("radio", name="miles, feet, mph").check()
    expect(page.get_by_text("Such as 7.7 mi, 197 ft above ground, 27 mph.")).to_be_visible()
    page.locator("html[data-loaded]").wait_for(state="attached")
    page.get_by_label("Time zone").select_option("Asia/Tokyo")
    expect(page.locator("html[data-time-zone='Asia/Tokyo'][data-loaded]")).to_be_attached()
    page.get_by_role("group", name="Theme").get_by_role("radio", name="Dark").check()
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    page.get_by_label("First name").fill("Pia")
    with page.expect_response(lambda answer: answer.url.endswith("/api/v1/account") and answer.request.method == "PATCH"):
        page.get_by_label("Last name").focus()
    expect(page.get_by_role("status").filter(has_text="Saved")).to_be_visible()

    elsewhere = account(visitor.signs_in("pia"))
    expect(elsewhere.locator("html")).to_have_attribute("data-theme", "dark")
    expect(elsewhere.get_by_role("radio", name="miles, feet, mph")).to_be_checked()
    expect(elsewhere.get_by_label("Time zone")).to_have_value("Asia/Tokyo")
    expect(elsewhere.get_by_label("First name")).to_have_value("Pia")


@pytest.mark.long
def test_the_theme_button_of_the_bar_keeps_the_theme_in_the_account(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "theo"))
    for theme in ("light", "dark"):
        with page.expect_response(lambda answer: answer.url.endswith("/api/v1/account") and answer.request.method == "PATCH"):
            page.locator("#switch-theme").click()
        expect(page.locator("html")).to_have_attribute("data-theme", theme)
    expect(page.get_by_role("group", name="Theme").get_by_role("radio", name="Dark")).to_be_checked()
    expect(account(visitor.signs_in("theo")).locator("html")).to_have_attribute("data-theme", "dark")


@pytest.mark.long
def test_a_chosen_language_is_there_at_once(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "lena"))
    page.get_by_label("Language").select_option("de")
    expect(page.locator("html[lang='de'][data-loaded]")).to_be_attached()
    expect(page.locator("#language")).to_be_focused()
    page.locator("#language").select_option("en")
    expect(page.locator("html[lang^='en'][data-loaded]")).to_be_attached()


@pytest.mark.long
def test_single_keys_can_be_switched_off(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "kira"))
    page.get_by_role("switch", name="Single-key shortcuts").uncheck()
    expect(page.get_by_role("status").filter(has_text="Saved")).to_be_visible()
    page.locator("#main").focus()
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.keyboard.press("g")
    page.keyboard.press("m")
    page.get_by_role("button", name="Keyboard").first.click()
    expect(page.get_by_role("dialog")).to_contain_text("Single keys are switched off in your account.")
    expect(page).to_have_url(re.compile("/account"))
    page.keyboard.press("Escape")
    page.get_by_role("switch", name="Single-key shortcuts").check()
    expect(page.locator("html")).to_have_attribute("data-single-keys", "on")
    page.locator("#main").focus()
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_be_visible()


def test_a_new_password_says_what_is_wrong_and_signs_out_elsewhere(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "petra"))
    elsewhere = visitor.signs_in("petra")
    old, new, again = (page.get_by_label(label) for label in ("Current password", "New password", "Repeat"))
    button = page.get_by_role("button", name="Change the password")
    old.fill("wrong")
    new.fill("walk-the-corridor")
    again.fill("walk-the-corridors")
    button.click()
    expect(page.get_by_role("alert")).to_contain_text("The two are not the same.")
    again.fill("walk-the-corridor")
    button.click()
    expect(page.get_by_role("alert")).to_contain_text("This is not your password.")
    expect(old).to_be_focused()
    old.fill(PASSWORD)
    button.click()
    expect(page.get_by_text("The password is changed. Other browsers are signed out.")).to_be_visible()
    account(page)
    elsewhere.goto("/account")
    expect(elsewhere.get_by_role("heading", name="Sign in")).to_be_visible()
    visitor.complaints[:] = [words for words in visitor.complaints if "400" not in words]  # the refusal that was wanted


def test_a_token_is_shown_once_works_and_is_revoked(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "tove"))
    expect(page.get_by_text("No tokens")).to_be_visible()
    page.get_by_role("button", name="Create token").click()
    expect(page.get_by_role("alert")).to_contain_text("Say what the token is for.")
    page.get_by_label("Name", exact=True).fill("Nightly export")
    page.get_by_label("Expires after").select_option("7 days")
    page.get_by_role("button", name="Create token").click()
    token = page.get_by_role("textbox", name="Token", exact=True).text_content() or ""
    expect(page.get_by_role("button", name="Copy")).to_be_focused()
    stranger = visitor.new_context(extra_http_headers={"Authorization": f"Bearer {token}"})
    assert stranger.request.get("/api/v1/account").json()["username"] == "tove"

    account(page)
    expect(page.get_by_text(token)).to_have_count(0)
    expect(page.get_by_role("list", name="Tokens").get_by_text("Nightly export")).to_be_visible()
    expect(page.get_by_text(re.compile("last used now|last used today"))).to_be_visible()
    page.get_by_role("button", name="Revoke Nightly export").click()
    expect(page.get_by_text("“Nightly export” was revoked.")).to_be_visible()
    expect(page.get_by_role("list", name="Tokens").get_by_text("Revoked", exact=True)).to_be_visible()
    assert stranger.request.get("/api/v1/account").status == 401


OWN_JOBS = """
from django.utils import timezone
from workspace.models import Job, User
jana = User.objects.get(username="jana")
own = {"organisation": jana.organisation, "created_by": jana, "task": "missions.tasks.solve_plan"}
Job.objects.create(**own)
Job.objects.create(**own, state="failed", error={"code": "took_too_long", "message": "Too long."}, finished_at=timezone.now())
Job.objects.create(**own | {"created_by": User.objects.get(username="ada"), "task": "inspection.tasks.read_proposal"})
"""


@pytest.mark.long
def test_ones_own_jobs_are_listed_and_one_that_waits_is_cancelled(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "jana"))
    jobs = page.get_by_role("list", name="Jobs")
    expect(page.get_by_text("Nothing has run for you yet.")).to_be_visible()
    visitor.site.does(OWN_JOBS)
    account(page)
    expect(jobs.get_by_role("listitem")).to_have_count(2)
    expect(jobs.get_by_role("listitem").nth(0)).to_contain_text("Waiting")
    expect(jobs.get_by_role("listitem").nth(1)).to_contain_text("Too long.")
    jobs.get_by_role("button", name="Cancel: Planning").click()
    expect(page.get_by_text("The job is asked to stop.")).to_be_visible()
    expect(jobs.get_by_text("Cancelled", exact=True)).to_be_visible()
    expect(jobs.get_by_role("button")).to_have_count(0)
    assert faults(page) == []


@pytest.mark.long
def test_whoever_may_not_cancel_a_job_is_not_offered_it(visitor: Visitor) -> None:
    """An operator who has become a viewer: what they had started still runs."""
    page = newcomer(visitor, "vito", role="viewer")
    visitor.site.does(OWN_JOBS.replace("jana", "vito"))
    jobs = account(page).get_by_role("list", name="Jobs")
    expect(jobs.get_by_role("listitem")).to_have_count(2)
    expect(jobs.get_by_role("button")).to_have_count(0)


@pytest.mark.long
def test_signing_out_everywhere_else_leaves_this_browser(visitor: Visitor) -> None:
    page = account(newcomer(visitor, "sven"))
    elsewhere = visitor.signs_in("sven")
    account(page)
    expect(page.get_by_role("list", name="Sign-ins").get_by_role("listitem")).to_have_count(2)
    page.get_by_role("button", name="Sign out everywhere else").click()
    expect(page.get_by_text("Signed out in all other browsers.")).to_be_visible()
    elsewhere.goto("/account")
    expect(elsewhere.get_by_role("heading", name="Sign in")).to_be_visible()
    account(page)
