"""The admin shows approvals, commands and unknown vehicles, and changes none of them."""

import pytest
from django.utils import timezone

from missions.models import Approval, UavCommand
from telemetry.models import UnknownVehicle
from tests.accounts.users import a_user, client_of
from tests.missions.flights import an_operator, carry, dispatched, fleet
from tests.missions.worlds import world
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def rows() -> dict[str, object]:
    (uav,) = fleet("Tern")
    dispatched(an_operator(), [uav], world().towers[:2])
    carry(uav)
    vehicle = UnknownVehicle.objects.create(mavlink_system_id=99, last_message_at=timezone.now())
    return {
        "missions/approval": Approval.objects.get().pk,
        "missions/uavcommand": UavCommand.objects.get().pk,
        "telemetry/unknownvehicle": vehicle.pk,
    }


def test_what_uavs_were_told_is_shown_and_not_changed(rows):
    client = client_of(a_user(Role.ADMINISTRATOR))
    for path, key in rows.items():
        listed = client.get(f"/admin/{path}/")
        assert listed.status_code == 200, path
        assert client.get(f"/admin/{path}/?q=Tern").status_code == 200
        assert client.get(f"/admin/{path}/{key}/change/").status_code == 200
        assert client.post(f"/admin/{path}/{key}/change/", {"state": "failed"}).status_code == 403
        assert client.get(f"/admin/{path}/add/").status_code == 403
        assert client.post(f"/admin/{path}/{key}/delete/", {"post": "yes"}).status_code == 403
    command = client.get(f"/admin/missions/uavcommand/{rows['missions/uavcommand']}/change/").content.decode()
    assert "Tern" in command and "applied" in command.lower()
    assert '"routes"' not in client.get(f"/admin/missions/approval/{rows['missions/approval']}/change/").content.decode()


@pytest.mark.parametrize("role", [Role.OPERATOR, Role.VIEWER])
def test_nobody_else_sees_it(role, rows):
    client = client_of(a_user(role))
    for path in rows:
        assert client.get(f"/admin/{path}/").status_code in (302, 403)
    assert client.get("/api/v1/unknown-vehicles").status_code == 403
