"""Plans among zones that are not always in force, or not at all heights."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import LineString

from inspection.models import NoFlyZone
from missions.services import make_plan
from planning.problem import Objective
from planning.request import EndAction
from tests.missions.worlds import request, uav, world, zone_around

pytestmark = pytest.mark.django_db

MONDAY_NOON = datetime(2026, 11, 23, 12, 0, tzinfo=UTC)
AT_THE_LINE = (10.010, 56.0)


def timed_zone(begins: datetime, ends: datetime, half_deg: float = 0.0005, **facts: Any) -> NoFlyZone:
    """Across the line between the third and the fourth tower."""
    zone = zone_around(AT_THE_LINE, half_deg, name="Air show")
    period = {"startDateTime": f"{begins:%Y-%m-%dT%H:%M:%SZ}", "endDateTime": f"{ends:%Y-%m-%dT%H:%M:%SZ}", "schedule": []}
    NoFlyZone.objects.filter(pk=zone.pk).update(schedule=[period], **facts)
    zone_around((0.0, 0.0), 0.0001, name="elsewhere, so that the ground has changed")
    return NoFlyZone.objects.get(pk=zone.pk)


def crosses(plan: dict[str, Any], zone: NoFlyZone) -> bool:
    return any(LineString(route["geometry"]["coordinates"]).intersects(zone.geometry) for route in plan["routes"] if route["geometry"])


def test_a_zone_that_is_over_before_the_departure_bars_nothing() -> None:
    here = world()
    zone = timed_zone(MONDAY_NOON - timedelta(hours=5), MONDAY_NOON - timedelta(hours=1))
    plan = make_plan(request=request(here.towers[5], departs_at=MONDAY_NOON))
    assert crosses(plan, zone)
    assert plan["is_proven"]


def test_without_a_departure_a_zone_bars_at_any_time() -> None:
    here = world()
    zone = timed_zone(MONDAY_NOON - timedelta(hours=5), MONDAY_NOON - timedelta(hours=1))
    assert not crosses(make_plan(request=request(here.towers[5])), zone)


def test_a_zone_in_force_during_the_flight_is_kept_clear_of() -> None:
    here = world()
    zone = timed_zone(MONDAY_NOON - timedelta(hours=1), MONDAY_NOON + timedelta(hours=1))
    assert not crosses(make_plan(request=request(here.towers[5], departs_at=MONDAY_NOON)), zone)


def test_a_zone_that_comes_into_force_after_the_uav_has_passed_is_flown_through() -> None:
    here = world()
    zone = timed_zone(MONDAY_NOON + timedelta(hours=1), MONDAY_NOON + timedelta(hours=2))
    plan = make_plan(request=request(here.towers[5], departs_at=MONDAY_NOON))
    assert crosses(plan, zone)
    assert plan["routes"][0]["arrival_s"][-1] < 3_600 - 300


def test_a_zone_that_comes_into_force_on_the_way_is_kept_clear_of_with_its_margin() -> None:
    here = world()
    zone = timed_zone(MONDAY_NOON + timedelta(minutes=5), MONDAY_NOON + timedelta(hours=2))  # five minutes are the margin
    assert not crosses(make_plan(request=request(here.towers[5], departs_at=MONDAY_NOON)), zone)


def test_a_zone_far_above_the_flight_bars_nothing_and_one_at_its_height_does() -> None:
    here = world()
    zone = zone_around(AT_THE_LINE, 0.0005)
    for lower_m, is_crossed in ((300.0, True), (65.0, False)):
        NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=lower_m, lower_reference="AGL")
        zone_around((0.0, lower_m / 10), 0.0001)
        assert crosses(make_plan(request=request(here.towers[5])), zone) is is_crossed


def test_a_limit_that_cannot_be_compared_reaches_the_flight() -> None:
    here = world()
    zone = zone_around(AT_THE_LINE, 0.0005)
    for reference in ("AMSL", "WGS84", "STD"):
        NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=3_000.0, lower_reference=reference)
        zone_around((0.0, {"AMSL": 1, "WGS84": 2, "STD": 3}[reference]), 0.0001)
        assert not crosses(make_plan(request=request(here.towers[5])), zone)


def test_each_waypoint_has_its_arrival_and_the_battery_left() -> None:
    here = world()
    plan = make_plan(request=request(here.towers[5], uavs=(uav(),), departs_at=MONDAY_NOON))
    (route,) = plan["routes"]
    assert len(route["arrival_s"]) == len(route["waypoints"])
    assert route["arrival_s"] == sorted(route["arrival_s"])
    assert route["used_wh"] is None


@pytest.mark.parametrize("half_deg", [0.0005, 0.008])
def test_a_plan_that_goes_round_a_zone_of_its_time_tells_how_far_it_is_from_the_plan_without_it(half_deg: float) -> None:
    """Round the small one it leaves the line, which counts double, and flies no more metres."""
    here = world()
    timed_zone(MONDAY_NOON - timedelta(hours=1), MONDAY_NOON + timedelta(hours=1), half_deg)
    round_it = make_plan(request=request(here.towers[5], departs_at=MONDAY_NOON))
    without = make_plan(request=request(here.towers[5], departs_at=MONDAY_NOON + timedelta(hours=3)))
    assert (without["is_proven"], without["gap_of"]) == (True, "all_plans")
    assert (round_it["is_proven"], round_it["gap_of"]) == (False, "without_timed_zones")
    more_m = max(0.0, round_it["total_length_m"] - without["lower_bound_m"])
    assert round_it["gap"] == pytest.approx(more_m / round_it["total_length_m"], abs=2e-6)
    assert (more_m > 100.0) == (half_deg > 0.001)


def test_two_uavs_from_one_place_are_kept_apart() -> None:
    here = world()
    both = (uav((10.0, 55.9999), name="Tern"), uav((10.0, 55.9999), name="Gull"))
    plan = make_plan(request=request(here.towers[5], here.towers[4], uavs=both, objective=Objective.MAKESPAN, departs_at=MONDAY_NOON))
    assert sorted(route["departs_s"] > 0 for route in plan["routes"]) == [False, True]
    late = max(plan["routes"], key=lambda route: route["departs_s"])
    assert late["arrival_s"][0] > late["departs_s"] >= plan["separation"]["time_s"]
    assert plan["separation"]["unresolved"] == []


def test_under_a_zone_that_begins_above_the_flight_a_uav_takes_off_and_targets_are_inspected() -> None:
    here = world()
    for centre in ((10.0, 55.9999), (10.020, 56.0)):
        zone = zone_around(centre, 0.0005)
        NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=300.0, lower_reference="AGL")
    zone_around((0.0, 0.0), 0.0001)
    plan = make_plan(request=request(here.towers[5], uavs=(uav((10.0, 55.9999)),)))
    assert plan["unassigned"] == plan["warnings"] == []


def test_a_zone_that_ends_below_the_flight_bars_take_off_and_is_flown_over() -> None:
    here = world()
    zone = zone_around(AT_THE_LINE, 0.0005)
    NoFlyZone.objects.filter(pk=zone.pk).update(upper_limit_m=25.0, upper_reference="AGL")
    zone_around((0.0, 0.0), 0.0001)
    assert crosses(make_plan(request=request(here.towers[5])), zone)
    grounded = make_plan(request=request(here.towers[5], uavs=(uav(AT_THE_LINE),)))
    assert [warning["code"] for warning in grounded["warnings"]] == ["uav_inside_zone"]


def test_a_uav_does_not_land_through_a_zone_below_its_target() -> None:
    here = world(height_m=40.0)
    zone = zone_around(here.towers[3].centre.coords, 0.0003)
    NoFlyZone.objects.filter(pk=zone.pk).update(upper_limit_m=15.0, upper_reference="AGL")
    zone_around((0.0, 0.0), 0.0001)
    landing = (uav((10.0, 55.9999), end_action=EndAction.LAND),)
    alone = make_plan(request=request(here.towers[3], uavs=landing))
    assert [item["reason"] for item in alone["unassigned"]] == ["inside_zone"]
    both = make_plan(request=request(here.towers[3], here.towers[5], uavs=landing))
    assert both["routes"][0]["targets"] == [0, 1]
