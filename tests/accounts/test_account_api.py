"""One's own account over HTTP: preferences, the password, sessions, tokens."""

from datetime import timedelta
from typing import Any

import pytest
from django.core.cache import cache
from django.http import HttpResponse
from django.test import Client
from django.utils import timezone

from accounts.services import MAX_TOKENS, make_token
from tests.accounts.users import a_user, client_of
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken, AuditEntry, Role, SignInEntry, User

pytestmark = pytest.mark.django_db
OLD, NEW = "inspect-the-lines", "walk-the-corridor"


@pytest.fixture(autouse=True)
def _no_tries_yet(settings: Any) -> None:
    cache.clear()
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]  # nothing here is about how slow a hash is


@pytest.fixture
def user() -> User:
    person = a_user(Role.VIEWER)
    person.set_password(OLD)
    person.save()
    return person


@pytest.fixture
def client(user: User) -> Client:
    return client_of(user)


def change(client: Client, **values: Any) -> HttpResponse:
    return client.patch("/api/v1/account", values, content_type="application/json")


def post(client: Client, path: str, **body: Any) -> HttpResponse:
    return client.post(f"/api/v1/account/{path}", body, content_type="application/json")


def works(client: Client) -> bool:
    return bool(client.get("/api/v1/account").status_code == 200)


def test_a_viewer_keeps_preferences_of_their_own(client: Client, user: User) -> None:
    wanted = {
        "theme": "dark",
        "units": "imperial",
        "time_zone": "America/New_York",
        "language": "de",
        "single_keys": False,
        "last_name": "Lee",
    }
    assert change(client, **wanted).status_code == 200
    user.refresh_from_db()
    assert {name: getattr(user, name) for name in wanted} == wanted
    assert wanted.items() <= client.get("/api/v1/account").json().items()


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"theme": "pink"}, "theme"),
        ({"time_zone": "Mars/Olympus"}, "time_zone"),
        ({"language": "xx"}, "language"),
        ({"units": None}, "units"),
        ({"single_keys": "perhaps"}, "single_keys"),
    ],
)
def test_what_is_no_preference_is_refused_with_its_name(client: Client, values: dict[str, Any], fault: str) -> None:
    answer = change(client, **values)
    assert answer.status_code == 400
    assert fault in answer.json()["error"]["details"]


def test_nobody_gives_themselves_a_role_or_an_address(client: Client, user: User) -> None:
    change(client, role="administrator", email="me@example.org", is_active=True, username="root", session_generation=0)
    fresh = User.objects.get(pk=user.pk)
    assert (fresh.role, fresh.email, fresh.username) == (Role.VIEWER, user.email, user.username)


def test_a_new_password_ends_the_other_sessions_and_keeps_this_one(client: Client, user: User) -> None:
    elsewhere = client_of(user)
    assert post(client, "password", old_password=OLD, new_password=NEW).status_code == 204
    user.refresh_from_db()
    assert user.check_password(NEW)
    assert works(client)
    assert not works(elsewhere)
    assert AuditEntry.objects.filter(action="password changed", subject_id=str(user.pk), actor=user).exists()


@pytest.mark.parametrize(
    ("old", "new", "field"), [("wrong", NEW, "old_password"), (OLD, "12345678", "new_password"), (OLD, "short", "new_password")]
)
def test_a_wrong_or_weak_password_is_refused_at_its_field(client: Client, user: User, old: str, new: str, field: str) -> None:
    answer = post(client, "password", old_password=old, new_password=new)
    assert answer.status_code == 400
    assert list(answer.json()["error"]["details"]) == [field]
    user.refresh_from_db()
    assert user.check_password(OLD)


def test_somebody_at_an_open_browser_cannot_guess_on(client: Client) -> None:
    for _ in range(5):
        assert post(client, "password", old_password="wrong", new_password=NEW).status_code == 400
    answer = post(client, "password", old_password=OLD, new_password=NEW)
    assert answer.status_code == 429
    assert int(answer["Retry-After"]) > 0


def test_the_page_for_it_counts_with_the_address_for_programs(client: Client) -> None:
    for _ in range(5):
        post(client, "password", old_password="wrong", new_password=NEW)
    form = {"old_password": OLD, "new_password1": NEW, "new_password2": NEW}
    assert "Too many tries." in client.post("/change-password", form).content.decode()


def test_signing_out_everywhere_keeps_this_browser_alone(client: Client, user: User) -> None:
    elsewhere = client_of(user)
    assert works(elsewhere)
    assert post(client, "sign-out-everywhere").status_code == 204
    assert works(client)
    assert not works(elsewhere)


def test_a_token_is_shown_once_and_works_with_the_role(client: Client, user: User) -> None:
    answer = post(client, "tokens", name="export", days=7)
    assert answer.status_code == 201
    token = answer.json()["token"]
    listed = client.get("/api/v1/account/tokens")
    assert token not in listed.content.decode()
    assert [(row["name"], row["is_valid"], row["last_used_at"]) for row in listed.json()["results"]] == [("export", True, None)]
    bearer = Client(headers={"Authorization": f"Bearer {token}"})
    assert bearer.get("/api/v1/account").json()["username"] == user.username
    used = client.get("/api/v1/account/tokens").json()["results"][0]["last_used_at"]
    assert used is not None
    assert token not in str(list(AuditEntry.objects.values())) + str(list(ApiToken.objects.values()))


def test_a_token_that_is_used_often_is_written_seldom(client: Client) -> None:
    token = post(client, "tokens", name="export").json()["token"]
    bearer = Client(headers={"Authorization": f"Bearer {token}"})
    bearer.get("/api/v1/account")
    first = ApiToken.objects.get().last_used_at
    bearer.get("/api/v1/account")
    assert ApiToken.objects.get().last_used_at == first
    ApiToken.objects.update(last_used_at=timezone.now() - timedelta(minutes=2))
    bearer.get("/api/v1/account")
    assert ApiToken.objects.get().last_used_at > first


def test_a_revoked_token_works_no_more_and_stays_in_the_list(client: Client) -> None:
    made = post(client, "tokens", name="export").json()
    assert client.delete(f"/api/v1/account/tokens/{made['id']}").json()["is_valid"] is False
    assert Client(headers={"Authorization": f"Bearer {made['token']}"}).get("/api/v1/account").status_code == 401
    assert client.get("/api/v1/account/tokens").json()["results"][0]["revoked_at"]


def test_nobody_revokes_the_tokens_of_somebody_else(client: Client) -> None:
    create_api_token(user=a_user(), name="theirs", expires_at=timezone.now() + timedelta(days=1))
    token = ApiToken.objects.get()
    assert client.delete(f"/api/v1/account/tokens/{token.pk}").status_code == 404
    token.refresh_from_db()
    assert token.revoked_at is None


@pytest.mark.parametrize("body", [{}, {"name": ""}, {"name": "x", "days": 0}, {"name": "x", "days": 100_000}, {"name": "x" * 101}])
def test_a_token_without_a_name_or_an_end_is_refused(client: Client, body: dict[str, Any]) -> None:
    assert post(client, "tokens", **body).status_code == 400


def test_there_is_an_end_to_tokens(client: Client, user: User) -> None:
    for number in range(MAX_TOKENS):
        make_token(user=user, name=f"{number}", days=1)
    assert post(client, "tokens", name="one more").status_code == 409
    client.delete(f"/api/v1/account/tokens/{ApiToken.objects.earliest('pk').pk}")
    assert post(client, "tokens", name="one more").status_code == 201


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("post", "tokens", {"name": "heir"}),
        ("post", "password", {"old_password": OLD, "new_password": NEW}),
        ("post", "sign-out-everywhere", {}),
        ("delete", "tokens/0", {}),
    ],
)
def test_a_lost_token_opens_no_other_door(user: User, method: str, path: str, body: dict[str, str]) -> None:
    token = create_api_token(user=user, name="lost", expires_at=timezone.now() + timedelta(days=1))
    bearer = Client(headers={"Authorization": f"Bearer {token}"})
    answer = getattr(bearer, method)(f"/api/v1/account/{path}", body, content_type="application/json")
    assert answer.status_code == 403
    assert answer.json()["error"]["message"] == "A token cannot do this. Sign in with a browser."


def test_somebody_sees_their_own_sign_ins_and_nobody_elses(client: Client, user: User) -> None:
    SignInEntry.objects.create(user=user, outcome="wrong", address="203.0.113.1", user_agent="Firefox")
    SignInEntry.objects.create(user=a_user(), outcome="signed-in")
    rows = client.get("/api/v1/account/sign-ins").json()["results"]
    assert [(row["username"], row["outcome"], row["address"]) for row in rows] == [(user.username, "wrong", "203.0.113.1")]


# --- each request in the reader's language and time zone ----------------------------------------------------------------------------


def test_the_page_says_what_its_scripts_need_to_know(client: Client) -> None:
    change(client, units="imperial", time_zone="Europe/Berlin", single_keys=False, theme="dark", language="de")
    html = client.get("/account").content.decode().partition(">")[2].partition(">")[0]
    for attribute in (
        'lang="de"',
        'data-units="imperial"',
        'data-time-zone="Europe/Berlin"',
        'data-single-keys="off"',
        'data-theme="dark"',
    ):
        assert attribute in html


def test_without_a_choice_the_browsers_language_counts(client: Client) -> None:
    german = client.get("/account", headers={"Accept-Language": "de-AT,de;q=0.9"})
    assert '<html lang="de"' in german.content.decode()
    assert "Accept-Language" in german["Vary"]
    assert '<html lang="en' in client.get("/account", headers={"Accept-Language": "nl"}).content.decode()
    assert '<html lang="de"' in Client().get("/sign-in", headers={"Accept-Language": "de"}).content.decode()


def test_a_chosen_language_stands_against_the_browsers(client: Client) -> None:
    change(client, language="en")
    assert '<html lang="en' in client.get("/account", headers={"Accept-Language": "de"}).content.decode()


def test_a_chosen_language_that_is_no_longer_offered_gives_way_to_the_browsers(client: Client) -> None:
    User.objects.update(language="it")
    assert '<html lang="de"' in client.get("/account", headers={"Accept-Language": "de"}).content.decode()


def test_times_of_the_api_stay_in_utc(client: Client) -> None:
    change(client, time_zone="Asia/Kathmandu")
    post(client, "tokens", name="export")
    assert client.get("/api/v1/account/tokens").json()["results"][0]["created_at"].endswith("Z")


def test_one_persons_language_does_not_stay_for_the_next(client: Client) -> None:
    change(client, language="de")
    client.get("/account")
    assert '<html lang="en' in Client().get("/sign-in").content.decode()


def test_a_visit_is_noted_once_a_minute(client: Client, user: User) -> None:
    client.get("/account")
    user.refresh_from_db()
    first = user.last_seen_at
    assert first is not None
    client.get("/account")
    user.refresh_from_db()
    assert user.last_seen_at == first
