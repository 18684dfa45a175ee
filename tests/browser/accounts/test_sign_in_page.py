"""The second factor at the door, the sessions of one's account, the word before a session ends, and what signing out leaves behind."""

import re
from base64 import b32decode
from collections.abc import Callable
from time import time

import pytest
from playwright.sync_api import Page, expect

from accounts.second_factors import STEP_S, code_of
from tests.browser.accounts.test_account import account, newcomer
from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.pictures import THEMES

pytestmark = pytest.mark.browser
Picture = Callable[[Page, str], None]
DRAFTS = "Object.keys(localStorage).filter((key) => key.startsWith('spanwise.draft.')).length"


def pictures(page: Page, picture: Picture, name: str) -> None:
    for theme in THEMES:
        page.emulate_media(color_scheme=theme)
        picture(page, f"{name}-{theme}")


def seed_on(page: Page) -> bytes:
    return b32decode("".join(page.locator(".seed span").all_text_contents()))


def code_now(seed: bytes) -> str:
    return code_of(seed, int(time() // STEP_S))


def types_password(page: Page, name: str) -> None:
    page.goto("/sign-in")
    page.get_by_label("User name").fill(name)
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Sign in", exact=True).click()


def test_a_second_factor_is_set_up_asked_for_and_replaced_by_a_recovery_code(visitor: Visitor, picture: Picture) -> None:
    page = account(newcomer(visitor, "frieda"))
    page.get_by_role("region", name="Second factor").get_by_role("link", name="Set up").click()
    expect(page.get_by_role("img", name="QR code for an authenticator app")).to_be_visible()
    box = page.locator(".qr svg").bounding_box()
    assert box is not None
    assert box["width"] > 140
    pictures(page, picture, "second-factor")
    seed = seed_on(page)
    page.get_by_role("textbox", name="Code").fill("000000")
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Set up").click()
    expect(page.get_by_role("alert")).to_contain_text("This is not the app’s code of now.")
    assert seed_on(page) == seed, "the app need not read another picture"
    page.get_by_role("textbox", name="Code").fill(code_now(seed))
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Set up").click()
    expect(page.locator(".recovery-codes li")).to_have_count(8)
    codes = page.locator(".recovery-codes li").all_text_contents()
    pictures(page, picture, "recovery-codes")
    page.get_by_role("link", name="I have kept them").click()
    expect(page.get_by_text("8 recovery codes are left.")).to_be_visible()
    pictures(page, picture, "account-second-factor")

    other = visitor.opens(size=(390, 844))
    types_password(other, "frieda")
    expect(other.get_by_role("textbox", name="Code")).to_be_focused()
    pictures(other, picture, "sign-in-code-phone")
    other.get_by_role("textbox", name="Code").fill("999999")
    other.get_by_role("button", name="Sign in").click()
    expect(other.get_by_role("alert")).to_contain_text("4 tries left for 15 min.")
    other.get_by_role("textbox", name="Code").fill(codes[0])
    other.get_by_role("button", name="Sign in").click()
    expect(other.get_by_role("heading", name="Missions", exact=True)).to_be_visible()

    account(page)
    sessions = page.get_by_role("list", name="Where you are signed in")
    expect(sessions.get_by_role("listitem")).to_have_count(2)
    expect(sessions.get_by_text("This one")).to_have_count(1)
    sessions.get_by_role("button", name=re.compile("^Sign out ")).click()
    expect(sessions.get_by_role("listitem")).to_have_count(1)
    other.goto("/account")
    expect(other.get_by_role("heading", name="Sign in")).to_be_visible()


@pytest.mark.long
def test_a_word_stands_on_the_page_before_the_session_ends(visitor: Visitor, picture: Picture) -> None:
    page = account(newcomer(visitor, "walter"))
    page.evaluate('import("/static/js/page/session_end.js").then(({ watchSessionEnd }) => watchSessionEnd(240))')
    message = page.get_by_role("alert").filter(has_text="You will be signed out at")
    expect(message).to_be_visible()
    pictures(page, picture, "session-word")
    page.set_viewport_size({"width": 390, "height": 844})
    pictures(page, picture, "session-word-phone")
    message.get_by_role("button", name="Stay signed in").click()
    expect(message).to_have_count(0)


def test_signing_out_tells_of_drafts_and_deletes_them(visitor: Visitor, picture: Picture) -> None:
    page = newcomer(visitor, "dora")
    page.goto("/missions/new")
    page.locator("html[data-loaded]").wait_for(state="attached")  # the page listens to the name
    page.get_by_label("Name of the mission").fill("Half a plan")
    page.wait_for_function(f"() => {DRAFTS} === 1")
    page.get_by_role("button", name=re.compile("^Account of")).click()
    page.get_by_role("button", name="Sign out").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("1 draft is not saved on the server")
    pictures(page, picture, "signing-out")
    dialog.get_by_role("button", name="Delete").click()
    expect(page.get_by_role("heading", name="Sign in")).to_be_visible()
    assert page.evaluate(DRAFTS) == 0
