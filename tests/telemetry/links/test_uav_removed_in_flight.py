"""A UAV that flies is neither deleted nor retired, by the API or in the admin."""

import pytest
from django.http import HttpResponse
from django.test import Client
from django.utils import timezone

from missions.models import CommandKind, Uav
from missions.services.commands.commands import queue_command
from telemetry.models import UavLink
from tests.accounts.users import a_user, client_of
from tests.missions.api import patch
from tests.missions.commands.outbox import a_uav
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return a_uav("Kite")


@pytest.fixture
def administrator() -> Client:
    return client_of(a_user(Role.ADMINISTRATOR))


def delete(client: Client, uav: Uav) -> HttpResponse:
    return client.delete(f"/api/v1/uavs/{uav.pk}", headers={"If-Match": "*"})


def fly(uav: Uav, *, is_in_air: bool = True) -> None:
    UavLink.objects.update_or_create(uav=uav, defaults={"is_armed": is_in_air, "is_in_air": is_in_air, "last_message_at": timezone.now()})


def test_by_the_api(uav: Uav, administrator: Client) -> None:
    fly(uav)
    refused = [delete(administrator, uav), patch(administrator, f"uavs/{uav.pk}", {"state": "retired"})]
    assert [(answer.status_code, answer.json()["error"]["code"]) for answer in refused] == [(409, "in_flight")] * 2
    assert {answer.json()["error"]["message"] for answer in refused} == {
        "Kite is in the air. It can be retired or deleted once it has landed."
    }
    assert Uav.objects.get(pk=uav.pk).state == "active"
    fly(uav, is_in_air=False)
    assert delete(administrator, uav).status_code == 204


def test_with_a_command_on_its_way(uav: Uav, administrator: Client) -> None:
    queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
    refused = delete(administrator, uav)
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "commands_waiting")


@pytest.mark.parametrize("by_action", [False, True])
def test_in_the_admin(uav: Uav, administrator: Client, by_action: bool) -> None:
    other = a_uav("Gull")
    fly(uav)
    path, sent = f"/admin/missions/uav/{uav.pk}/delete/", {"post": "yes"}
    if by_action:
        path, sent = "/admin/missions/uav/", {"action": "delete_selected", "_selected_action": [uav.pk, other.pk], "post": "yes"}
    answer = administrator.post(path, sent)
    assert "Kite is in the air. It can be retired or deleted once it has landed." in answer.content.decode()
    assert Uav.objects.filter(pk__in=[uav.pk, other.pk]).count() == 2
    fly(uav, is_in_air=False)
    administrator.post(path, sent)
    assert not Uav.objects.filter(pk=uav.pk).exists()
