"""Routes round a zone at its times, routes of several flights, and why they are flown so: what a page says and shows of them."""

import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from shapely.geometry import shape

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, look_at, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.planning.test_planning import sends
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

# Within the two days of the bar of legal times.
DAY = datetime.now(UTC).replace(hour=0, minute=0, second=0, microsecond=0) + timedelta(days=1)
CLOSE = 13.2
HALF_DEG = 0.004


def planned(page: Page, name: str, **options: Any) -> dict[str, Any]:
    towers = asks(page, f"/assets?kind=tower&bbox={region.spread_towers}&limit=200")["features"]
    picked = [{"asset": tower["id"]} for tower in towers[:: len(towers) // 4][:4]]
    uavs = [{"name": "Heron", "position": region.west}, {"name": "Kite", "position": region.east}]
    body = {"name": name, "uavs": uavs, "targets": picked, "objective": "makespan", "return_to_start": True, "plan": True}
    mission: dict[str, Any] = sends(page, "missions", body | options)
    return mission


def flies_through(mission: dict[str, Any], zone: dict[str, Any]) -> bool:
    lines = [shape(route["geometry"]) for route in mission["plan"]["routes"] if route["geometry"]]
    return any(line.intersects(shape(zone["geometry"])) for line in lines)


def opens(page: Page, mission: dict[str, Any]) -> None:
    page.goto(f"/missions/{mission['id']}")
    wait_for_map(page)


@pytest.fixture
def timed_zone(visitor: Visitor) -> Iterator[dict[str, Any]]:
    """In force from 14 to 17 h of one day, over a waypoint in the middle of a route."""
    page = visitor.signs_in("cora")
    (route, _other) = planned(visitor.signs_in("opal"), "Before the zone")["plan"]["routes"]
    longitude, latitude = route["waypoints"][len(route["waypoints"]) // 3]["position"]
    west, east, south, north = longitude - HALF_DEG, longitude + HALF_DEG, latitude - HALF_DEG, latitude + HALF_DEG
    ring = [[west, south], [east, south], [east, north], [west, north], [west, south]]
    hours = {"startDateTime": f"{DAY:%Y-%m-%d}T14:00:00Z", "endDateTime": f"{DAY:%Y-%m-%d}T17:00:00Z", "schedule": []}
    zone = sends(page, "zones", {"name": "Air show", "geometry": {"type": "Polygon", "coordinates": [ring]}, "schedule": [hours]})
    yield zone | {"middle": [longitude, latitude]}
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    gone = page.request.delete(f"/api/v1/zones/{zone['id']}", headers={"X-CSRFToken": token, "If-Match": "*"})
    assert gone.ok, gone.text()


def test_a_route_goes_round_a_timed_zone_at_its_times_alone_and_the_page_says_so(
    visitor: Visitor, picture: Picture, timed_zone: dict[str, Any]
) -> None:
    page = visitor.signs_in("opal")
    hours = {"Round it": 15, "While it sleeps": 20}
    awake, asleep = (planned(page, name, departs_at=(DAY + timedelta(hours=hour)).isoformat()) for name, hour in hours.items())
    assert [flies_through(mission, timed_zone) for mission in (awake, asleep)] == [False, True]
    opens(page, awake)
    expect(page.locator("#zone-keys")).to_contain_text("zone passed by, not entered")
    expect(page.locator("#zone-keys")).to_contain_text("Zones count 5\xa0min before and after their times")
    look_at(page, timed_zone["middle"], CLOSE)
    in_both_themes(page, picture, "plan-timed-zone")
    page.get_by_role("button", name="Why does Heron fly this route?").click()
    why = page.get_by_role("complementary", name="Why Heron flies this way")
    expect(why).to_contain_text(f"{DAY.day} {DAY:%B}, 14:00 to 17:00")
    in_both_themes(page, picture, "plan-explained")
    assert faults(page) == []
    opens(page, asleep)
    expect(page.locator("#zone-keys")).to_contain_text("zone not in force when the UAV comes by")
    look_at(page, timed_zone["middle"], CLOSE)
    in_both_themes(page, picture, "plan-zone-asleep")
    page.get_by_role("button", name="When are the zones open?").click()
    dialog = page.get_by_role("dialog", name="When are the zones open?")
    expect(dialog).to_contain_text(re.compile("Zones open for .* of the next 48 hours. Zones count 5\xa0min before and after their times"))
    expect(dialog).to_contain_text(f"{DAY.day} {DAY:%B}, 14:00 to 17:00")
    expect(dialog).to_contain_text(re.compile("Heron, (start to A1, A1 to A2|A1 to A2, A2 to A3)"))
    in_both_themes(page, picture, "plan-legal-zone")
    page.set_viewport_size({"width": 390, "height": 844})
    in_both_themes(page, picture, "plan-legal-zone-phone")


@pytest.mark.long
def test_what_does_not_fit_in_one_flight_is_shown_as_several(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    uav = {"name": "Kite", "position": region.east, "battery_wh": region.sortie_battery_wh, "max_airspeed_mps": 15.0, "sorties": 4}
    mission = planned(page, "In several flights", uavs=[uav], departs_at=(DAY + timedelta(hours=9)).isoformat())
    (route,) = mission["plan"]["routes"]
    assert "base" in [waypoint["kind"] for waypoint in route["waypoints"]], [mission["plan"]["unassigned"], route["energy_wh"]]
    opens(page, mission)
    expect(page.get_by_role("list", name="Routes")).to_contain_text("flights")
    in_both_themes(page, picture, "plan-sorties")


@pytest.mark.long
def test_on_a_phone_several_warnings_take_one_line(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal", size=(390, 844), touch=True)
    towers = asks(page, f"/assets?kind=tower&bbox={region.spread_towers}&limit=200")["features"]
    picked = [{"asset": tower["id"], "sensor": "LiDAR" if number else ""} for number, tower in enumerate(towers[:: len(towers) // 3][:3])]
    heron = {"name": "Heron", "position": region.west, "max_range_m": 2_000.0}
    mission = planned(page, "Out of range", uavs=[heron], targets=picked)
    assert len({item["reason"] for item in mission["plan"]["unassigned"]}) > 1
    opens(page, mission)
    fold = page.locator(".notice-fold summary.notice")
    expect(fold).to_contain_text(re.compile(r"\d warnings"))
    expect(page.get_by_text("Which targets").first).to_be_hidden()
    in_both_themes(page, picture, "plan-warnings-folded-phone")
    fold.click()
    expect(page.get_by_text("Which targets").first).to_be_visible()
    in_both_themes(page, picture, "plan-warnings-phone")
    assert faults(page) == []
