"""Who works here: invited, found, given roles, kept out; and who came to the door."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.pictures import HAS_PICTURES
from tests.browser.test_accessibility import faults
from tests.cases import long

pytestmark = pytest.mark.browser
VIEWS: dict[str, dict[str, Any]] = {
    "light": {"theme": "light", "size": (1440, 900)},
    "dark": {"theme": "dark", "size": (1440, 900)},
    "phone-light": {"theme": "light", "size": (390, 844), "touch": True},
    "phone-dark": {"theme": "dark", "size": (390, 844), "touch": True},
}

# A dialog tells that it is closed with the next frame; a busy machine draws that after the server's answer.
REPORT_LATE = """addEventListener("close", (event) => {
    if (!event.isTrusted) return;
    event.stopImmediatePropagation();
    const { target } = event;
    setTimeout(() => {
        target.dispatchEvent(new Event("close"));
        document.documentElement.dataset.told = "late";
    }, 1000);
}, true)"""


def administration(page: Page, tab: str = "") -> Page:
    page.goto(f"/administration{tab and f'?tab={tab}'}")
    page.locator("html[data-loaded]").wait_for(state="attached")
    return page


def row_of(page: Page, name: str) -> Locator:
    return page.get_by_role("row").filter(has=page.get_by_text(name, exact=True))


def invites(page: Page, role: str) -> str:
    page.get_by_role("button", name="Invite user").click()
    dialog = page.get_by_role("dialog", name="Invite user")
    dialog.get_by_role("radio", name=re.compile(f"^{role}")).check()
    dialog.get_by_role("button", name="Create link").click()
    link = page.get_by_role("textbox", name="Link of the invitation")
    expect(page.get_by_role("button", name="Copy")).to_be_focused()
    return link.text_content() or ""


def comes_in(visitor: Visitor, link: str, name: str) -> Page:
    guest = visitor.opens(link)
    guest.get_by_label("User name").fill(name)
    guest.get_by_label("First name").fill("Mona")
    guest.get_by_label("Last name").fill("Vale")
    guest.get_by_label("Password", exact=True).fill(PASSWORD)
    guest.get_by_label("Repeat").fill(PASSWORD)
    guest.get_by_role("button", name="Make the account").click()
    return guest


def test_an_invitation_makes_an_account_once(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    link = invites(page, "Viewer")
    guest = comes_in(visitor, link, "mona")
    expect(guest.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    expect(guest.get_by_role("link", name="New mission")).to_have_count(0)

    administration(page, "invitations")
    expect(page.get_by_role("row").filter(has_text="accepted by mona")).to_contain_text("Accepted")
    expect(page.get_by_text(link)).to_have_count(0)
    late = visitor.opens(link)
    expect(late.get_by_role("heading", name="This link does not work any more")).to_be_visible()
    visitor.complaints[:] = [words for words in visitor.complaints if "410" not in words]  # the answer that was wanted


@pytest.mark.long
def test_the_link_keeps_the_focus_however_late_the_dialog_says_that_it_is_closed(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    page.evaluate(REPORT_LATE)
    invites(page, "Viewer")
    page.locator("html[data-told=late]").wait_for(state="attached")
    expect(page.get_by_role("button", name="Copy")).to_be_focused()
    expect(page.get_by_role("dialog")).to_have_count(0)


@pytest.mark.long
def test_an_invitation_that_was_taken_back_lets_nobody_in(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    link = invites(page, "Administrator")
    page.get_by_role("button", name=re.compile("Revoke")).first.click()
    expect(page.get_by_text("The link was revoked.")).to_be_visible()
    expect(page.get_by_role("row").nth(1)).to_contain_text("Revoked")
    expect(visitor.opens(link).get_by_role("heading", name="This link does not work any more")).to_be_visible()
    visitor.complaints[:] = [words for words in visitor.complaints if "410" not in words]


def test_a_person_is_found_given_a_role_and_the_role_is_taken_back(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    guest = comes_in(visitor, invites(page, "Operator"), "rolf")
    expect(guest.get_by_role("link", name=re.compile("New mission")).first).to_be_visible()
    administration(page)
    page.keyboard.press("/")
    page.keyboard.type("rolf")
    expect(page.get_by_text("1 user", exact=True)).to_be_visible()
    row = row_of(page, "rolf")
    expect(row).to_contain_text("Online")
    row.get_by_label("Role of rolf").select_option("Curator")
    expect(page.get_by_text("rolf has the role Curator now.")).to_be_visible()
    expect(row.get_by_label("Role of rolf")).to_be_focused()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_text("As before.")).to_be_visible()
    expect(row.get_by_label("Role of rolf")).to_have_value("operator")

    page.get_by_role("searchbox", name="Find users by name or address").fill("bexley")
    expect(page.get_by_text("Nothing matches")).to_be_visible()
    page.get_by_role("button", name="Clear the filters").click()
    expect(row).to_be_visible()


@pytest.mark.long
def test_whoever_is_kept_out_is_out_at_once_and_let_in_again(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    guest = comes_in(visitor, invites(page, "Operator"), "kept")
    expect(guest.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    administration(page)
    page.get_by_role("button", name="More for kept").click()
    page.get_by_role("button", name="Block").click()
    expect(page.get_by_text("kept can no longer sign in.")).to_be_visible()
    expect(row_of(page, "kept")).to_contain_text("Blocked")
    guest.goto("/account")
    expect(guest.get_by_role("heading", name="Sign in")).to_be_visible()
    page.get_by_label("Access").select_option("Blocked")
    expect(page.get_by_text("1 user", exact=True)).to_be_visible()
    page.get_by_role("button", name="More for kept").click()
    page.get_by_role("button", name="Unblock").click()
    expect(page.get_by_text("kept may sign in.")).to_be_visible()
    visitor.signs_in("kept")


@pytest.mark.long
def test_of_two_administrators_the_later_one_is_told(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    comes_in(visitor, invites(page, "Operator"), "twice")
    administration(page)
    other = administration(visitor.signs_in("ada"))
    row_of(other, "twice").get_by_label("Role of twice").select_option("Viewer")
    expect(other.get_by_text("twice has the role Viewer now.")).to_be_visible()
    row_of(page, "twice").get_by_label("Role of twice").select_option("Curator")
    expect(page.get_by_role("alert")).to_contain_text("Somebody else has changed twice in the meantime.")
    expect(row_of(page, "twice").get_by_label("Role of twice")).to_have_value("viewer")
    visitor.complaints[:] = [words for words in visitor.complaints if "412" not in words]  # the refusal that was wanted


@pytest.mark.long
def test_name_and_address_are_changed_in_a_dialog_and_faults_stand_there(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"))
    comes_in(visitor, invites(page, "Viewer"), "nils")
    administration(page)
    page.get_by_role("button", name="More for nils").click()
    page.get_by_role("button", name="Name and address").click()
    dialog = page.get_by_role("dialog", name="nils")
    dialog.get_by_label("E-mail address").fill("nobody")
    dialog.get_by_role("button", name="Save").click()
    expect(dialog.get_by_role("alert")).to_contain_text("valid email address")
    dialog.get_by_label("E-mail address").fill("nils@example.org")
    dialog.get_by_role("button", name="Save").click()
    expect(row_of(page, "nils")).to_contain_text("Mona Vale · nils@example.org")
    visitor.complaints[:] = [words for words in visitor.complaints if "400" not in words]


@pytest.mark.long
def test_a_program_works_with_a_service_account_until_it_is_disabled(visitor: Visitor) -> None:
    page = administration(visitor.signs_in("ada"), "service-accounts")
    page.get_by_role("button", name="Add a service account").click()
    dialog = page.get_by_role("dialog", name="Add a service account")
    dialog.get_by_label("Name").fill("erp")
    dialog.get_by_role("button", name="Add").click()
    tokens = page.get_by_role("dialog", name="Tokens of erp")
    tokens.get_by_label("Name").fill("night run")
    tokens.get_by_role("button", name="Create token").click()
    token = tokens.get_by_role("textbox", name="Token", exact=True).text_content() or ""
    program = visitor.new_context(extra_http_headers={"Authorization": f"Bearer {token}"})
    assert program.request.get("/api/v1/missions").status == 200
    expect(tokens.get_by_role("checkbox", name="Read")).to_be_checked()  # again, for the next one
    assert faults(page) == []
    tokens.get_by_role("button", name="Close").click()
    row = row_of(page, "erp")
    expect(row.locator(".tokens")).to_have_text("1")
    page.get_by_role("button", name="More for erp", exact=True).click()
    page.get_by_role("button", name="Disable").click()
    expect(page.get_by_text("erp is disabled: none of its tokens works.")).to_be_visible()
    expect(row).to_contain_text("Disabled")
    assert program.request.get("/api/v1/missions").status == 401


@pytest.mark.long
def test_the_log_shows_tries_and_filters_them(visitor: Visitor) -> None:
    endpoint = visitor.opens()
    endpoint.get_by_label("User name").fill("nobody-at-all")
    endpoint.get_by_label("Password").fill("wrong")
    endpoint.get_by_role("button", name="Sign in").click()
    expect(endpoint.get_by_role("alert")).to_be_visible()

    page = administration(visitor.signs_in("ada"))
    page.get_by_role("radio", name="Sign-ins").check()
    expect(page).to_have_url(re.compile(r"\?tab=sign-ins$"))
    table = page.get_by_role("table", name="Sign-ins, newest first")
    person = page.get_by_role("searchbox", name="Find sign-ins of a user")
    person.fill("ada")
    expect(table.get_by_role("row").nth(1)).to_contain_text("ada")
    expect(table.get_by_role("row").nth(1)).to_contain_text("127.0.0.1")
    person.fill("")
    page.get_by_label("What happened").select_option("Wrong name or password")
    expect(table.get_by_role("row").nth(1)).to_contain_text("a name that nobody has")
    expect(page.get_by_text("nobody-at-all")).to_have_count(0)
    page.get_by_label("IP address, or its beginning").fill("10.9")
    expect(page.get_by_text("Nothing matches")).to_be_visible()
    page.go_back()
    expect(page.get_by_role("table", name="Users", exact=True)).to_be_visible()


def test_only_administrators_find_the_administration(visitor: Visitor) -> None:
    page = visitor.signs_in("cora", "/")
    page.get_by_role("button", name=re.compile("^Account of")).click()
    expect(page.get_by_role("link", name="Account", exact=True)).to_be_visible()
    expect(page.get_by_role("link", name="Administration")).to_have_count(0)
    page.goto("/administration")
    expect(page.get_by_role("heading", name="This is not yours to open.")).to_be_visible()
    visitor.complaints[:] = [words for words in visitor.complaints if "403" not in words]


@pytest.mark.long
@pytest.mark.parametrize("view", VIEWS if HAS_PICTURES else ["phone-dark", *long("light")])
def test_axe_finds_nothing_serious_on_any_tab_or_behind_a_link(visitor: Visitor, picture: Callable[[Page, str], None], view: str) -> None:
    page = visitor.signs_in("ada", **VIEWS[view])
    for tab in ("invitations", "sign-ins"):
        administration(page, tab)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), tab
        assert faults(page) == [], tab
        picture(page, f"page-administration-{tab}-{view}")
    page.get_by_role("button", name="Invite user").click()
    assert faults(page) == []
    page.get_by_role("dialog").get_by_role("button", name="Create link").click()
    link = page.get_by_role("textbox", name="Link of the invitation").text_content() or ""
    assert faults(page) == []
    guest = visitor.opens(link, **VIEWS[view])
    assert faults(guest) == []
    picture(guest, f"page-invitation-{view}")
