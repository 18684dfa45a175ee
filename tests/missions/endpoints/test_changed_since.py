"""`?changed_since=`: what was made or changed since a moment, so that a mirror need not read everything again."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.test import Client

from inspection.models import Asset, NoFlyZone
from missions.models import Base, Mission, Uav, UavType
from tests.accounts.users import a_user, client_of
from tests.missions.commands.outbox import a_uav
from tests.missions.worlds import world, zone_around
from workspace.models import Organisation

pytestmark = pytest.mark.django_db
LISTS = {"assets": Asset, "zones": NoFlyZone, "missions": Mission, "uavs": Uav, "uav-types": UavType, "bases": Base}
LONG_AGO = datetime(2020, 1, 1, tzinfo=UTC)


@pytest.fixture
def client() -> Client:
    world()
    zone_around((10.0, 56.1))
    a_uav("Tern")
    user, organisation = a_user(), Organisation.objects.get()
    Mission.objects.create(organisation=organisation, author=user, name="Line 7")
    UavType.objects.create(organisation=organisation, name="Quad")
    Base.objects.create(organisation=organisation, name="North", location="SRID=4326;POINT(10 56)")
    return client_of(user)


def rows(client: Client, name: str, since: Any) -> Any:
    answer = client.get(f"/api/v1/{name}", {"changed_since": since})
    assert answer.status_code == 200, answer.content
    return answer.json().get("results", answer.json().get("features"))


@pytest.mark.parametrize("name", LISTS)
def test_a_list_has_only_what_was_changed_since(client: Client, name: str) -> None:
    now = datetime.now(UTC)
    assert rows(client, name, (now - timedelta(hours=1)).isoformat())
    assert not rows(client, name, (now + timedelta(hours=1)).isoformat())
    LISTS[name].objects.update(updated_at=LONG_AGO)
    assert not rows(client, name, (now - timedelta(hours=1)).isoformat())
    assert rows(client, name, LONG_AGO.isoformat()), "the moment itself belongs to it"


def test_the_uavs_of_a_base_that_was_renamed_were_changed(client: Client) -> None:
    base = Base.objects.get()
    Uav.objects.update(base=base, base_name=base.name, updated_at=LONG_AGO)
    change = client.patch(f"/api/v1/bases/{base.pk}", {"name": "South"}, content_type="application/json", headers={"If-Match": "*"})
    assert change.status_code == 200
    [uav] = rows(client, "uavs", (datetime.now(UTC) - timedelta(hours=1)).isoformat())
    assert uav["properties"]["base_name"] == "South"


@pytest.mark.parametrize("since", ["yesterday", "2026-02-30", "2026-02-30T10:00:00Z"])
@pytest.mark.parametrize("name", LISTS)
def test_what_is_no_moment_is_refused(client: Client, name: str, since: str) -> None:
    answer = client.get(f"/api/v1/{name}", {"changed_since": since})
    assert (answer.status_code, list(answer.json()["error"]["details"])) == (400, ["changed_since"])
