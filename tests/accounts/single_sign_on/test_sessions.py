"""Sessions that began by single sign-on: second factors, reauthentication at the provider, the account page."""

import time
from datetime import timedelta
from html import unescape
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from django.test import Client
from django.utils import timezone

from accounts.login import PROVED_AT, REAUTHENTICATION_S
from tests.accounts.authenticator_app import is_in, with_app
from tests.accounts.single_sign_on.openid_provider import OpenIdProvider, comes_back, signs_in, user_of
from tests.accounts.users import a_user, client_of
from workspace.api_tokens import create_api_token
from workspace.models import Role, User

pytestmark = pytest.mark.django_db
PASSWORD = "inspect-the-lines"


def test_second_factors_are_the_matter_of_the_provider(provider: OpenIdProvider, settings: Any) -> None:
    settings.REQUIRES_SECOND_FACTOR = True
    client = signs_in(provider)
    with_app(user_of(client))
    assert is_in(client)
    assert is_in(signs_in(provider))


def begin_long_ago(client: Client) -> None:
    session = client.session
    session[PROVED_AT] = time.time() - REAUTHENTICATION_S - 10
    session.save()


def makes_token(client: Client) -> int:
    body = {"name": "of a script", "scopes": ["read"], "days": 7}
    return int(client.post("/api/v1/account/tokens", body, content_type="application/json").status_code)


def test_a_session_of_the_provider_proves_nothing_until_it_has_asked_again(provider: OpenIdProvider) -> None:
    client = signs_in(provider)
    assert makes_token(client) == 403
    methods = client.get("/api/v1/account/proof").json()
    at_provider = {"address": "/single-sign-on/reauthentication", "name": "Grid ID"}
    assert methods == {"has_password": False, "passkey_options": None, "single_sign_on": at_provider}
    there = client.get("/single-sign-on/reauthentication?next=/account%23tokens").headers["Location"]
    asked = parse_qs(urlsplit(there).query)
    assert (asked["prompt"], asked["max_age"]) == (["login"], ["0"])
    assert client.get(provider.authorises(there)).headers["Location"] == "/account#tokens"
    assert makes_token(client) == 201
    begin_long_ago(client)
    assert makes_token(client) == 403


@pytest.mark.parametrize(("ago_s", "status"), [(10, 201), (REAUTHENTICATION_S - 60, 201), (REAUTHENTICATION_S + 60, 403)])
def test_a_sign_in_proves_as_much_as_the_provider_says(provider: OpenIdProvider, ago_s: int, status: int) -> None:
    assert makes_token(signs_in(provider, auth_time=int(time.time()) - ago_s)) == status


@pytest.mark.parametrize(
    ("claims", "status"),
    [
        ({}, 302),
        ({"auth_time": int(time.time()) - 3_600}, 403),
        ({"auth_time": int(time.time()) + 3_600}, 403),
        ({"auth_time": "now"}, 403),
        ({"auth_time": None}, 403),
        ({"sub": "berta"}, 403),
    ],
)
def test_the_same_user_must_have_authenticated_anew(provider: OpenIdProvider, claims: dict[str, Any], status: int) -> None:
    client = signs_in(provider)
    provider.claims |= claims
    assert comes_back(client, provider, "/single-sign-on/reauthentication").status_code == status
    assert makes_token(client) == (201 if status == 302 else 403)
    assert is_in(client)


def test_an_answer_to_a_sign_in_is_no_reauthentication(provider: OpenIdProvider) -> None:
    """Its request did not make the provider ask again."""
    client = Client()
    first, second = (client.get("/single-sign-on").headers["Location"] for _turn in range(2))
    assert client.get(provider.authorises(first)).status_code == 302
    assert client.get(provider.authorises(second)).headers["Location"] == "/"
    assert makes_token(client) == 403


def test_users_of_passwords_have_no_reauthentication_at_the_provider(provider: OpenIdProvider) -> None:
    client = client_of(a_user())
    assert client.get("/api/v1/account/proof").json()["single_sign_on"] is None
    assert client.get("/single-sign-on/reauthentication").status_code == 404


def test_the_account_page_shows_the_provider_and_no_password(provider: OpenIdProvider) -> None:
    page = unescape(signs_in(provider).get("/account").content.decode())
    assert "You sign in with Grid ID." in page
    assert "old_password" not in page
    assert "passkeys-title" not in page
    own = client_of(_with_password(a_user(Role.VIEWER))).get("/account").content.decode()
    assert "Grid ID" not in own
    assert "old_password" in own


def _with_password(user: User) -> User:
    user.set_password("inspect-the-lines")
    user.save()
    return user


def test_a_user_of_the_provider_alone_makes_no_passkey(provider: OpenIdProvider) -> None:
    """It would outlive the account at the provider."""
    client = signs_in(provider, auth_time=int(time.time()))
    answer = client.post("/api/v1/account/passkeys/options")
    assert (answer.status_code, answer.json()["error"]["code"]) == (403, "local_sign_in_off")


# Local sign-in switched off


@pytest.fixture
def alone(provider: OpenIdProvider, settings: Any) -> OpenIdProvider:
    settings.LOCAL_SIGN_IN = False
    return provider


def test_the_sign_in_page_offers_what_there_is(provider: OpenIdProvider, settings: Any) -> None:
    both = Client().get("/sign-in?next=/live").content.decode()
    assert 'href="/single-sign-on?next=%2Flive"' in both
    assert "id_password" in both
    settings.LOCAL_SIGN_IN = False
    one = Client().get("/sign-in").content.decode()
    assert "Sign in with Grid ID" in one
    for absent in ("id_password", "passkey", "lost-password"):
        assert absent not in one
    settings.LOCAL_SIGN_IN, settings.IDENTITY_PROVIDER = True, None
    assert "single-sign-on" not in Client().get("/sign-in").content.decode()


@pytest.mark.parametrize(
    ("method", "page"),
    [
        ("post", "/sign-in"), ("get", "/sign-in/passkey"), ("post", "/sign-in/passkey"), ("get", "/lost-password"),
        ("post", "/lost-password"),         ("get", "/new-password/x/x"), ("get", "/change-password"),
        ("post", "/change-password"), ("get", "/invitation/x"),
    ],
)  # fmt: skip
def test_pages_of_passwords_and_passkeys_are_refused(alone: OpenIdProvider, method: str, page: str) -> None:
    user = _with_password(a_user())
    answer = getattr(Client(), method)(page, {"login": user.username, "password": PASSWORD, "email": "a@b.example"})
    assert answer.status_code == 403
    assert "Sign in with Grid ID" in answer.content.decode()


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("password", {"old_password": PASSWORD, "new_password": "another-good-one", "end_tokens": False}),
        ("proof", {"password": PASSWORD}),
        ("proof", {"passkey": {}}),
        ("passkeys/options", {}),
        ("passkeys", {"name": "Phone", "passkey": {}}),
    ],
)
def test_endpoints_of_passwords_and_passkeys_are_refused(alone: OpenIdProvider, path: str, body: dict[str, Any]) -> None:
    client = client_of(_with_password(a_user()))
    answer = client.post(f"/api/v1/account/{path}", body, content_type="application/json")
    assert (answer.status_code, answer.json()["error"]["code"]) == (403, "local_sign_in_off")
    assert "Grid ID" in answer.json()["error"]["message"]


def test_invitations_are_not_made_for_nothing(alone: OpenIdProvider) -> None:
    answer = client_of(a_user(Role.ADMINISTRATOR)).post("/api/v1/invitations", {"role": "viewer"}, content_type="application/json")
    assert (answer.status_code, answer.json()["error"]["code"]) == (403, "local_sign_in_off")


def test_tokens_go_on(alone: OpenIdProvider) -> None:
    token = create_api_token(user=a_user(), name="of a script", expires_at=timezone.now() + timedelta(days=7))
    assert Client().get("/api/v1/account", headers={"Authorization": f"Bearer {token}"}).status_code == 200


def test_single_sign_on_goes_on(alone: OpenIdProvider) -> None:
    client = signs_in(alone)
    assert is_in(client)
    assert client.get("/account").status_code == 200
