"""A route as it is dragged: what keeping it would say, and what flying it would take, before anything is kept."""

import math
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import uuid4

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, post
from tests.missions.manual_edits.test_manual_edits import as_wished, longest_leg, planned_with, put
from tests.missions.worlds import World, zone_around
from workspace.models import Role

pytestmark = pytest.mark.django_db

DEPARTS_AT = datetime(2027, 3, 1, 10, 0, tzinfo=UTC)


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def look(client: Client, mission: dict[str, Any], waypoints: list[dict[str, Any]]) -> dict[str, Any]:
    response = post(client, f"missions/{mission['id']}/routes/0/waypoints/look", {"waypoints": waypoints})
    assert response.status_code == 200, response.content
    found: dict[str, Any] = response.json()
    return found


def test_what_is_told_while_it_is_dragged_is_what_is_kept(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    reported = look(client, mission, wished)
    kept = put(client, mission, wished).json()["plan"]["routes"][0]
    assert reported["faults"] == {}
    assert {name: reported[name] for name in ("length_m", "duration_s", "energy_wh", "battery_percent")} == {
        name: kept[name] for name in ("length_m", "duration_s", "energy_wh", "battery_percent")
    }
    assert [point["arrival_s"] for point in reported["waypoints"]] == kept["arrival_s"]
    assert [point["battery_left_percent"] for point in reported["waypoints"]] == kept["battery_left_percent"]
    before = mission["plan"]["routes"][0]
    assert (reported["length_m"] > before["length_m"] + 100, reported["battery_percent"] < before["battery_percent"]) == (True, True)


def test_the_route_as_it_would_be_flown_is_told_as_it_is_kept(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    flown = look(client, mission, wished)["flown"]
    kept = put(client, mission, wished).json()["plan"]["routes"][0]
    assert flown == {name: kept[name] for name in flown}
    again = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert look(client, again, [*as_wished(again), wished[1]])["flown"] is None  # the end is not the last any more


def test_against_the_wind_the_true_speed_is_told(here: World, client: Client) -> None:
    wind = {"wind": [{"altitude_agl_m": 50, "speed_mps": 6, "from_deg": 90}], "temperature_c": 15}
    mission = planned_with(here, client, conditions=wind)
    wished = as_wished(mission)
    reported = look(client, mission, wished)["waypoints"]
    assert reported[0]["speed_mps"] is None
    for place in range(1, len(wished)):
        (west, south), (east, north) = (wished[at]["position"] for at in (place - 1, place))
        if wished[place - 1]["position"] == wished[place]["position"]:
            assert reported[place]["speed_mps"] is None
            continue
        x_m, y_m = (east - west) * math.cos(math.radians(56.0)), north - south  # a ratio: degrees do
        along_mps = -6.0 * x_m / math.hypot(x_m, y_m)  # it blows from the east
        left_mps = along_mps + math.sqrt(14.0**2 - (6.0**2 - along_mps**2))
        assert reported[place]["speed_mps"] == pytest.approx(min(12.0, left_mps), abs=0.1)
    assert min(point["speed_mps"] or 12.0 for point in reported) < 10.0  # of 12 m/s as planned


def test_a_slower_leg_lets_a_later_one_meet_a_zone_that_has_come_into_force(here: World, client: Client) -> None:
    mission = planned_with(here, client, departs_at=DEPARTS_AT.isoformat(), return_to_start=True)
    wished = as_wished(mission)
    route = mission["plan"]["routes"][0]
    slow, last = longest_leg(mission, before=len(wished) - 2), len(wished) - 2
    middle = [(a + b) / 2 for a, b in zip(wished[last]["position"], wished[last + 1]["position"], strict=True)]
    zone = zone_around((middle[0], middle[1]), 0.0002, name="Air show")
    begins = DEPARTS_AT + timedelta(seconds=route["arrival_s"][last + 1] + 600)  # past the margin of 5 minutes
    period = {
        "startDateTime": f"{begins:%Y-%m-%dT%H:%M:%SZ}",
        "endDateTime": f"{begins + timedelta(hours=2):%Y-%m-%dT%H:%M:%SZ}",
        "schedule": [],
    }
    NoFlyZone.objects.filter(pk=zone.pk).update(schedule=[period])
    zone_around((0.0, 0.0), 0.0001, name="elsewhere, so that the ground has changed")
    assert look(client, mission, wished)["faults"] == {}
    wished[slow]["speed_mps"] = 0.6
    reported = look(client, mission, wished)
    assert reported["faults"][f"legs.{last}"] == "This leg meets Air show."
    assert reported["waypoints"][last]["arrival_s"] > route["arrival_s"][last] + 300


def test_all_that_is_wrong_is_told_beside_the_figures_and_nothing_is_kept(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    wished[2]["altitude_agl_m"] = 500.0
    wished.insert(2, {"position": [10.2, 55.9], "altitude_agl_m": 100.0, "was": None})
    reported = look(client, mission, wished)
    assert {"legs.0", "waypoints.3.altitude_agl_m", "waypoints"} <= set(reported["faults"])
    assert "lacks" in reported["faults"]["waypoints"]
    assert reported["length_m"] > 20_000
    assert reported["battery_percent"] < 20
    assert client.get(f"/api/v1/missions/{mission['id']}").json()["revision"] == mission["revision"]


def test_what_is_no_route_has_faults_and_no_figures(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    reported = look(client, mission, as_wished(mission)[1:])
    assert reported["faults"] == {"waypoints": "Start, end and targets stay on the route. Take a target out of the mission instead."}
    assert (reported["length_m"], reported["waypoints"]) == (None, [])


def test_where_nobody_flies_there_is_nothing_to_look_at(here: World, client: Client) -> None:
    mission = post(client, "missions", mission_body(here.towers[0])).json()
    wished = [{"position": [10.0, 56.0], "altitude_agl_m": 60.0, "was": 0}]
    assert post(client, f"missions/{mission['id']}/routes/0/waypoints/look", {"waypoints": wished}).status_code == 400
    assert post(client, f"missions/{uuid4()}/routes/0/waypoints/look", {"waypoints": wished}).status_code == 404
    viewer = client_of(a_user(Role.VIEWER))
    assert post(viewer, f"missions/{mission['id']}/routes/0/waypoints/look", {"waypoints": wished}).status_code == 403


def test_a_look_after_a_change_stands_on_the_route_as_it_is_kept_now(here: World, client: Client) -> None:
    """What is read of a route for looks is kept for its revision alone."""
    mission = planned_with(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    before = look(client, mission, as_wished(mission))
    kept = put(client, mission, wished).json()
    after = look(client, kept, as_wished(kept))
    assert after["length_m"] == kept["plan"]["routes"][0]["length_m"] > before["length_m"] + 100
    assert "waypoints" in look(client, kept, as_wished(mission))["faults"]  # the old list is not the route's any more
