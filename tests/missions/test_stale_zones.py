"""A zone that comes in marks the missions that meet it: at their height, and at their time where they have one."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from inspection.services import mark_ground_changed
from missions.models import Mission, Route, Waypoint
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, post
from tests.missions.worlds import World, zone_around
from workspace.models import Role

pytestmark = pytest.mark.django_db

MONDAY_NOON = datetime(2026, 11, 23, 12, tzinfo=UTC)
A_LEG_S = 60.0


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def planned(client: Client, here: World, departs_at: datetime | None = None) -> dict[str, Any]:
    """To the second and the last tower at 60 m; with a departure each waypoint is reached a minute after the one before."""
    mission = post(client, "missions", mission_body(here.towers[1], here.towers[5], plan=True)).json()
    if departs_at is not None:
        Mission.objects.update(departs_at=departs_at)
        for waypoint in Waypoint.objects.all():
            Waypoint.objects.filter(pk=waypoint.pk).update(arrival_s=A_LEG_S * (waypoint.sequence + 1))
        Route.objects.update(departs_s=0.0, duration_s=A_LEG_S * (Waypoint.objects.count() + 1))
    return mission


def change(zone: NoFlyZone, **facts: Any) -> None:
    NoFlyZone.objects.filter(pk=zone.pk).update(**facts)
    mark_ground_changed()


def causes(client: Client, mission: dict[str, Any]) -> list[dict[str, Any]]:
    found = client.get(f"/api/v1/missions/{mission['id']}").json()
    return [cause for cause in found["stale_causes"] if cause["what"] == "zone"]


def hours(day: str, start: str, end: str) -> list[dict[str, Any]]:
    entry = {"day": [day], "startTime": f"{start}:00Z", "startEvent": None, "endTime": f"{end}:00Z", "endEvent": None}
    return [{"startDateTime": None, "endDateTime": None, "schedule": [entry]}]


def test_a_zone_above_the_flight_and_its_margin_marks_nothing(here: World, client: Client) -> None:
    """60 m of flight, 10 m of terrain tolerance and 10 m of margin."""
    mission = planned(client, here)
    zone = zone_around((10.012, 56.0), name="Fire brigade", with_graph=False)
    change(zone, lower_limit_m=81.0, lower_reference="AGL")
    assert causes(client, mission) == []
    change(zone, lower_limit_m=79.0, lower_reference="AGL")
    assert len(causes(client, mission)) == 1
    change(zone, lower_limit_m=5_000.0, lower_reference="AMSL")  # without terrain nobody knows
    assert len(causes(client, mission)) == 1


def test_a_mission_at_no_time_in_particular_meets_a_zone_of_any_time(here: World, client: Client) -> None:
    mission = planned(client, here)
    change(zone_around((10.012, 56.0), with_graph=False), schedule=hours("SAT", "10:00", "11:00"))
    assert len(causes(client, mission)) == 1


def test_a_mission_with_a_departure_meets_it_at_its_time_alone(here: World, client: Client) -> None:
    mission = planned(client, here, MONDAY_NOON)
    zone = zone_around((10.012, 56.0), name="Fire brigade", with_graph=False)
    change(zone, schedule=hours("MON", "09:00", "11:54"))
    assert causes(client, mission) == []
    change(zone, schedule=hours("MON", "09:00", "13:00"))
    [cause] = causes(client, mission)
    met_from, met_to = (datetime.fromisoformat(cause[name]) for name in ("from", "to"))
    assert MONDAY_NOON < met_from < met_to < MONDAY_NOON + timedelta(hours=1)
    assert cause["message"] == "Fire brigade touches the leg from A1 to A2 of Tern. It is flown 60 m above ground."


def test_the_column_over_the_start_is_part_of_the_flight(here: World, client: Client) -> None:
    mission = planned(client, here)
    low = zone_around((10.001, 55.995), name="Playground", with_graph=False)
    change(low, upper_limit_m=20.0, upper_reference="AGL")
    [cause] = causes(client, mission)
    assert cause["message"] == "Playground touches the leg from the start to A1 of Tern. It is flown 0 to 60 m above ground."
