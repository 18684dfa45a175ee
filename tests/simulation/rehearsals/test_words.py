"""Sentences of an assessment name places of the plan, not numbers of waypoints."""

from pathlib import Path

import pytest

from missions.selectors.missions import mission_of_organisation
from simulation.serializers.places import waypoint_places
from simulation.serializers.words import reason_of, render_finding
from tests.missions.flights import an_operator, fleet, ground, planned
from tests.missions.worlds import world

MISSED = {
    "level": "fail",
    "code": "across",
    "uav": 1,
    "target": None,
    "facts": {"name": "Kite", "metres": 35.2, "limit_m": 10.0, "waypoint": 189},
}


def test_a_missed_route_is_told_by_its_place() -> None:
    assert reason_of(MISSED, {}, {(1, 189): "E402-3"}) == "missed its route near E402-3 by 35.2 m (allowed: 10 m)"
    assert render_finding(MISSED, {1: "Kite"}, {}, {(1, 189): "E402-3"})["message"].startswith("Kite: missed its route near E402-3")


def test_a_place_of_a_plan_that_is_gone_is_told_by_its_number() -> None:
    assert reason_of(MISSED, {}, {(0, 189): "E402-3"}) == "missed its route near waypoint 190 by 35.2 m (allowed: 10 m)"


def test_a_finding_tells_where_to_look_and_what_battery_is_missing() -> None:
    low = {"level": "fail", "code": "reserve", "uav": 0, "target": 2, "facts": {"percent": 7.2, "limit_percent": 20.0}}
    assert render_finding(low, {}, {}, {})["short_percent"] == 12.8
    assert render_finding(MISSED, {}, {}, {})["waypoint"] == 189


@pytest.mark.django_db
def test_each_waypoint_of_a_plan_has_the_name_of_its_target_or_asset_or_of_the_nearest_that_has_one(tmp_path: Path) -> None:
    here, person = world(), an_operator()
    ground(tmp_path / "ground.tif")
    mission = planned(person, fleet(), [here.towers[3]])
    places = waypoint_places(mission_of_organisation(person.organisation, mission.pk))
    (target,) = mission.targets.all()
    route = mission.routes.get()
    names = [places[route.mission_uav.sequence, waypoint.sequence] for waypoint in route.waypoints.order_by("sequence")]
    assert target.label in names
    assert all(names)
    assert not any("waypoint" in name for name in names)
