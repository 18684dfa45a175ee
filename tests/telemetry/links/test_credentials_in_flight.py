"""S2: no request of a moment makes a UAV deaf that flies, or to which a command is on its way."""

from datetime import timedelta

import pytest
from django.test import Client
from django.utils import timezone

from missions.models import CommandKind, Uav, UavCredential
from missions.services.commands.commands import queue_command
from missions.services.fleet.credentials import note_mavlink_key_use
from telemetry.models import UavLink
from tests.accounts.users import a_user, client_of
from tests.telemetry.links.uav_clients import linked_uav, report
from workspace.api_tokens import create_api_token
from workspace.models import AuditEntry, Role
from workspace.sign_in_models import BrowserSession

pytestmark = pytest.mark.django_db


@pytest.fixture(params=["mavlink-key", "link-token"])
def kind(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def uav(kind: str) -> Uav:
    uav = linked_uav().uav
    client = client_of(a_user(Role.ADMINISTRATOR))
    if kind == "mavlink-key":
        assert make(client, uav, kind).status_code == 201
    note_mavlink_key_use(credential_ids=UavCredential.objects.values_list("pk", flat=True))
    return uav


def make(client: Client, uav: Uav, kind: str, **more: str):
    return client.post(f"/api/v1/uavs/{uav.pk}/credentials", {"kind": kind, **more}, content_type="application/json")


def revoke(client: Client, uav: Uav, kind: str, query: str = ""):
    credential = uav.credentials.get(kind=kind, revoked_at=None)
    return client.delete(f"/api/v1/uavs/{uav.pk}/credentials/{credential.pk}{query}")


def fly(uav: Uav) -> None:
    UavLink.objects.update_or_create(uav=uav, defaults={"is_armed": True, "is_in_air": True, "last_message_at": timezone.now()})


@pytest.mark.parametrize("role", [Role.OPERATOR, Role.ADMINISTRATOR])
def test_in_flight_neither_is_replaced_nor_revoked(uav: Uav, kind: str, role: Role) -> None:
    fly(uav)
    client = client_of(a_user(role))
    answers = [make(client, uav, kind), revoke(client, uav, kind)]
    assert [(answer.status_code, answer.json()["error"]["code"]) for answer in answers] == [(409, "in_flight")] * 2
    assert uav.credentials.filter(kind=kind, revoked_at=None, replaced_at=None).count() == 1


def test_with_a_command_on_its_way_neither_is_replaced_nor_revoked(uav: Uav, kind: str) -> None:
    queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
    client = client_of(a_user(Role.ADMINISTRATOR))
    assert [answer.json()["error"]["code"] for answer in (make(client, uav, kind), revoke(client, uav, kind))] == ["commands_waiting"] * 2


def test_an_administrator_insists_with_a_reason_and_nobody_else_does(uav: Uav, kind: str) -> None:
    fly(uav)
    operator, administrator = client_of(a_user(Role.OPERATOR)), client_of(a_user(Role.ADMINISTRATOR))
    refused = [make(operator, uav, kind, insist_reason="stolen"), revoke(operator, uav, kind, "?insist_reason=stolen")]
    assert [answer.status_code for answer in refused] == [403, 403]
    assert revoke(administrator, uav, kind, "?insist_reason=stolen").status_code == 204
    assert not uav.credentials.filter(kind=kind, revoked_at=None).exists()
    assert AuditEntry.objects.filter(subject_type="uav_credential", action="revoke").get().after["insisted"] == "stolen"


def test_the_first_one_is_made_in_flight_as_well(kind: str) -> None:
    uav = linked_uav().uav
    UavCredential.objects.all().delete()
    fly(uav)
    assert make(client_of(a_user(Role.OPERATOR)), uav, kind).status_code == 201


def test_one_that_was_heard_in_the_air_long_ago_is_not_in_flight(uav: Uav, kind: str) -> None:
    fly(uav)
    UavLink.objects.update(last_message_at=timezone.now() - timedelta(hours=2))
    assert make(client_of(a_user(Role.OPERATOR)), uav, kind).status_code == 201


@pytest.mark.parametrize(("is_simulated", "status"), [(False, 409), (True, 200)])
def test_a_uav_that_flies_is_not_retired_unless_it_is_simulated(is_simulated: bool, status: int) -> None:
    uav = linked_uav().uav
    Uav.objects.update(is_simulated=is_simulated)
    fly(uav)
    answer = client_of(a_user(Role.ADMINISTRATOR)).patch(
        f"/api/v1/uavs/{uav.pk}", {"state": "retired"}, content_type="application/json", headers={"If-Match": "*"}
    )
    assert answer.status_code == status
    assert (Uav.objects.get().state == "retired") is is_simulated


def test_a_token_of_a_person_makes_and_revokes_none(uav: Uav, kind: str) -> None:
    token = create_api_token(user=a_user(Role.ADMINISTRATOR), name="script", expires_at=timezone.now() + timedelta(days=1))
    client = Client(headers={"Authorization": f"Bearer {token}"})
    assert [answer.status_code for answer in (make(client, uav, kind), revoke(client, uav, kind))] == [403, 403]


def test_the_password_is_asked_for_again(uav: Uav, kind: str) -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    assert client.get("/api/v1/account").status_code == 200
    BrowserSession.objects.update(began_at=timezone.now() - timedelta(minutes=16))
    assert [answer.json()["error"]["code"] for answer in (make(client, uav, kind), revoke(client, uav, kind))] == ["password_needed"] * 2


def test_a_companions_old_token_counts_until_the_new_one_is_used() -> None:
    kite = linked_uav()
    assert kite.report(report()).status_code == 200
    secret = make(client_of(a_user(Role.OPERATOR)), kite.uav, "link-token").json()["secret"]
    assert kite.report(report(2)).status_code == 200
    old, kite.token = kite.token, secret
    assert kite.report(report(3)).status_code == 200
    kite.token = old
    assert kite.report(report(4)).status_code == 401
