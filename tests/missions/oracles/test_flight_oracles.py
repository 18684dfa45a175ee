"""The judges of random missions see what is plain to see: good plans with one thing wrong in them."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from inspection.geodesy import LonLat
from inspection.models import NoFlyZone
from missions.models import Mission, MissionState
from missions.services import PlanRequest, TargetRequest, make_plan
from planning.clearance.lost_link import LostLink
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import IRIS_BATTERY_WH, IRIS_MAX_AIRSPEED_MPS, Performance
from planning.problem import Objective
from planning.request import EndAction, LostLinkRequest
from tests.accounts.users import a_user
from tests.inspection import ground
from tests.missions.oracles.flight_oracle import Judge
from tests.missions.oracles.manual_edit_oracle import ManualEditOracle
from tests.missions.oracles.schedule_oracle import applies_at, sun
from tests.missions.oracles.terrain_oracle import Hills
from tests.missions.property_tests.random_flights import A_MONDAY, period, stored
from tests.missions.worlds import power_line, rebuild, request, uav, world, zone_around

pytestmark = pytest.mark.django_db

NOON = A_MONDAY + timedelta(hours=12)
HOME = {"end_action": EndAction.RETURN}
Tampering = Callable[[dict[str, Any]], Any]  # of a plan's first route


def elsewhere() -> None:
    zone_around((10.2, 56.2), name="elsewhere")


def faults_of(asked: PlanRequest, plan: dict[str, Any], tampering: Tampering = lambda route: None) -> list[str]:
    wrong = deepcopy(plan)
    tampering(wrong["routes"][0])
    return Judge().faults(asked, wrong)


def judged(zone: NoFlyZone, plan: dict[str, Any], asked: PlanRequest, **facts: Any) -> list[str]:
    """Of a plan that was made without the zone."""
    NoFlyZone.objects.filter(pk=zone.pk).update(**facts)
    return Judge().faults(asked, plan)


def of_day(day: str, start: str, end: str) -> list[dict[str, Any]]:
    return [period([{"day": [day], "startTime": start, "startEvent": None, "endTime": end, "endEvent": None}])]


# --- zones --------------------------------------------------------------------------------------------------------------------


def test_a_crossing_is_found_at_its_height_and_time() -> None:
    here = world()
    asked = request(here.towers[5], departs_at=NOON)
    plan = make_plan(request=asked)
    zone = zone_around((10.010, 56.0), name="Air show", with_graph=False)
    assert "meets Air show" in judged(zone, plan, asked)[0]
    assert judged(zone, plan, asked, lower_limit_m=81.0, lower_reference="AGL") == []
    assert "meets Air show" in judged(zone, plan, asked, lower_limit_m=79.0)[0]
    assert judged(zone, plan, asked, schedule=of_day("MON", "11:00:00Z", "13:00:00Z"))
    assert judged(zone, plan, asked, schedule=of_day("TUE", "11:00:00Z", "13:00:00Z")) == []
    assert judged(zone, plan, replace(asked, departs_at=None))


def test_a_uav_that_hovers_meets_what_comes_as_long_as_its_battery_lasts() -> None:
    here = world()
    elsewhere()
    asked = request(here.towers[5], departs_at=NOON)
    plan = make_plan(request=asked)
    zone = zone_around((10.020, 56.0), name="Evening", with_graph=False)
    assert "meets Evening" in judged(zone, plan, asked, schedule=of_day("MON", "15:30:00Z", "16:00:00Z"))[0]
    assert judged(zone, plan, asked, schedule=of_day("MON", "16:30:00Z", "17:00:00Z")) == []
    small = replace(asked, uavs=(uav(performance=Performance(battery_wh=IRIS_BATTERY_WH)),))
    short = make_plan(request=replace(small, uavs=(replace(small.uavs[0], end_action=EndAction.HOVER),)))
    assert judged(zone, short, small, schedule=of_day("MON", "12:20:00Z", "12:40:00Z"))
    assert judged(zone, short, small, schedule=of_day("MON", "13:30:00Z", "16:00:00Z")) == []


def test_schedules_are_read_by_the_minute() -> None:
    night = of_day("SUN", "22:00:00Z", "05:00:00Z")
    assert applies_at(night, A_MONDAY - timedelta(hours=1), 10.0, 56.0)
    assert applies_at(night, A_MONDAY + timedelta(hours=4, minutes=59), 10.0, 56.0)
    assert not applies_at(night, A_MONDAY + timedelta(hours=5), 10.0, 56.0)
    assert not applies_at(night, A_MONDAY + timedelta(hours=23), 10.0, 56.0)
    rise = sun("SR", A_MONDAY.date(), 12.57, 55.68)  # timeanddate.com: 8:02 in Copenhagen, UTC+1
    assert rise is not None
    assert abs(rise - datetime(2026, 11, 23, 7, 2, tzinfo=UTC)) < timedelta(minutes=3)


# --- refusals -----------------------------------------------------------------------------------------------------------------


def test_a_false_refusal_and_a_forgotten_target_are_found() -> None:
    here = world()
    elsewhere()
    battery = Performance(battery_wh=IRIS_BATTERY_WH, max_airspeed_mps=IRIS_MAX_AIRSPEED_MPS)
    asked = request(TargetRequest(here.towers[2].pk), uavs=(uav(performance=battery), uav(name="Gull", **HOME)), objective=Objective.TOTAL)
    plan = make_plan(request=asked)
    assert Judge().faults(asked, plan) == []
    refused = {"target": 0, "reason": "inside_zone", "message": "", "why": [{"code": "stands_inside_zone", "params": {}}]}
    empty = [route | {"targets": [], "waypoints": [], "length_m": 0.0, "arrival_s": []} for route in plan["routes"]]
    assert Judge().faults(asked, plan | {"routes": empty, "unassigned": [refused]}) == ["target 0 is not inside_zone: no zone is there: "]
    assert Judge().faults(asked, plan | {"routes": empty}) == ["a target is visited twice or forgotten"]
    no_path = Judge().faults(asked, plan | {"routes": empty, "unassigned": [refused | {"reason": "no_path"}]})
    assert [fault.split(",")[0] for fault in no_path] == [
        "target 0 is not no_path: Tern could fly there straight",
        "target 0 is not no_path: Gull could fly there straight",
    ]
    beyond = Judge().faults(asked, plan | {"routes": empty, "unassigned": [refused | {"reason": "beyond_energy"}]})
    assert any("does not say what is missing" in fault for fault in beyond)
    assert any("Tern could fly there" in fault for fault in beyond)


# --- the clock and the battery ------------------------------------------------------------------------------------------------


def test_seconds_and_watt_hours_are_counted_anew() -> None:
    here = world()
    elsewhere()
    wind = (WindLayer(10.0, 5.0, 250.0), WindLayer(100.0, 8.0, 300.0))
    battery = Performance(battery_wh=IRIS_BATTERY_WH, max_airspeed_mps=IRIS_MAX_AIRSPEED_MPS)
    asked = request(here.towers[5], here.bridge, uavs=(uav(performance=battery),), conditions=Conditions(wind, -5.0))
    plan = make_plan(request=asked)
    [route] = plan["routes"]
    assert faults_of(asked, plan) == []
    assert faults_of(asked, plan, lambda reported: reported.update(energy_wh=route["energy_wh"] * 0.97))
    assert faults_of(asked, plan, lambda reported: reported.update(arrival_s=[0.98 * arrival_s for arrival_s in route["arrival_s"]]))
    assert faults_of(asked, plan, lambda reported: reported["used_wh"].__setitem__(-1, route["used_wh"][-1] * 0.95))
    assert faults_of(
        asked, plan, lambda reported: reported["battery_left_percent"].__setitem__(-1, route["battery_left_percent"][-1] + 0.5)
    )
    small = replace(asked, uavs=(uav(performance=replace(battery, battery_wh=route["energy_wh"] * 1.2)),))
    assert any("below its reserve" in fault for fault in faults_of(small, plan))


def test_flights_one_after_another_are_each_looked_at() -> None:
    here = world()
    elsewhere()
    home = uav(performance=Performance(battery_wh=IRIS_BATTERY_WH), **HOME)
    most_wh = make_plan(request=request(here.towers[5], uavs=(home,)))["total_energy_wh"]
    small = replace(home, sorties=3, performance=Performance(battery_wh=1.15 * most_wh / 0.8))
    asked = request(here.towers[5], here.bridge, here.towers[0], uavs=(small,), departs_at=NOON)
    plan = make_plan(request=asked)
    stop = [point["kind"] for point in plan["routes"][0]["waypoints"]].index("base")
    assert faults_of(asked, plan) == []
    assert any("of 1" in fault for fault in faults_of(replace(asked, uavs=(replace(small, sorties=1),)), plan))

    def hurried(route: dict[str, Any]) -> None:
        route["waypoints"][stop]["task"]["hold_s"] = 60.0
        route["arrival_s"][stop + 1 :] = [arrival_s - 540.0 for arrival_s in route["arrival_s"][stop + 1 :]]
        route["duration_s"] -= 540.0

    assert any("takes off" in fault for fault in faults_of(asked, plan, hurried))
    moved = LonLat(10.002, 55.995)
    assert any(
        "elsewhere than at home" in fault for fault in faults_of(asked, plan, lambda route: route["waypoints"][stop].update(position=moved))
    )
    flown_on = faults_of(
        asked, plan, lambda route: route["waypoints"].pop(stop) and route["arrival_s"].pop(stop) and route["used_wh"].pop(stop)
    )
    assert flown_on
    weak = replace(asked, uavs=(replace(small, performance=Performance(battery_wh=0.9 * most_wh)),))
    assert any("below its reserve" in fault for fault in faults_of(weak, plan))
    zone = zone_around((10.001, 55.995), half_deg=0.0001, name="Yard", with_graph=False)
    landed_at = NOON + timedelta(seconds=plan["routes"][0]["arrival_s"][stop])
    while_down = of_day("MON", f"{landed_at + timedelta(minutes=3):%H:%M:%SZ}", f"{landed_at + timedelta(minutes=6):%H:%M:%SZ}")
    assert "meets Yard" in judged(zone, plan, asked, schedule=while_down, upper_limit_m=20.0, upper_reference="AGL")[0]


def test_stops_to_charge_are_looked_at() -> None:
    here = world()
    elsewhere()
    home = uav(performance=Performance(battery_wh=IRIS_BATTERY_WH), **HOME)
    most_wh = make_plan(request=request(here.towers[5], uavs=(home,)))["total_energy_wh"]
    small = replace(home, performance=Performance(battery_wh=0.6 * most_wh / 0.8))
    asked = request(here.towers[5], uavs=(small,), charging_w=100.0, departs_at=NOON)
    plan = make_plan(request=asked)
    [stop] = plan["routes"][0]["charging"]
    assert faults_of(asked, plan) == []
    assert any("not wished" in fault for fault in faults_of(replace(asked, charging_w=None), plan))
    assert any(" at a tower, not " in fault for fault in faults_of(replace(asked, charging_w=60.0), plan))

    def stopped(**facts: Any) -> list[str]:
        return faults_of(asked, plan, lambda route: route.update(charging=[stop | facts]))

    assert any("Wh at a tower" in fault for fault in stopped(charged_wh=stop["charged_wh"] * 1.2))
    assert any("s at a tower" in fault for fault in stopped(stopped_s=stop["charging_s"]))
    assert any("no tower" in fault for fault in stopped(waypoint=0))
    more_s = 3_600.0
    more_wh = more_s * 92.0 / 3_600.0
    longer = {
        "charging_s": stop["charging_s"] + more_s,
        "stopped_s": stop["stopped_s"] + more_s,
        "charged_wh": stop["charged_wh"] + more_wh,
    }
    assert any("in a battery of" in fault for fault in stopped(**longer))
    less = {
        "charging_s": stop["charging_s"] / 2,
        "stopped_s": stop["stopped_s"] - stop["charging_s"] / 2,
        "charged_wh": stop["charged_wh"] / 2,
    }
    assert any("below its reserve" in fault for fault in stopped(**less))
    at = plan["routes"][0]["waypoints"][stop["waypoint"]]["position"]
    zone = zone_around((at[0], at[1]), half_deg=0.0001, name="Meadow", with_graph=False)
    low = {"upper_limit_m": 30.0, "upper_reference": "AGL"}  # below the flight at 60 m, not below the tower's top at 45 m
    assert "meets Meadow" in judged(zone, plan, asked, **low)[0]
    assert judged(zone, plan, asked, upper_limit_m=24.0) == []


# --- separation ---------------------------------------------------------------------------------------------------------------


def test_uavs_that_pass_one_place_together_are_seen() -> None:
    here = world()
    elsewhere()
    one = request(here.towers[5], uavs=(uav(**HOME),))
    plan = make_plan(request=one)
    [route] = plan["routes"]
    both = request(here.towers[5], uavs=(uav(**HOME), uav(name="Gull", **HOME)))

    def beside(later_s: float, **reported: Any) -> list[str]:
        late = {"departs_s": later_s, "arrival_s": [arrival_s + later_s for arrival_s in route["arrival_s"]]}
        together = plan | {"routes": [route, route | {"uav": "Gull"} | late], "separation": plan["separation"] | reported}
        return [fault for fault in Judge().faults(both, together) if "twice" not in fault]

    stated = {"unresolved": [{"code": "too_near", "uavs": ["Tern", "Gull"], "missions": [None, None]}]}
    assert beside(0.0)
    assert beside(40.0)
    assert beside(2 * route["duration_s"]) == []
    assert beside(0.0, **stated) == []
    assert "are not" in beside(2 * route["duration_s"], **stated)[0]


def test_an_approved_mission_in_the_way_is_seen() -> None:
    here = world()
    elsewhere()
    author = a_user()
    asked = request(here.towers[5], uavs=(uav(**HOME),), departs_at=NOON)
    plan = make_plan(request=asked)
    other = stored(asked, plan, author)
    Mission.objects.filter(pk=other.pk).update(state=MissionState.APPROVED)
    apart = replace(asked, organisation=author.organisation_id)
    assert "pass one place" in Judge().faults(apart, plan)[0]
    assert Judge().faults(apart, make_plan(request=apart)) == []
    assert Judge().faults(replace(apart, mission=str(other.pk)), plan) == []
    assert Judge().faults(replace(apart, departs_at=NOON + timedelta(hours=2)), plan) == []


# --- heights ------------------------------------------------------------------------------------------------------------------


def test_heights_that_are_not_over_the_ground_are_seen(tmp_path: Path) -> None:
    here = world()
    elsewhere()
    hills = Hills()
    hills.bring_in(tmp_path / "hills.tif")
    asked = request(here.towers[5])
    plan = make_plan(request=asked)
    assert Judge(hills).faults(asked, plan) == []
    points = plan["routes"][0]["waypoints"]
    low = [point | {"altitude_amsl_m": point["altitude_amsl_m"] - 5.0} for point in points]
    assert any("not as high" in fault for fault in Judge(hills).faults(asked, plan | {"routes": [plan["routes"][0] | {"waypoints": low}]}))
    assert any("nobody knows" in fault for fault in Judge().faults(asked, plan))


# --- a lost link --------------------------------------------------------------------------------------------------------------


def test_what_is_said_of_a_lost_link_is_counted_anew() -> None:
    here = world()
    zone_around((10.010, 55.9975), half_deg=0.0008, name="School")
    battery = Performance(battery_wh=IRIS_BATTERY_WH)
    home = LostLinkRequest(LostLink.RETURN)
    asked = request(here.towers[5], uavs=(uav(performance=battery),), lost_link=home)
    plan = make_plan(request=asked)
    failed = plan["lost_link"]["failed"]
    assert any(item["zone"] == "School" for item in failed)
    assert Judge().faults(asked, plan) == []

    def reported(items: list[dict[str, Any]]) -> list[str]:
        return Judge().faults(asked, plan | {"lost_link": plan["lost_link"] | {"failed": items}})

    assert "it meets ['School']" in reported(failed[1:])[0]
    assert "does not meet ['Moor']" in reported([*failed, failed[0] | {"zone": "Moor"}])[0]
    assert any(
        "needs no more than" in fault for fault in reported([*failed, failed[0] | {"trouble": "battery", "missing_wh": 1.0, "zone": None}])
    )
    assert any("above ground" in fault for fault in reported([*failed, failed[0] | {"trouble": "too_high", "over_m": 5.0, "zone": None}]))
    assert any("from nowhere" in fault for fault in reported([*failed, failed[0] | {"waypoint": 999}]))
    on = replace(asked, lost_link=replace(home, behaviour=LostLink.GO_ON))
    assert Judge().faults(on, plan) == ["a UAV that goes on is said to fail to return"]


def test_a_return_through_wires_has_to_be_told() -> None:
    """Wires of 110 m that the route goes round and the straight way back does not: it would be 5 m above the greatest height."""
    here = world()
    elsewhere()
    power_line([ground.tower((lon, 55.9975), height_m=110.0) for lon in (9.997, 10.005)])
    rebuild()
    asked = request(here.towers[0], uavs=(uav((10.001, 55.9965)),), lost_link=LostLinkRequest(LostLink.RETURN))
    plan = make_plan(request=asked)
    failed = plan["lost_link"]["failed"]
    assert {(item["trouble"], item["over_m"]) for item in failed} == {("obstacle", 5.0)}
    assert Judge().faults(asked, plan) == []
    silent = Judge().faults(asked, plan | {"lost_link": plan["lost_link"] | {"failed": []}})
    assert any("it would fly 125 m above ground" in fault for fault in silent)


def test_a_return_that_the_battery_does_not_allow_has_to_be_told() -> None:
    here = world()
    elsewhere()
    most_wh = make_plan(request=request(here.towers[5], uavs=(uav(performance=Performance(battery_wh=IRIS_BATTERY_WH)),)))[
        "total_energy_wh"
    ]
    tight = uav(performance=Performance(battery_wh=1.1 * most_wh / 0.8))
    asked = request(here.towers[5], uavs=(tight,), lost_link=LostLinkRequest(LostLink.HOLD, hold_s=120.0))
    plan = make_plan(request=asked)
    failed = plan["lost_link"]["failed"]
    assert {item["trouble"] for item in failed} == {"battery"}
    assert Judge().faults(asked, plan) == []
    silent = Judge().faults(asked, plan | {"lost_link": plan["lost_link"] | {"failed": []}})
    assert any("it needs" in fault for fault in silent)
    wrong = [item | {"missing_wh": item["missing_wh"] + 2.0} for item in failed]
    assert any("it lacks" in fault for fault in Judge().faults(asked, plan | {"lost_link": plan["lost_link"] | {"failed": wrong}}))


# --- by hand ------------------------------------------------------------------------------------------------------------------


def test_why_a_change_by_hand_is_refused_is_judged() -> None:
    here = world()
    zone_around((10.003, 55.9935), half_deg=0.0005, name="Hospital")
    asked = request(here.towers[5], uavs=(uav(performance=Performance(battery_wh=IRIS_BATTERY_WH)),))
    plan = make_plan(request=asked)
    route = plan["routes"][0]
    by_hand = ManualEditOracle(Judge(), a_user())
    wished = [point | {"was": number, "from": point["position"], "put_in": False} for number, point in enumerate(route["waypoints"])]
    aside = wished[0] | {"kind": "pass", "position": [10.003, 55.9935], "was": None, "from": [10.003, 55.9935], "put_in": True}
    through = [wished[0], aside, *wished[1:]]

    def is_true(points: list[dict[str, Any]], place: str, stated: str) -> bool:
        return by_hand._is_true(asked, 0, route, points, place, stated)

    assert is_true(through, "legs.0", "This leg meets Hospital.")
    assert is_true(through, "legs.1", "This leg meets Hospital.")
    assert not is_true(through, "legs.2", "This leg meets Hospital.")
    assert not is_true(wished, "legs.0", "This leg meets Hospital.")
    assert not is_true(wished, "waypoints", "The route passes a mast, wires or a bridge too near.")
    assert not is_true(wished, "legs.0", "Something tall stands here: fly at 105 m above ground over it.")
    assert not is_true(wished, "waypoints", "The battery of Tern lacks 5.0 Wh for this.")
    assert not is_true(wished, "waypoints", "This is 2.0 km; the range of Tern is 1.0 km.")
    assert not is_true(wished, "waypoints", "The wind is too strong for Tern on a leg.")
    assert not is_true(wished, "waypoints.1.altitude_agl_m", "Between 60 and 120 m above ground here.")
    assert not is_true(wished, "waypoints.0.position", "Start, end and targets stay where they are.")
    high = [*wished[:1], wished[1] | {"altitude_agl_m": 130.0}, *wished[2:]]
    assert is_true(high, "waypoints.1.altitude_agl_m", "Between 60 and 120 m above ground here.")
