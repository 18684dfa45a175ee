"""Tokens do what they were made for and no more, for a year at most, and end with a password."""

from datetime import timedelta
from io import StringIO
from typing import Any

import pytest
from django.contrib.auth.tokens import default_token_generator
from django.core.management import CommandError, call_command
from django.test import Client
from django.urls import reverse
from django.utils import timezone
from django.utils.encoding import force_bytes
from django.utils.http import urlsafe_base64_encode

from tests.accounts.users import a_user, client_of
from tests.missions.api import TERN, plan_body
from tests.missions.worlds import world
from workspace.api.authentication import reader_of_token
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken, Role, TokenScope, User

pytestmark = pytest.mark.django_db

PASSWORD = "correct horse 9"
TOKENS = "/api/v1/account/tokens"


@pytest.fixture(autouse=True)
def _quick_hashes(settings: Any) -> None:
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]  # nothing here is about how slow a hash is


def with_token(user: User, *scopes: str) -> Client:
    token = create_api_token(user=user, name="test", expires_at=timezone.now() + timedelta(days=1), scopes=scopes or None)
    return Client(headers={"Authorization": f"Bearer {token}"}, raise_request_exception=False)


def send(client: Client, method: str, path: str, body: Any = None) -> tuple[int, str]:
    answer = getattr(client, method)(f"/api/v1/{path}", body or {}, content_type="application/json", headers={"If-Match": "*"})
    return answer.status_code, answer.json()["error"]["message"] if answer.status_code == 403 else ""


@pytest.mark.parametrize(
    ("method", "path", "scope"),
    [
        ("get", "missions", "read"),
        ("post", "missions", "plan"),
        ("post", "plans", "plan"),
        ("post", "uavs", "plan"),
        ("post", "missions/00000000-0000-4000-8000-000000000000/approve", "fly"),
        ("post", "missions/00000000-0000-4000-8000-000000000000/dispatch", "fly"),
        ("post", "missions/00000000-0000-4000-8000-000000000000/abort", "fly"),
        ("post", "uavs/1/commands", "fly"),
        ("post", "alerts/1/close", "fly"),
        ("post", "alerts/1/acknowledge", "fly"),
        ("post", "simulations", "fly"),
        ("post", "assets", "curate"),
        ("post", "zones", "curate"),
        ("get", "imports", "curate"),
        ("get", "users", "administer"),
        ("get", "sign-ins", "administer"),
    ],
)
def test_a_token_needs_the_scope_of_what_it_is_used_for(method: str, path: str, scope: str) -> None:
    administrator = a_user(Role.ADMINISTRATOR)
    for given in TokenScope.values:
        status, words = send(with_token(administrator, given), method, path)
        if given == scope:
            assert status != 403, (given, words)
        else:
            assert (status, scope in words) == (403, True), (given, words)


def test_the_short_way_of_small_plans_asks_for_the_scope_too() -> None:
    here, user = world(), a_user()
    body = plan_body(here.towers[1]) | {"uavs": [TERN]}
    assert send(with_token(user, "plan"), "post", "plans", body)[0] == 200
    assert send(with_token(user, "read", "fly"), "post", "plans", body)[0] == 403


def test_a_scope_gives_nothing_that_the_role_does_not_have() -> None:
    viewer = a_user(Role.VIEWER)
    assert send(with_token(viewer, "plan", "fly", "administer"), "post", "missions")[0] == 403
    assert send(with_token(viewer, "administer"), "get", "users")[0] == 403


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("post", "users/{}/sign-out", None),
        ("delete", "users/{}/tokens", None),
        ("delete", "users/{}/second-factor", None),
        ("patch", "users/{}", {"role": "administrator"}),
        ("put", "rehearsal-rule", {"requires_green": False}),
        ("put", "second-factor-rule", {"required": False}),
        ("post", "invitations", {"role": "administrator"}),
        ("delete", "invitations/1", None),
        ("post", "account/tokens", {"name": "more"}),
        ("post", "account/password", {}),
        ("post", "account/sign-out-everywhere", None),
        ("patch", "account", {"first_name": "X"}),
    ],
)
def test_no_token_touches_peoples_sessions_tokens_and_rules(method: str, path: str, body: Any) -> None:
    other = a_user(Role.VIEWER)
    status, _ = send(with_token(a_user(Role.ADMINISTRATOR)), method, path.format(other.pk), body)
    assert status == 403


def made(user: User, **body: Any) -> Any:
    user.set_password(PASSWORD)
    user.save()
    client = client_of(user)
    client.post("/api/v1/account/proof", {"password": PASSWORD}, content_type="application/json")
    return client.post(TOKENS, {"name": "ci", **body}, content_type="application/json")


def test_a_token_has_the_scopes_that_were_asked_for_or_those_of_the_role() -> None:
    user = a_user(Role.OPERATOR)
    assert made(user, scopes=["fly", "read"]).json()["scopes"] == ["read", "fly"]
    assert made(user).json()["scopes"] == ["read", "plan", "fly"]
    assert made(user, scopes=["curate"]).status_code == 400
    assert made(user, scopes=[]).status_code == 400
    assert made(user, scopes=["everything"]).status_code == 400


def test_a_token_lasts_a_year_at_most() -> None:
    user = a_user()
    assert made(user, days=365).status_code == 201
    assert made(user, days=366).status_code == 400
    with pytest.raises(CommandError):
        call_command("api_token", user.username, "--days", "366")


def test_the_command_makes_a_token_with_one_scope() -> None:
    call_command("api_token", a_user().username, "--scope", "read", stdout=StringIO())
    assert ApiToken.objects.get().scopes == ["read"]


def works(client: Client) -> bool:
    return bool(client.get("/api/v1/missions").status_code == 200)


def test_tokens_end_with_a_new_password_on_request() -> None:
    user = a_user()
    user.set_password(PASSWORD)
    user.save()
    token = with_token(user)
    client = client_of(user)
    passwords = {"old_password": PASSWORD, "new_password": "another horse 7"}
    assert client.post("/api/v1/account/password", passwords, content_type="application/json").status_code == 204
    assert works(token)
    again = {"old_password": "another horse 7", "new_password": PASSWORD, "end_tokens": True}
    assert client.post("/api/v1/account/password", again, content_type="application/json").status_code == 204
    assert not works(token)


def test_tokens_end_with_a_password_that_was_set_by_a_mailed_link() -> None:
    user = a_user()
    user.set_password(PASSWORD)
    user.save()
    token = with_token(user)
    place = urlsafe_base64_encode(force_bytes(user.pk)), default_token_generator.make_token(user)
    visitor = Client()
    form = visitor.get(reverse("new-password", args=place), follow=True)
    passwords = {"new_password1": "another horse 7", "new_password2": "another horse 7"}
    visitor.post(form.redirect_chain[-1][0], passwords)
    user.refresh_from_db()
    assert user.check_password("another horse 7")
    assert not works(token)


def test_a_token_that_the_version_before_has_made_does_all_of_the_role() -> None:
    token = with_token(a_user())
    ApiToken.objects.update(scopes=None)
    assert works(token)
    assert send(token, "post", "missions")[0] == 400
    assert client_of(ApiToken.objects.get().user).get(TOKENS).json()["results"][0]["scopes"] == ["read", "plan", "fly"]


@pytest.mark.parametrize(
    ("scopes", "may_follow"), [(("read",), True), (("read", "plan"), True), ((), True), (("plan", "administer"), False)]
)
def test_a_websocket_needs_a_token_that_may_read(scopes: tuple[str, ...], may_follow: bool) -> None:
    user = a_user(Role.ADMINISTRATOR)
    token = create_api_token(user=user, name="test", expires_at=timezone.now() + timedelta(days=1), scopes=scopes or None)
    assert reader_of_token(token.encode()) == (user if may_follow else None)
