"""People and the log of sign-ins, for administrators: found, changed, signed out, never without an administrator."""

from datetime import timedelta
from typing import Any

import pytest
from django.core.cache import cache
from django.http import HttpResponse
from django.test import Client
from django.utils import timezone

from accounts.login import forget_old_sign_ins
from tests.accounts.users import a_user, client_of
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken, AuditEntry, Organisation, Role, SignInEntry, User

pytestmark = pytest.mark.django_db


@pytest.fixture(autouse=True)
def _no_tries_yet(settings: Any) -> None:
    cache.clear()
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]  # nothing here is about how slow a hash is


@pytest.fixture
def administrator() -> User:
    User.objects.all().delete()
    return a_user(Role.ADMINISTRATOR)


@pytest.fixture
def client(administrator: User) -> Client:
    return client_of(administrator)


@pytest.fixture
def person() -> User:
    user = a_user(Role.OPERATOR)
    user.first_name, user.last_name, user.email = "Opal", "Field", "opal@example.org"
    user.save()
    return user


def change(client: Client, person: User, if_match: str = "*", **values: Any) -> HttpResponse:
    return client.patch(f"/api/v1/users/{person.pk}", values, content_type="application/json", headers={"If-Match": if_match})


def found(client: Client, query: str = "") -> set[str]:
    return {row["username"] for row in client.get(f"/api/v1/users?{query}").json()["results"]}


@pytest.mark.parametrize("text", ["opal", "FIELD op", "example.org", "operator-"])
def test_somebody_is_found_by_name_and_address(client: Client, administrator: User, person: User, text: str) -> None:
    assert found(client, f"text={text}") == {person.username}


def test_people_are_found_by_role_and_access(client: Client, administrator: User, person: User) -> None:
    kept_out = a_user(Role.VIEWER)
    User.objects.filter(pk=kept_out.pk).update(is_active=False)
    User.objects.filter(pk=person.pk).update(last_seen_at=timezone.now() - timedelta(minutes=6))
    assert found(client) == {administrator.username, person.username, kept_out.username}
    assert found(client, "role=operator") == {person.username}
    assert found(client, "access=out") == {kept_out.username}
    assert found(client, "access=in") == {administrator.username, person.username}
    assert found(client, "access=here") == {administrator.username}
    assert client.get("/api/v1/users?role=king").status_code == 400


def test_people_of_another_organisation_are_not_there(client: Client, administrator: User) -> None:
    other = a_user(Role.VIEWER, Organisation.objects.create(name="Others"))
    SignInEntry.objects.create(user=other, outcome="wrong")
    assert other.username not in found(client)
    assert client.get(f"/api/v1/users/{other.pk}").status_code == 404
    assert change(client, other, role="administrator").status_code == 404
    assert client.post(f"/api/v1/users/{other.pk}/sign-out").status_code == 404
    assert client.get("/api/v1/sign-ins").json()["results"] == []


def test_a_change_of_role_is_in_the_history(client: Client, administrator: User, person: User) -> None:
    answer = change(client, person, role="curator")
    assert (answer.status_code, answer.json()["role"]) == (200, "curator")
    entry = AuditEntry.objects.get(subject_type="user")
    assert (entry.actor, entry.before["role"], entry.after["role"]) == (administrator, "operator", "curator")


def test_of_two_administrators_nobody_overwrites_what_they_have_not_seen(client: Client, administrator: User, person: User) -> None:
    seen = client.get(f"/api/v1/users/{person.pk}")["ETag"]
    assert change(client, person, seen, role="curator").status_code == 200
    late = change(client, person, seen, role="viewer")
    assert late.status_code == 412
    assert late.json()["error"]["details"]["current"]["role"] == "curator"
    person.refresh_from_db()
    assert person.role == Role.CURATOR
    missing = client.patch(f"/api/v1/users/{person.pk}", {"role": "viewer"}, content_type="application/json")
    assert missing.status_code == 428


def test_a_visit_in_between_is_no_change(client: Client, administrator: User, person: User) -> None:
    seen = client.get(f"/api/v1/users/{person.pk}")["ETag"]
    client_of(person).get("/account")
    assert change(client, person, seen, last_name="Moss").status_code == 200


@pytest.mark.parametrize("values", [{"role": "viewer"}, {"is_active": False}])
def test_the_last_administrator_stays(client: Client, administrator: User, values: dict[str, Any]) -> None:
    answer = change(client, administrator, **values)
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "no_administrator_left")
    administrator.refresh_from_db()
    assert (administrator.role, administrator.is_active) == (Role.ADMINISTRATOR, True)


def test_whoever_is_kept_out_is_out_at_once_with_session_and_token(client: Client, administrator: User, person: User) -> None:
    token = create_api_token(user=person, name="api", expires_at=timezone.now() + timedelta(days=1))
    at_work = client_of(person)
    assert at_work.get("/api/v1/account").status_code == 200
    change(client, person, is_active=False)
    assert at_work.get("/api/v1/account").status_code == 401
    assert Client(headers={"Authorization": f"Bearer {token}"}).get("/api/v1/account").status_code == 401
    change(client, person, is_active=True)
    assert Client(headers={"Authorization": f"Bearer {token}"}).get("/api/v1/account").status_code == 200


def test_a_token_gives_nobody_a_role(administrator: User, person: User) -> None:
    token = create_api_token(user=administrator, name="api", expires_at=timezone.now() + timedelta(days=1))
    program = Client(headers={"Authorization": f"Bearer {token}", "If-Match": "*"})
    assert program.get(f"/api/v1/users/{person.pk}").status_code == 200
    answer = program.patch(f"/api/v1/users/{person.pk}", {"role": "administrator"}, content_type="application/json")
    assert (answer.status_code, answer.json()["error"]["message"]) == (403, "A token cannot do this. Sign in with a browser.")
    assert program.post("/api/v1/invitations", {"role": "administrator"}, content_type="application/json").status_code == 403
    person.refresh_from_db()
    assert person.role == Role.OPERATOR


def test_an_administrator_ends_somebodys_sessions_and_tokens(client: Client, administrator: User, person: User) -> None:
    create_api_token(user=person, name="api", expires_at=timezone.now() + timedelta(days=1))
    at_work = client_of(person)
    assert client.get(f"/api/v1/users/{person.pk}").json()["valid_tokens"] == 1
    assert client.post(f"/api/v1/users/{person.pk}/sign-out").status_code == 204
    assert at_work.get("/api/v1/account").status_code == 401
    assert client.delete(f"/api/v1/users/{person.pk}/tokens").status_code == 204
    assert client.get(f"/api/v1/users/{person.pk}").json()["valid_tokens"] == 0
    assert ApiToken.objects.get().revoked_at is not None


def test_people_come_page_by_page(client: Client, administrator: User) -> None:
    for _ in range(4):
        a_user(Role.VIEWER)
    first = client.get("/api/v1/users?limit=3").json()
    rest = client.get(first["next"]).json()
    names = [row["username"] for row in first["results"] + rest["results"]]
    assert names == sorted(names) and len(names) == 5
    assert rest["next"] is None


def test_no_answer_holds_a_password_or_its_hash(client: Client, administrator: User, person: User) -> None:
    person.set_password("inspect-the-lines")
    person.save()
    answers = client.get("/api/v1/users").content + client.get(f"/api/v1/users/{person.pk}").content
    assert person.password.encode() not in answers and b"password" not in answers and b"session_generation" not in answers


# --- the log -----------------------------------------------------------------------------------------------------------------------


def test_the_log_is_found_by_person_outcome_address_and_time(client: Client, administrator: User, person: User) -> None:
    SignInEntry.objects.create(user=person, outcome="signed-in", address="203.0.113.1")
    SignInEntry.objects.create(user=None, outcome="wrong", address="198.51.100.7")
    old = SignInEntry.objects.create(user=person, outcome="signed-out", address="203.0.113.1")
    SignInEntry.objects.filter(pk=old.pk).update(recorded_at=timezone.now() - timedelta(days=3))

    def outcomes(query: str = "") -> list[str]:
        return [row["outcome"] for row in client.get(f"/api/v1/sign-ins?{query}").json()["results"]]

    assert outcomes() == ["wrong", "signed-in", "signed-out"]
    assert outcomes("text=opal") == ["signed-in", "signed-out"]
    assert outcomes("outcome=wrong") == ["wrong"]
    assert outcomes("address=198.51") == ["wrong"]
    assert outcomes("days=2") == ["wrong", "signed-in"]
    assert client.get("/api/v1/sign-ins?days=soon").status_code == 400
    assert client.get("/api/v1/sign-ins?outcome=odd").status_code == 400


def test_what_is_older_than_the_log_is_kept_goes(settings: Any, person: User) -> None:
    settings.SIGN_IN_LOG_DAYS = 30
    kept, gone = (SignInEntry.objects.create(user=person, outcome="signed-in") for _ in range(2))
    SignInEntry.objects.filter(pk=gone.pk).update(recorded_at=timezone.now() - timedelta(days=31))
    assert forget_old_sign_ins() == 1
    assert list(SignInEntry.objects.values_list("pk", flat=True)) == [kept.pk]
