"""Single sign-on in the browser: there and back, reauthentication at the provider, and the page of a refusal."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.accounts.single_sign_on.openid_provider import OpenIdProvider, openid_provider
from tests.browser.accounts.test_account import account
from tests.browser.accounts.test_sign_in_page import pictures
from tests.browser.conftest import Site, Visitor
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser
Picture = Callable[[Page, str], None]


@pytest.fixture(scope="module")
def running(site: Site) -> Iterator[OpenIdProvider]:
    with openid_provider(site.provider_port) as running:
        yield running


@pytest.fixture
def provider(running: OpenIdProvider, visitor: Visitor) -> Iterator[OpenIdProvider]:
    """The provider; pages ask it and no other host. Browsers complain about the answers 403 that these tests want."""
    yield running
    visitor.complaints[:] = [words for words in visitor.complaints if "status of 403" not in words]
    outside = [url for url in visitor.requests_outside if not url.startswith(f"{running.issuer}/authorize?")]
    visitor.requests_outside[:] = outside


def test_one_signs_in_at_the_provider_and_confirms_there(visitor: Visitor, provider: OpenIdProvider, picture: Picture) -> None:
    provider.claims = {"sub": "greta", "groups": ["pilots"], "preferred_username": "greta@grid.example", "name": "Greta Lindqvist"}
    page = visitor.opens("/sign-in?next=/account")
    link = page.get_by_role("link", name="Sign in with Grid ID")
    expect(link).to_be_visible()
    assert faults(page) == []
    pictures(page, picture, "sign-in-provider")
    link.click()
    expect(page.get_by_text("You sign in with Grid ID.")).to_be_visible()
    account(page)
    expect(page.get_by_role("region", name="Password")).to_have_count(0)
    expect(page.get_by_role("region", name="Passkeys")).to_have_count(0)
    pictures(page, picture, "account-provider")

    tokens = page.get_by_role("region", name="Tokens")
    tokens.get_by_label("Name").fill("of a script")
    tokens.get_by_role("button", name="Create token").click()
    confirm = page.get_by_role("dialog").get_by_role("link", name="Confirm with Grid ID")
    expect(confirm).to_be_visible()
    pictures(page, picture, "reauthentication-provider")
    confirm.click()
    page.wait_for_url("**/account")
    page.locator("html[data-loaded]").wait_for(state="attached")
    tokens.get_by_label("Name").fill("of a script")
    tokens.get_by_role("button", name="Create token").click()
    expect(page.locator("#new-token code")).to_contain_text("spw_")


@pytest.mark.long
def test_a_refusal_says_what_to_do(visitor: Visitor, provider: OpenIdProvider, picture: Picture) -> None:
    provider.claims = {"sub": "gustav", "groups": ["visitors"]}
    page = visitor.opens("/sign-in")
    page.get_by_role("link", name="Sign in with Grid ID").click()
    expect(page.get_by_role("heading", name="You have no access to Spanwise")).to_be_visible()
    expect(page.get_by_text("Grid ID gives you no role in Spanwise.")).to_be_visible()
    expect(page.get_by_role("link", name="Use another account")).to_be_visible()
    assert faults(page) == []
    pictures(page, picture, "single-sign-on-refused")
