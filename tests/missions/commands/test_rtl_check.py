"""What is in the way of an autopilot's own return is told for each UAV of a mission, and never left unsaid."""

from typing import Any

import pytest
from django.test import Client

from missions.models import LinkKind, Mission, Uav
from missions.services.commands.rtl_check import note_rtl_behaviour
from tests.accounts.users import a_user, client_of
from tests.inspection import ground as things
from tests.missions.flights import an_operator, fleet, ground, planned
from tests.missions.worlds import power_line, rebuild, world, zone_around
from workspace.models import Organisation

pytestmark = pytest.mark.django_db
COPTER = {"RTL_ALT": 3_000.0, "RTL_CLIMB_MIN": 0.0, "RTL_CONE_SLOPE": 3.0, "RTL_ALT_TYPE": 0.0}


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def mission(uav) -> Mission:
    """From the tower at one end of the line to that at the other."""
    towers = world().towers
    return planned(an_operator(), [uav], [towers[0], towers[5]])


def reported(mission: Mission) -> dict[str, Any]:
    (found,) = client_of(mission.author).get(f"/api/v1/missions/{mission.pk}/returns").json()["results"]
    return dict(found)


def read(uav: Uav, **parameters: float) -> None:
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER | parameters | {"SYSID_THISMAV": 7.0})


def test_a_height_that_was_never_read_is_not_known(mission):
    found = reported(mission)
    assert (found["state"], found["height_m"], found["read_at"]) == ("unknown", None, None)
    assert found["warnings"][0].startswith("Return altitude of Tern not reported by the autopilot.")
    assert "RTL" not in found["warnings"][0] and "RTL_ALT" in found["detail"]


def test_a_free_way_home_is_told_with_its_height(mission, uav):
    read(uav)
    found = reported(mission)
    assert (found["state"], found["warnings"], found["parameter"], found["height_m"]) == ("clear", [], "RTL_ALT", 30.0)
    assert found["read_at"] is not None
    uav.refresh_from_db()
    assert uav.autopilot_return == {"autopilot": "ardupilot", "parameters": COPTER}


def test_a_zone_across_the_straight_way_home_is_named_and_no_height_helps(mission, uav):
    zone_around((10.010, 55.9975), 0.0007, name="Fire brigade")
    read(uav)
    found = reported(mission)
    assert (found["state"], found["safe_height_m"]) == ("in_the_way", None)
    assert "crosses Fire brigade" in found["warnings"][0] and "waypoint" in found["warnings"][0]
    assert found["warnings"][-1] == "No height of RTL_ALT is clear: use Hold and Land instead."


def test_wires_across_the_way_home_ask_for_a_height_that_is_told_as_it_is_to_be_set(mission, uav):
    power_line([things.tower((10.010, lat), height_m=60.0) for lat in (55.9965, 55.9985)])
    rebuild()
    read(uav)
    found = reported(mission)
    assert found["state"] == "in_the_way"
    assert "below safe clearance over towers or conductors" in found["warnings"][0]
    assert found["safe_height_m"] == 75.0
    assert found["warnings"][-1] == "Set RTL_ALT on it to at least 7500 (75 m), or use Hold and Land instead."
    read(uav, RTL_ALT=7_500.0)
    assert reported(mission)["state"] == "clear"


def test_a_hill_is_looked_at_where_there_is_terrain(uav, tmp_path):
    ground(tmp_path / "hill.tif", 300.0)
    towers = world().towers
    mission = planned(an_operator(), [uav], [towers[0], towers[5]])
    read(uav)
    assert reported(mission)["state"] == "clear"


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"RTL_ALT_TYPE": 1.0}, "By RTL_ALT_TYPE 1 Tern does not return straight"),
        ({"OA_TYPE": 2.0}, "By OA_TYPE 2 Tern does not return straight"),
        ({"RALLY_TOTAL": 2.0}, "Tern has rally points of another mission"),
    ],
)
def test_a_way_home_that_is_not_the_straight_one_is_not_known(facts, words, mission, uav):
    read(uav, **facts)
    found = reported(mission)
    assert found["state"] == "unknown" and words in found["warnings"][0]


def test_a_height_alone_does_not_say_that_it_flies_straight(mission, uav):
    note_rtl_behaviour(uav_id=uav.pk, autopilot="px4", parameters={"RTL_RETURN_ALT": 60.0})
    found = reported(mission)
    assert found["state"] == "unknown" and "its autopilot has not reported how it returns" in found["warnings"][0]
    assert found["detail"] == "RTL_TYPE", "for whoever sets it up, and not in the sentence"
    note_rtl_behaviour(uav_id=uav.pk, autopilot="px4", parameters={"RTL_RETURN_ALT": 60.0, "RTL_TYPE": 0.0})
    assert reported(mission)["state"] == "clear"


@pytest.mark.parametrize(
    ("facts", "warning"),
    [
        ({"FENCE_ENABLE": 0.0}, "Tern ignores the fence that goes with the mission: its autopilot has FENCE_ENABLE 0."),
        ({"FENCE_ENABLE": 1.0, "FENCE_TYPE": 3.0}, "Tern ignores the fence that goes with the mission: its autopilot has FENCE_TYPE 3."),
        ({"FENCE_ENABLE": 0.0, "FENCE_AUTOENABLE": 1.0}, ""),
        ({"FENCE_ENABLE": 1.0, "FENCE_TYPE": 7.0}, ""),
        ({}, ""),
    ],
)
def test_a_fence_that_the_autopilot_ignores_is_told(facts, warning, mission, uav):
    read(uav, **facts)
    assert reported(mission)["fence_warning"] == "", "there is no fence"
    zone_around((10.010, 56.02), 0.001, name="Airport")
    assert reported(mission)["fence_warning"] == warning


def test_a_companions_return_is_its_own(mission, uav):
    Uav.objects.filter(pk=uav.pk).update(link=LinkKind.HTTP)
    found = reported(mission)
    assert found["state"] == "not_checked" and "companion computer" in found["warnings"][0]


def test_another_organisations_mission_is_not_there(mission):
    stranger: Client = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert stranger.get(f"/api/v1/missions/{mission.pk}/returns").status_code == 404
