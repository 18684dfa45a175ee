"""An administrator names the organisation and its time zone, in which pages show times to users who chose none."""

from typing import Any

import pytest
from django.test import Client

from accounts.identity_claims import IdentityProvider
from tests.accounts.users import a_user, client_of
from workspace.models import AuditEntry, BrowserSession, Organisation, Role

pytestmark = pytest.mark.django_db


def change(client: Client, etag: str = "*", **values: Any) -> Any:
    headers = {"If-Match": etag}
    return client.patch("/api/v1/organisation", values, content_type="application/json", headers=headers)


def zone_of_page(client: Client) -> str:
    head = client.get("/account").content.decode().partition("<html ")[2].partition(">")[0]
    return head.partition('data-time-zone="')[2].partition('"')[0]


def test_an_administrator_changes_name_and_zone_and_the_history_has_both() -> None:
    admin = a_user(Role.ADMINISTRATOR)
    answer = change(client_of(admin), name="Columbus Power", time_zone="America/New_York")
    assert answer.status_code == 200
    assert answer.json() == {"name": "Columbus Power", "time_zone": "America/New_York", "revision": 2}
    assert client_of(a_user()).get("/api/v1/organisation").json()["name"] == "Columbus Power"
    entry = AuditEntry.objects.get(subject_type="organisation")
    assert (entry.actor, entry.after) == (admin, {"name": "Columbus Power", "time_zone": "America/New_York"})
    assert entry.before == {"name": "Default", "time_zone": ""}


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR, Role.CURATOR])
def test_nobody_else_does(role: Role) -> None:
    assert change(client_of(a_user(role)), name="Mine").status_code == 403
    assert Organisation.objects.get(pk=1).name == "Default"


@pytest.mark.parametrize("values", [{"time_zone": "Mars/Olympus"}, {"name": ""}, {"name": "x" * 201}, {"name": "Taken"}])
def test_what_cannot_be_is_refused_with_its_place(values: dict[str, str]) -> None:
    Organisation.objects.create(name="Taken")
    answer = change(client_of(a_user(Role.ADMINISTRATOR)), **values)
    assert answer.status_code == 400
    assert list(answer.json()["error"]["details"]) == list(values)


def test_a_change_of_another_administrator_meanwhile_is_told() -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    seen = client.get("/api/v1/organisation")["ETag"]
    change(client, name="Columbus Power")
    answer = change(client, seen, name="Ohio Power")
    assert answer.status_code == 412
    assert answer.json()["error"]["details"]["current"]["name"] == "Columbus Power"
    assert client.patch("/api/v1/organisation", {"name": "A"}, content_type="application/json").status_code == 428


def test_its_zone_is_of_users_who_chose_none() -> None:
    user = a_user()
    client = client_of(user)
    assert zone_of_page(client) == ""
    Organisation.objects.update(time_zone="America/New_York")
    assert zone_of_page(client) == "America/New_York"
    assert 'data-zone="America/New_York"' in client.get("/account").content.decode()
    user.time_zone = "Asia/Kathmandu"
    user.save(update_fields=["time_zone"])
    assert zone_of_page(client) == "Asia/Kathmandu"


@pytest.mark.parametrize(
    ("address", "place"),
    [
        ("127.0.0.1", "this-machine"), ("10.1.2.3", "private-network"), ("203.0.113.9", "private-network"), ("8.8.8.8", "internet"),
        ("2001:4860:4860::8888", "internet"), ("fd00::1", "private-network"),
    ],
)  # fmt: skip
def test_sessions_tell_address_and_place(address: str, place: str) -> None:
    client = client_of(a_user())
    client.get("/account", REMOTE_ADDR=address)
    (session,) = client.get("/api/v1/account/sessions", REMOTE_ADDR=address).json()["results"]
    assert (session["address"], session["place"]) == (address, place)


def test_a_session_of_the_version_before_has_no_address_until_it_is_used() -> None:
    client = client_of(a_user())
    client.get("/account", REMOTE_ADDR="10.1.2.3")
    BrowserSession.objects.update(address=None)
    (session,) = client.get("/api/v1/account/sessions").json()["results"]
    assert (session["address"], session["place"]) == (None, None)


def test_an_address_behind_an_untrusted_proxy_is_the_peers() -> None:
    client = client_of(a_user())
    client.get("/account", REMOTE_ADDR="8.8.8.8", headers={"X-Forwarded-For": "10.0.0.1"})
    assert BrowserSession.objects.get().address == "8.8.8.8"


@pytest.mark.parametrize(("claim", "status"), [("tenant", 409), ("", 200)])
def test_a_name_by_which_the_identity_provider_assigns_users_stays(claim: str, status: int, settings: Any) -> None:
    settings.IDENTITY_PROVIDER = IdentityProvider(
        issuer="https://id.example", client_id="spanwise", client_secret="any", name="Grid ID", role_claim="groups",
        roles={"admins": "administrator"}, organisation_claim=claim, organisations={"d": "Default"} if claim else {},
    )  # fmt: skip
    client = client_of(a_user(Role.ADMINISTRATOR))
    answer = change(client, name="Columbus Power")
    assert answer.status_code == status
    if claim:
        assert answer.json()["error"]["code"] == "name_of_provider"
        assert Organisation.objects.get(pk=1).name == "Default"
        assert change(client, name="Default", time_zone="America/New_York").status_code == 200
