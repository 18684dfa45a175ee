"""Bearer tokens and sessions."""

from datetime import timedelta
from io import StringIO

import pytest
from django.core.management import CommandError, call_command
from django.test import Client
from django.utils import timezone

from tests.accounts.users import a_user, client_of
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken

pytestmark = pytest.mark.django_db


def status_with(token: str) -> int:
    return Client().get("/api/v1/jobs", headers={"Authorization": f"Bearer {token}"}).status_code


def token_of_a_user(**valid: float) -> str:
    return create_api_token(user=a_user(), name="test", expires_at=timezone.now() + timedelta(**(valid or {"days": 1})))


def test_a_token_signs_in() -> None:
    assert status_with(token_of_a_user()) == 200


def test_only_the_hash_of_a_token_is_kept() -> None:
    token = token_of_a_user()
    row = ApiToken.objects.values().get()
    assert token not in str(row)
    assert len(row["token_sha256"]) == 64


def test_an_expired_token_is_refused() -> None:
    assert status_with(token_of_a_user(seconds=-1)) == 401


def test_a_revoked_token_is_refused() -> None:
    token = token_of_a_user()
    ApiToken.objects.update(revoked_at=timezone.now())
    assert status_with(token) == 401


def test_a_token_of_somebody_who_was_locked_out_is_refused() -> None:
    token = token_of_a_user()
    ApiToken.objects.get().user.__class__.objects.update(is_active=False)
    assert status_with(token) == 401


@pytest.mark.parametrize("token", ["", "spw_unknown", "x" * 10_000, "spw_ä"])
def test_what_is_no_token_is_refused(token: str) -> None:
    assert status_with(token) == 401


def test_a_stranger_is_told_how_to_sign_in() -> None:
    answer = Client().get("/api/v1/jobs")
    assert answer.status_code == 401
    assert answer["WWW-Authenticate"] == "Bearer"
    assert answer.json()["error"]["code"] == "not_authenticated"


@pytest.mark.urls("tests.workspace.api.echo_urls")
def test_a_session_cannot_write_without_the_csrf_token() -> None:
    client = Client(enforce_csrf_checks=True)
    client.force_login(a_user())
    assert client.post("/api/v1/echo", {}, content_type="application/json").status_code == 403


@pytest.mark.urls("tests.workspace.api.echo_urls")
def test_a_bearer_token_needs_no_csrf_token() -> None:
    client = Client(enforce_csrf_checks=True, headers={"Authorization": f"Bearer {token_of_a_user()}"})
    assert client.post("/api/v1/echo", {}, content_type="application/json").status_code == 200


def test_a_session_signs_in() -> None:
    assert client_of(a_user()).get("/api/v1/jobs").status_code == 200


def test_the_command_prints_a_working_token_alone_on_the_last_line() -> None:
    user = a_user()
    out = StringIO()
    call_command("api_token", user.username, "--days", "2", "--name", "script", stdout=out)
    assert status_with(out.getvalue().splitlines()[-1]) == 200
    token = ApiToken.objects.get()
    assert token.name == "script"
    assert timedelta(days=1) < token.expires_at - timezone.now() <= timedelta(days=2)


def test_the_command_refuses_an_unknown_user() -> None:
    with pytest.raises(CommandError, match="no active user is called nobody"):
        call_command("api_token", "nobody")
