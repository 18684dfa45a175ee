"""Routes changed by hand: what may be, what is refused, and what is kept."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from missions.models import Waypoint
from tests.inspection import ground
from tests.missions.api import mission_body, post
from tests.missions.worlds import World, power_line, rebuild, world, zone_around
from tests.workspace.people import client_of, somebody

pytestmark = pytest.mark.django_db


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(somebody())


def error_of(response: Any, status: int) -> dict[str, Any]:
    assert response.status_code == status, response.content
    error: dict[str, Any] = response.json()["error"]
    return error


def planned(here: World, client: Client) -> dict[str, Any]:
    return post(client, "missions", mission_body(here.towers[3], here.towers[5]) | {"plan": True}).json()


def as_wished(mission: dict[str, Any]) -> list[dict[str, Any]]:
    waypoints = mission["plan"]["routes"][0]["waypoints"]
    return [
        {"position": waypoint["position"], "altitude_agl_m": waypoint["altitude_agl_m"], "was": number}
        for number, waypoint in enumerate(waypoints)
    ]


def put(client: Client, mission: dict[str, Any], waypoints: list[dict[str, Any]]) -> Any:
    return client.put(
        f"/api/v1/missions/{mission['id']}/routes/0/waypoints",
        {"waypoints": waypoints},
        content_type="application/json",
        HTTP_IF_MATCH=f'"{mission["revision"]}"',
    )


def test_a_waypoint_put_in_makes_the_route_longer_and_is_by_hand(here: World, client: Client) -> None:
    mission = planned(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    changed = put(client, mission, wished).json()
    (route,) = changed["plan"]["routes"]
    assert route["length_m"] > mission["plan"]["routes"][0]["length_m"] + 100
    assert changed["plan"]["total_length_m"] == pytest.approx(route["length_m"])
    assert [route["waypoints"][place]["position"] for place in route["by_hand"]] == [[10.003, 55.9935]]
    assert route["targets"] == mission["plan"]["routes"][0]["targets"]
    assert len(route["arrival_s"]) == len(route["waypoints"])
    assert changed["plan"]["is_proven"] is False
    assert changed["revision"] == mission["revision"] + 1


def test_the_same_waypoints_change_nothing_but_the_revision(here: World, client: Client) -> None:
    mission = planned(here, client)
    changed = put(client, mission, as_wished(mission)).json()
    before, after = (found["plan"]["routes"][0] for found in (mission, changed))
    assert after["waypoints"] == before["waypoints"]
    assert after["length_m"] == pytest.approx(before["length_m"], abs=0.01)


def test_a_leg_into_a_zone_is_refused_and_nothing_is_kept(here: World, client: Client) -> None:
    mission = planned(here, client)
    zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    faults = error_of(put(client, mission, wished), 400)["details"]
    assert any(place.startswith("legs.") and "Hospital" in str(fault) for place, fault in faults.items())
    assert Waypoint.objects.filter(is_by_hand=True).count() == 0


@pytest.mark.parametrize(("height_m", "words"), [(90.0, "fly at 105 m above ground"), (110.0, "cannot be flown over below 120 m")])
def test_a_leg_over_wires_is_refused_below_their_height(here: World, client: Client, height_m: float, words: str) -> None:
    """Wires between two towers 190 m to the left and right of the leg."""
    power_line([ground.tower((lon, 55.9942), height_m=height_m) for lon in (9.999, 10.005)])
    rebuild()
    mission = planned(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    faults = error_of(put(client, mission, wished), 400)["details"]
    assert set(faults) == {"legs.0", "legs.1"}
    assert words in str(faults["legs.0"])


def test_a_route_that_rises_over_wires_can_be_kept_as_it_is(here: World, client: Client) -> None:
    power_line([ground.tower((lon, 55.997), height_m=90.0) for lon in (9.995, 10.02)])
    rebuild()
    mission = planned(here, client)
    assert max(waypoint["altitude_agl_m"] for waypoint in mission["plan"]["routes"][0]["waypoints"]) == 105.0
    changed = put(client, mission, as_wished(mission)).json()
    assert changed["plan"]["routes"][0]["waypoints"] == mission["plan"]["routes"][0]["waypoints"]


@pytest.mark.parametrize("altitude_m", [20.0, 130.0])
def test_a_waypoint_too_low_or_too_high_is_refused(here: World, client: Client, altitude_m: float) -> None:
    mission = planned(here, client)
    wished = as_wished(mission)
    wished[1]["altitude_agl_m"] = altitude_m
    assert "waypoints.1.altitude_agl_m" in error_of(put(client, mission, wished), 400)["details"]


def test_targets_can_neither_be_taken_out_nor_swapped_nor_moved(here: World, client: Client) -> None:
    mission = planned(here, client)
    whole = as_wished(mission)
    target = next(number for number, waypoint in enumerate(mission["plan"]["routes"][0]["waypoints"]) if waypoint["kind"] == "target")
    without = [point for point in whole if point["was"] != target]
    swapped = whole[:1] + whole[1:-1][::-1] + whole[-1:]
    for wished in (without, swapped):
        assert "waypoints" in error_of(put(client, mission, wished), 400)["details"]
    whole[target]["position"] = [whole[target]["position"][0] + 0.001, 56.0]
    assert f"waypoints.{target}.position" in error_of(put(client, mission, whole), 400)["details"]


def test_who_has_seen_an_older_mission_changes_nothing(here: World, client: Client) -> None:
    mission = planned(here, client)
    assert put(client, mission, as_wished(mission)).status_code == 200
    assert put(client, mission, as_wished(mission)).status_code == 412


def test_a_dragged_leg_is_told_what_it_meets(here: World, client: Client) -> None:
    zone = zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=100.0, lower_reference="AGL")
    zone_around((0.0, 0.0), 0.0001)

    def leg(altitude_agl_m: float) -> dict[str, Any]:
        ends = ([10.000, 55.9935], [10.006, 55.9935])
        start, end = ({"position": position, "altitude_agl_m": altitude_agl_m, "arrival_s": 0.0} for position in ends)
        return {"start": start, "end": end}

    under, through, above = post(client, "leg-checks", {"legs": [leg(60.0), leg(110.0), leg(125.0)]}).json()["legs"]
    assert under == {"is_clear": True, "zone": None, "message": ""}
    assert (through["is_clear"], through["zone"]) == (False, zone.pk)
    assert "Hospital" in through["message"]
    assert (above["is_clear"], above["zone"]) == (False, None)


@pytest.mark.parametrize(("height_m", "words"), [(90.0, "fly at 105 m above ground"), (110.0, "cannot be flown over below 120 m")])
def test_a_dragged_leg_over_wires_is_told_how_high_to_fly(here: World, client: Client, height_m: float, words: str) -> None:
    power_line([ground.tower((lon, 55.9942), height_m=height_m) for lon in (9.999, 10.005)])
    rebuild()

    def leg(north: float) -> dict[str, Any]:
        ends = ([10.002, 55.9935], [10.002, north])
        start, end = ({"position": position, "altitude_agl_m": 70.0, "arrival_s": 0.0} for position in ends)
        return {"start": start, "end": end}

    short, over = post(client, "leg-checks", {"legs": [leg(55.9938), leg(55.995)]}).json()["legs"]
    assert short["is_clear"]
    assert not over["is_clear"]
    assert words in over["message"]
