"""Accounts for programs: made by administrators, used by tokens alone, ended by no person's leaving."""

from datetime import timedelta
from io import StringIO
from typing import Any

import pytest
from django.contrib.auth import authenticate
from django.core.management import CommandError, call_command
from django.db import IntegrityError, transaction
from django.test import Client
from django.utils import timezone

from accounts.services import make_service_account
from accounts.users import NoAdministratorLeft, delete_user, save_user
from tests.accounts.users import a_user, client_of
from tests.workspace.api.described_answers import openapi_document
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken, AuditEntry, Organisation, Role, User

pytestmark = pytest.mark.django_db
ACCOUNTS = "/api/v1/service-accounts"
PASSWORD = "correct horse 9"


@pytest.fixture(autouse=True)
def _quick_hashes(settings: Any) -> None:
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]  # nothing here is about how slow a hash is


@pytest.fixture
def administrator() -> User:
    user = a_user(Role.ADMINISTRATOR)
    user.set_password(PASSWORD)
    user.save()
    return user


@pytest.fixture
def client(administrator: User) -> Client:
    """Signed in, with the password just said."""
    client = client_of(administrator)
    client.post("/api/v1/account/proof", {"password": PASSWORD}, content_type="application/json")
    return client


def send(client: Client, method: str, path: str, body: Any = None, if_match: str = "*") -> Any:
    return getattr(client, method)(path, body or {}, content_type="application/json", headers={"If-Match": if_match})


def made(client: Client, role: str = "operator", name: str = "erp") -> dict[str, Any]:
    answer = send(client, "post", ACCOUNTS, {"name": name, "role": role})
    assert answer.status_code == 201, answer.content
    account: dict[str, Any] = answer.json()
    assert answer["Location"] == f"{ACCOUNTS}/{account['id']}"
    return account


def program(client: Client, account: dict[str, Any], **body: Any) -> Client:
    """A program that holds a new token of the account."""
    answer = send(client, "post", f"{ACCOUNTS}/{account['id']}/tokens", {"name": "night run", **body})
    assert answer.status_code == 201, answer.content
    assert answer["Cache-Control"] == "no-store"
    return Client(headers={"Authorization": f"Bearer {answer.json()['token']}"}, raise_request_exception=False)


def test_an_administrator_makes_one_and_a_program_works_with_it(client: Client) -> None:
    account = made(client)
    assert (account["name"], account["role"], account["is_active"], account["valid_tokens"]) == ("erp", "operator", True, 0)
    asks = program(client, account, scopes=["read", "plan"])
    mission = send(asks, "post", "/api/v1/missions", {"name": "Line 4"})
    assert mission.status_code == 201, mission.content
    [row] = client.get(ACCOUNTS).json()["results"]
    assert row["valid_tokens"] == 1
    assert row["last_used_at"] is not None
    [entry] = client.get("/api/v1/missions").json()["results"]
    assert entry["author"] == account["username"] == "service:1:erp"


def test_its_tokens_have_scopes_within_its_role(client: Client) -> None:
    account = made(client, role="viewer")
    path = f"{ACCOUNTS}/{account['id']}/tokens"
    assert send(client, "post", path, {"name": "x", "scopes": ["plan"]}).status_code == 400
    asks = program(client, account)
    assert asks.get("/api/v1/missions").status_code == 200
    assert send(asks, "post", "/api/v1/missions", {"name": "Line 4"}).status_code == 403


def test_nobody_signs_in_with_one(client: Client, administrator: User) -> None:
    account = User.objects.get(pk=made(client, role="administrator")["id"])
    assert not account.has_usable_password()
    assert authenticate(username=account.username, password="") is None
    visitor = Client(raise_request_exception=False)
    visitor.force_login(account)  # as if a session had been made by a fault elsewhere
    assert visitor.get("/api/v1/missions").status_code in {401, 403}
    assert visitor.get("/account").status_code == 302
    assert visitor.get("/admin/").status_code == 302
    with pytest.raises(IntegrityError), transaction.atomic():
        User.objects.filter(pk=account.pk).update(password=administrator.password)
    with pytest.raises(IntegrityError), transaction.atomic():
        User.objects.filter(pk=account.pk).update(is_installation_operator=True)
    with pytest.raises(CommandError):
        call_command("installation_operator", account.username)


def test_no_person_can_have_the_name_of_one(client: Client) -> None:
    account = User.objects.get(pk=made(client)["id"])
    with pytest.raises(Exception, match="username"):
        User(username=account.username.replace("erp", "other"), password="!").clean_fields()


def test_a_disabled_one_does_nothing_until_it_is_enabled_again(client: Client) -> None:
    account = made(client)
    asks = program(client, account)
    path = f"{ACCOUNTS}/{account['id']}"
    assert send(client, "patch", path, {"is_active": False}, if_match='"1"').status_code == 412
    assert send(client, "patch", path, {"is_active": False}, if_match=f'"{account["revision"]}"').status_code == 200
    assert asks.get("/api/v1/missions").status_code == 401
    assert send(client, "patch", path, {"is_active": True}).status_code == 200
    assert asks.get("/api/v1/missions").status_code == 200


def test_a_smaller_role_takes_the_scopes_beyond_it(client: Client) -> None:
    account = made(client)
    asks = program(client, account)
    assert send(client, "patch", f"{ACCOUNTS}/{account['id']}", {"role": "viewer"}).status_code == 200
    assert send(asks, "post", "/api/v1/missions", {"name": "Line 4"}).status_code == 403


def test_a_token_is_revoked_alone(client: Client) -> None:
    account = made(client)
    first, second = program(client, account), program(client, account)
    token = ApiToken.objects.filter(user=account["id"]).order_by("pk")[0]
    assert send(client, "delete", f"{ACCOUNTS}/{account['id']}/tokens/{token.pk}").json()["is_valid"] is False
    assert (first.get("/api/v1/missions").status_code, second.get("/api/v1/missions").status_code) == (401, 200)
    own = ApiToken.objects.create(user=a_user(), token_sha256="a" * 64, expires_at=timezone.now() + timedelta(days=1))
    assert send(client, "delete", f"{ACCOUNTS}/{account['id']}/tokens/{own.pk}").status_code == 404, "a person's"


def test_it_stays_when_whoever_made_it_is_gone(client: Client, administrator: User) -> None:
    asks = program(client, made(client))
    other = a_user(Role.ADMINISTRATOR)
    delete_user(user=administrator, actor=other)
    assert asks.get("/api/v1/missions").status_code == 200


def test_it_is_no_administrator_that_is_left(client: Client, administrator: User) -> None:
    made(client, role="administrator")
    User.objects.exclude(pk=administrator.pk).filter(is_service=False).delete()
    administrator.is_active = False
    with pytest.raises(NoAdministratorLeft):
        save_user(user=administrator, actor=administrator)


def test_a_token_is_made_within_a_quarter_of_an_hour_of_the_password_alone(client: Client, administrator: User) -> None:
    account = made(client)
    late = client_of(administrator)
    late.get("/api/v1/account")  # by which the session begins
    User.objects.get(pk=administrator.pk).browser_sessions.update(began_at=timezone.now() - timedelta(hours=1))
    answer = send(late, "post", f"{ACCOUNTS}/{account['id']}/tokens", {"name": "x"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (403, "password_needed")


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR, Role.CURATOR])
def test_administrators_alone_see_them(client: Client, role: Role) -> None:
    account = made(client)
    other = client_of(a_user(role))
    assert other.get(ACCOUNTS).status_code == 403
    assert send(other, "post", ACCOUNTS, {"name": "mine", "role": "viewer"}).status_code == 403
    assert send(other, "post", f"{ACCOUNTS}/{account['id']}/tokens", {"name": "mine"}).status_code == 403


PEOPLE = ("/api/v1/users", "/api/v1/invitations", "/api/v1/service-accounts", "/api/v1/account", "/api/v1/second-factor-rule",
          "/api/v1/rehearsal-rule")  # fmt: skip


def test_it_changes_no_people_sessions_tokens_and_rules(client: Client) -> None:
    """Every operation that writes there, of the OpenAPI document."""
    asks = program(client, made(client, role="administrator"))
    walked = 0
    for path, methods in openapi_document()["paths"].items():
        for method in set(methods) & {"post", "put", "patch", "delete"}:
            if path.startswith(PEOPLE):
                address = path.replace("{", "").replace("}", "")
                for name in ("user_id", "invitation_id", "account_id", "token_id", "session_id", "passkey_id"):
                    address = address.replace(name, "1")
                assert send(asks, method, address).status_code == 403, (method, path)
                walked += 1
    assert walked >= 18
    assert not AuditEntry.objects.filter(actor__is_service=True).exists()


def test_people_and_programs_are_apart(client: Client) -> None:
    account = made(client)
    assert account["username"] not in {row["username"] for row in client.get("/api/v1/users").json()["results"]}
    assert send(client, "patch", f"/api/v1/users/{account['id']}", {"email": "a@example.org"}).status_code == 404
    person = a_user()
    assert client.get(f"{ACCOUNTS}/{person.pk}").status_code == 404


def test_two_of_one_name_and_odd_names_are_refused(client: Client) -> None:
    made(client)
    answer = send(client, "post", ACCOUNTS, {"name": "ERP", "role": "viewer"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "name_taken")
    for name in ("", "a b", "a:b", "-a", "ä", "a\nb", "x" * 61):
        assert send(client, "post", ACCOUNTS, {"name": name, "role": "viewer"}).status_code == 400, name


def test_the_history_names_the_account_and_who_made_it(client: Client, administrator: User) -> None:
    account = made(client)
    asks = program(client, account)
    send(client, "patch", f"{ACCOUNTS}/{account['id']}", {"is_active": False})
    about = AuditEntry.objects.filter(subject_type="user", subject_id=str(account["id"])).order_by("pk")
    assert [(entry.actor, entry.action) for entry in about] == [(administrator, "created"), (administrator, "changed")]
    token = AuditEntry.objects.get(subject_type="token", action="created")
    assert (token.actor, token.after["of"]) == (administrator, "service:1:erp")
    send(client, "patch", f"{ACCOUNTS}/{account['id']}", {"is_active": True})
    send(asks, "post", "/api/v1/missions", {"name": "Line 4"})
    done = AuditEntry.objects.filter(subject_type="mission").latest("pk")
    assert done.actor is not None
    assert done.actor.username == "service:1:erp"


def test_the_admin_gives_it_no_address_and_no_other_name(client: Client) -> None:
    account = make_service_account(actor=a_user(Role.ADMINISTRATOR), name="crm", role=Role.VIEWER)
    page = client.get(f"/admin/workspace/user/{account.pk}/change/").content.decode()
    assert 'name="role"' in page
    assert not any(f'name="{name}"' in page for name in ("username", "email", "password"))


def test_the_command_makes_a_token_of_one() -> None:
    account = make_service_account(actor=a_user(Role.ADMINISTRATOR), name="crm", role=Role.VIEWER)
    call_command("api_token", account.username, stdout=StringIO())
    assert ApiToken.objects.get().user == account


def test_another_organisations_are_not_there(client: Client) -> None:
    stranger = a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Elsewhere"))
    account = make_service_account(actor=stranger, name="erp", role=Role.VIEWER)
    made(client)
    create_api_token(user=account, name="x", expires_at=timezone.now() + timedelta(days=1))
    assert client.get(f"{ACCOUNTS}/{account.pk}").status_code == 404
    assert send(client, "post", f"{ACCOUNTS}/{account.pk}/tokens", {"name": "x"}).status_code == 404
