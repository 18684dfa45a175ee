"""What UAVs meet if they return now: from where each is at this moment, and beside each other."""

from datetime import timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import Point
from django.utils import timezone

from inspection.models import NoFlyZone
from missions.models import Mission, Uav
from missions.services.commands.rtl_check import note_rtl_behaviour
from telemetry.models import UavLink, UavWatch
from tests.accounts.users import a_user, client_of
from tests.inspection import ground as things
from tests.missions.flights import an_operator, approved, fleet
from tests.missions.worlds import power_line, rebuild, world, zone_around
from workspace.models import Organisation, User

pytestmark = pytest.mark.django_db
COPTER = {"RTL_ALT": 3_000.0, "RTL_CLIMB_MIN": 0.0, "RTL_CONE_SLOPE": 3.0, "RTL_ALT_TYPE": 0.0}
HOME = (10.001, 55.995)
EAST = (10.013, 55.995)  # 750 m away
STRAIGHT = {"height_m": None, "wait_s": 0.0, "along_route": False}


@pytest.fixture
def user() -> User:
    return an_operator()


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


def read(uav: Uav, **parameters: float) -> None:
    note_rtl_behaviour(uav_id=uav.pk, autopilot="ardupilot", parameters=COPTER | parameters)


def flies(
    uav: Uav, position: tuple[float, float] | None, *, age_s: float = 0.0, home: Any = HOME, mode: str = "AUTO", **reported: Any
) -> None:
    """As its last report has it, so many seconds ago."""
    at = (timezone.now() - timedelta(seconds=age_s)).isoformat()
    groups = {
        "report": {"measured_at": at, "received_at": at},
        "height": {"measured_at": at, "altitude_relative_m": reported.get("height_m", 30.0)},
        "speed": {"measured_at": at, "speed_mps": 8.0},
        "state": {"measured_at": at, "mode": mode, "is_armed": True, "is_in_air": True},
    }
    if position is not None:
        groups["position"] = {"measured_at": at, "position": list(position)}
    if "battery_percent" in reported:
        groups["battery"] = {"measured_at": at, "battery_percent": reported["battery_percent"]}
    UavWatch.objects.update_or_create(
        uav=uav, defaults={"organisation_id": uav.organisation_id, "measured": groups, "estimated": reported.get("estimated")}
    )
    link = {
        "last_message_at": timezone.now(),
        "is_in_air": reported.get("is_in_air", True),
        "mode": mode,
        "home": Point(*home, srid=4326),
        "home_amsl_m": 100.0,
    }
    UavLink.objects.update_or_create(uav=uav, defaults=link)


def estimated(position: tuple[float, float], *, report_age_s: float = 30.0, bound_m: float = 20.0, **more: Any) -> dict[str, Any]:
    """Of this moment, by a watch."""
    now = timezone.now()
    return {
        "at": now.isoformat(), "report_at": (now - timedelta(seconds=report_age_s)).isoformat(), "position": list(position),
        "altitude_relative_m": 30.0, "bound": {"along_m": bound_m, "across_m": 5.0, "bearing_deg": 0.0}, "is_measured": False,
        "is_lost": False, "waypoint_sequence": None, "battery": None,
    } | more  # fmt: skip


def reported(user: User, *uavs: Uav) -> list[dict[str, Any]]:
    response = client_of(user).get("/api/v1/returns?" + "&".join(f"uav={uav.pk}" for uav in uavs))
    assert response.status_code == 200, response.content
    return list(response.json()["results"])


def forecast(**values: Any) -> dict[str, Any]:
    return {
        "level": "",
        "left_percent": 60.0,
        "reserve_percent": 20.0,
        "home_percent": 10.0,
        "home_s": 90,
        "reserve_in_s": 600,
        "hold_s": 400,
    } | values


def test_a_clear_way_home_is_told_with_whence_it_was_looked_at(user, uav):
    world()
    read(uav)
    flies(uav, EAST)
    (found,) = reported(user, uav)
    assert (found["state"], found["warnings"], found["is_clear"], found["safest"]) == ("clear", [], True, STRAIGHT)
    assert found["present"]["position"] == list(EAST) and found["present"]["is_measured"]
    assert found["distance_m"] == pytest.approx(749, abs=5) and found["level_m"] == 30.0


def test_wires_are_in_the_way_from_beyond_them_and_not_from_this_side(user, uav):
    world()
    power_line([things.tower((10.007, lat), height_m=60.0) for lat in (55.9930, 55.9970)])
    rebuild()
    read(uav)
    flies(uav, EAST)
    (found,) = reported(user, uav)
    assert (found["state"], found["is_clear"]) == ("in_the_way", False)
    assert found["warnings"][0].startswith("From where it is now, the return path is below safe clearance over towers or conductors")
    assert found["safe_height_m"] == 75.0
    flies(uav, (10.004, 55.995))
    assert reported(user, uav)[0]["state"] == "clear"


def test_zones_count_that_apply_while_it_flies_home(user, uav):
    world()
    zone = zone_around((10.007, 55.995), 0.0007, name="Fire brigade")
    read(uav)
    flies(uav, EAST)
    (found,) = reported(user, uav)
    assert "the return path crosses Fire brigade" in found["warnings"][0]
    begins = timezone.now() + timedelta(hours=6)
    period = {"startDateTime": f"{begins:%Y-%m-%dT%H:%M:%SZ}", "endDateTime": f"{begins:%Y-%m-%dT%H:59:59Z}", "schedule": []}
    NoFlyZone.objects.filter(pk=zone.pk).update(schedule=[period])
    rebuild()
    assert reported(user, uav)[0]["state"] == "clear"


def test_an_estimated_place_is_told_as_such_and_all_within_its_bound_is_looked_at(user, uav):
    world()
    zone_around((10.007, 55.9962), 0.0007, name="Fire brigade")
    read(uav)
    flies(uav, EAST, age_s=30.0, estimated=estimated(EAST))
    (found,) = reported(user, uav)
    assert found["state"] == "clear"
    assert (found["present"]["is_measured"], found["present"]["uncertainty_m"]) == (False, 20.0)
    assert found["present"]["age_s"] == pytest.approx(30.0, abs=2.0)
    flies(uav, EAST, age_s=30.0, estimated=estimated(EAST, bound_m=200.0))
    assert reported(user, uav)[0]["state"] == "in_the_way"


def test_a_place_that_nobody_knows_is_not_checked_from(user, uav):
    world()
    read(uav)
    flies(uav, None)
    (found,) = reported(user, uav)
    assert (found["state"], found["present"], found["is_clear"]) == ("unknown", None, False)
    assert "Position of Tern too uncertain" in found["warnings"][0]
    flies(uav, EAST, age_s=300.0)
    assert reported(user, uav)[0]["state"] == "unknown"


def test_of_a_lost_uav_its_whole_route_is_looked_at(user, uav):
    towers = world().towers
    zone_around((10.010, 55.9975), 0.0007, name="Fire brigade")
    mission = approved(user, [uav], [towers[0], towers[5]])[0]
    Mission.objects.filter(pk=mission.pk).update(state="active")
    read(uav)
    flies(uav, None)
    (found,) = reported(user, uav)
    assert (found["state"], found["mission"], found["place"]) == ("in_the_way", str(mission.pk), 0)
    assert "crosses Fire brigade" in found["warnings"][1]


def test_the_battery_at_landing_is_told_against_the_reserve(user, uav):
    world()
    read(uav)
    flies(uav, EAST, battery_percent=60.0, estimated=estimated(EAST, battery=forecast()))
    (found,) = reported(user, uav)
    assert found["battery"]["landing_percent"] == 50.0 and found["battery"]["unknown"] == "" and found["is_clear"]
    flies(uav, EAST, battery_percent=25.0, estimated=estimated(EAST, battery=forecast(left_percent=25.0, hold_s=0)))
    (found,) = reported(user, uav)
    assert found["warnings"] == ["It would land with about 15 % of its battery, below the reserve of 20 %."]
    assert not found["is_clear"]
    flies(uav, EAST, battery_percent=8.0, estimated=estimated(EAST, battery=forecast(left_percent=8.0, hold_s=0)))
    assert "is not enough for the return, which needs about 10 %" in reported(user, uav)[0]["warnings"][0]


def test_an_unknown_battery_is_told_with_the_reason(user, uav):
    world()
    read(uav)
    flies(uav, EAST)
    assert reported(user, uav)[0]["battery"]["unknown"] == "Tern reports no battery percentage."
    flies(uav, EAST, battery_percent=60.0)
    battery = reported(user, uav)[0]["battery"]
    assert battery["left_percent"] == 60.0 and "is calculated during a mission with telemetry only" in battery["unknown"]


def test_returns_that_meet_are_told_of_each_other_and_kept_apart_by_heights(user):
    world()
    tern, kite = fleet("Tern", "Kite")
    for one, position in ((tern, EAST), (kite, (10.013, 55.9965))):
        read(one)
        flies(one, position)
    first, second = reported(user, tern, kite)
    assert [met["name"] for met in first["met"]] == ["Kite"] and [met["name"] for met in second["met"]] == ["Tern"]
    assert first["met"][0]["is_returning"] and not first["is_clear"]
    assert first["warnings"][0].startswith("Returning now, it comes within")
    safest = [first["safest"], second["safest"]]
    assert safest[0] == STRAIGHT
    own_m, set_m = first["level_m"], safest[1]["height_m"]
    assert set_m >= own_m + 15.0 and (safest[1]["wait_s"], safest[1]["along_route"]) == (0.0, False)
    assert reported(user, tern)[0]["met"] == [], "Kite flies on"


def test_the_one_with_the_least_battery_to_spare_goes_first(user):
    world()
    tern, kite = fleet("Tern", "Kite")
    for one, position, left in ((tern, EAST, 60.0), (kite, (10.013, 55.9965), 40.0)):
        read(one)
        flies(one, position, battery_percent=left, estimated=estimated(position, battery=forecast(left_percent=left)))
    safest = {found["name"]: found["safest"] for found in reported(user, tern, kite)}
    assert safest["Kite"] == STRAIGHT and safest["Tern"]["height_m"] >= 45.0


def test_one_that_hovers_in_the_way_is_met_and_one_higher_up_or_on_the_ground_is_not(user):
    world()
    tern, kite = fleet("Tern", "Kite")
    for one in (tern, kite):
        read(one)
    flies(tern, EAST)
    flies(kite, (10.007, 55.995), mode="LOITER")
    (found,) = reported(user, tern)
    assert [met["name"] for met in found["met"]] == ["Kite"] and found["safest"]["height_m"] >= 45.0
    flies(kite, (10.007, 55.995), mode="LOITER", height_m=70.0)
    assert reported(user, tern)[0]["met"] == []
    flies(kite, (10.007, 55.995), mode="LOITER", is_in_air=False)
    assert reported(user, tern)[0]["met"] == []


def test_one_on_the_ground_has_no_way_home(user, uav):
    world()
    read(uav)
    flies(uav, HOME, is_in_air=False)
    (found,) = reported(user, uav)
    assert (found["state"], found["warnings"]) == ("not_checked", ["It is on the ground."])


def test_only_uavs_of_ones_own_organisation_are_told(user, uav):
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert stranger.get(f"/api/v1/returns?uav={uav.pk}").status_code == 404
    for query in ("", "?uav=x", "?" + "&".join(f"uav={number}" for number in range(51))):
        assert client_of(user).get(f"/api/v1/returns{query}").status_code == 400
