"""Passkeys in a real browser with a virtual authenticator, on the host name that they need."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import CDPSession, Page, expect

from tests.browser.accounts.test_account import account, newcomer
from tests.browser.accounts.test_sign_in_page import pictures, types_password
from tests.browser.conftest import Visitor

pytestmark = pytest.mark.browser
Picture = Callable[[Page, str], None]
SIGNED_IN_AN_HOUR_AGO = """
from datetime import timedelta
from django.utils.timezone import now
from workspace.models import BrowserSession
BrowserSession.objects.filter(user__username="paula").update(began_at=now() - timedelta(hours=1))
"""


def with_authenticator(page: Page) -> CDPSession:
    """Give the page a device that makes passkeys and knows its owner."""
    session = page.context.new_cdp_session(page)
    session.send("WebAuthn.enable")
    options = {
        "protocol": "ctap2", "transport": "internal", "hasResidentKey": True, "hasUserVerification": True,
        "isUserVerified": True, "automaticPresenceSimulation": True,
    }  # fmt: skip
    session.send("WebAuthn.addVirtualAuthenticator", {"options": options})
    return session


def test_a_passkey_is_added_signs_in_confirms_and_is_removed(visitor: Visitor, picture: Picture) -> None:
    newcomer(visitor, "paula")
    context = visitor.new_context(base_url=visitor.site.address.replace("127.0.0.1", "localhost"))
    page = context.new_page()
    with_authenticator(page)
    types_password(page, "paula")
    expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    account(page)
    passkeys = page.get_by_role("list", name="Passkeys")
    page.get_by_label("Name of the passkey").fill("Work laptop")
    page.get_by_role("button", name="Add a passkey").click()
    expect(passkeys.get_by_role("listitem")).to_have_count(1)
    expect(passkeys).to_contain_text("Work laptop")
    pictures(page, picture, "account-passkeys")
    page.set_viewport_size({"width": 390, "height": 844})
    pictures(page, picture, "account-passkeys-phone")
    page.get_by_role("button", name="Add a passkey").click()
    expect(page.get_by_text("This device has a passkey for this account already.")).to_be_visible()

    context.clear_cookies()
    page.goto("/sign-in?next=/account")
    pictures(page, picture, "sign-in-passkey-phone")
    page.get_by_role("button", name="Sign in with a passkey").click()
    expect(page.get_by_role("heading", name="Account", exact=True)).to_be_visible()
    expect(passkeys).to_contain_text(re.compile("used .*now|used .*ago", re.IGNORECASE))

    context.clear_cookies()
    types_password(page, "paula")
    expect(page.get_by_role("heading", name="One more thing")).to_be_visible()
    pictures(page, picture, "sign-in-code-passkey-phone")
    page.get_by_role("button", name="Use a passkey").click()
    expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()

    visitor.site.does(SIGNED_IN_AN_HOUR_AGO)
    account(page)
    page.get_by_role("button", name="Remove Work laptop").click()
    dialog = page.get_by_role("dialog", name="Confirm that it is you")
    pictures(page, picture, "confirm-passkey-phone")
    dialog.get_by_role("button", name="Use a passkey").click()
    expect(page.get_by_text("None yet.")).to_be_visible()


@pytest.mark.long
def test_an_address_without_a_host_name_says_why_there_are_no_passkeys(visitor: Visitor) -> None:
    page = account(visitor.signs_in("ada"))
    expect(page.get_by_text("This browser or this address cannot make passkeys")).to_be_visible()
    expect(page.get_by_role("button", name="Add a passkey")).to_be_hidden()
    assert visitor.opens("/sign-in").get_by_role("button", name="Sign in with a passkey").is_hidden()
