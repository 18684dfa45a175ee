"""What UAVs do when their link is lost: wished for, checked, stored."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from missions.models import Mission
from missions.services import make_plan, request_of_mission, request_to_json
from missions.services.mission_plans import PLANNING_TASK
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.missions.api import TERN, mission_body, patch, plan_body, post
from tests.missions.worlds import World, power_line, rebuild, zone_around
from workspace.models import Job, JobState

pytestmark = pytest.mark.django_db
IRIS = TERN | {"position": [10.0, 55.9999], "cruise_speed_mps": 8.0, "battery_wh": 56.6, "max_airspeed_mps": 11.0}


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def checked(client: Client, here: World, **wished: Any) -> dict[str, Any]:
    plan = post(client, "plans", plan_body(here.towers[5], uavs=[IRIS], lost_link=wished)).json()
    found: dict[str, Any] = plan["lost_link"]
    return found


def test_who_goes_on_has_nothing_to_be_checked(here: World, client: Client) -> None:
    plan = post(client, "plans", plan_body(here.towers[5])).json()
    wished = {"behaviour": "go_on", "rally_points": [], "hold_s": 0.0}
    assert plan["lost_link"] == wished | {"failed": [], "highest_m": [None], "rally_points_in_zones": []}


def test_a_zone_between_the_route_and_its_start_bars_the_return_and_a_rally_point_mends_it(here: World, client: Client) -> None:
    assert checked(client, here, behaviour="return")["failed"] == []
    zone_around((10.010, 55.9998), 0.0012, name="Fire brigade")
    failed = checked(client, here, behaviour="return")["failed"]
    assert {one["trouble"] for one in failed} == {"zone"}
    assert {one["zone"] for one in failed} == {"Fire brigade"}
    assert {one["return_point"] for one in failed} == {0}
    repaired = checked(client, here, behaviour="return", rally_points=[[10.021, 56.0005]])["failed"]
    assert len(repaired) < len(failed)


def test_over_wires_between_tall_towers_it_returns_higher_and_says_how_high(here: World, client: Client) -> None:
    power_line([ground.tower((lon, 55.998), height_m=90.0) for lon in (10.006, 10.011)])
    rebuild()
    start = IRIS | {"position": [10.009, 55.995]}
    plan = post(client, "plans", plan_body(here.towers[2], uavs=[start], lost_link={"behaviour": "return"})).json()
    assert plan["lost_link"]["failed"] == []
    assert plan["lost_link"]["highest_m"] == [105.0]


def test_the_wish_is_stored_with_the_mission_and_checked_with_its_plan(here: World, client: Client) -> None:
    wish = {"behaviour": "hold", "rally_points": [[10.021, 56.0005]], "hold_s": 60.0}
    mission = post(client, "missions", mission_body(here.towers[5], uavs=[IRIS], lost_link=wish) | {"plan": True}).json()
    assert mission["lost_link"] == wish
    assert mission["plan"]["lost_link"] == wish | {"failed": [], "highest_m": [60.0], "rally_points_in_zones": []}
    again = post(client, f"missions/{mission['id']}/plan").json()
    assert again["plan"]["lost_link"] == mission["plan"]["lost_link"]


def test_a_stored_check_of_the_version_before_is_read(here: World, client: Client) -> None:
    """It calls the return point `haven`, and an approval may freeze it as it is."""
    zone_around((10.010, 55.9998), 0.0012)
    mission = planned(client, here, lost_link={"behaviour": "return"})
    stored = Mission.objects.get(pk=mission["id"])
    for one in stored.lost_link_check["failed"]:
        one["haven"] = one.pop("return_point")
    stored.save(update_fields=["lost_link_check"])
    shown = client.get(f"/api/v1/missions/{mission['id']}").json()["plan"]["lost_link"]
    assert shown["failed"] == mission["plan"]["lost_link"]["failed"] != []


def planned(client: Client, here: World, **extra: Any) -> dict[str, Any]:
    mission: dict[str, Any] = post(client, "missions", mission_body(here.towers[5], uavs=[IRIS], **extra) | {"plan": True}).json()
    return mission


def test_another_wish_leaves_the_routes_and_is_checked_on_them_as_a_new_plan_would(here: World, client: Client) -> None:
    zone_around((10.010, 55.9998), 0.0012, name="Fire brigade")
    wish = {"behaviour": "return", "rally_points": [], "hold_s": 0.0}
    mission = planned(client, here)
    assert mission["plan"]["lost_link"]["failed"] == []  # it goes on
    changed = patch(client, f"missions/{mission['id']}", {"lost_link": wish}).json()
    assert changed["revision"] == mission["revision"] + 1
    assert changed["plan"]["routes"] == mission["plan"]["routes"]
    check = changed["plan"]["lost_link"]
    assert check["behaviour"] == "return"
    assert {one["zone"] for one in check["failed"]} == {"Fire brigade"}
    assert {one["zone_id"] for one in check["failed"]} == {NoFlyZone.objects.get(name="Fire brigade").pk}
    assert post(client, f"missions/{mission['id']}/plan").json()["plan"]["lost_link"] == check
    history = client.get(f"/api/v1/missions/{mission['id']}/history").json()["results"]
    assert [entry["action"] for entry in history] == ["plan", "change", "plan", "create"]


def test_a_small_battery_is_missed_by_the_same_wh_on_stored_routes(here: World, client: Client) -> None:
    wish = {"behaviour": "hold", "hold_s": 1200.0}
    mission = planned(client, here)
    failed = patch(client, f"missions/{mission['id']}", {"lost_link": wish}).json()["plan"]["lost_link"]["failed"]
    assert {one["trouble"] for one in failed} == {"battery"}
    fresh = post(client, f"missions/{mission['id']}/plan").json()["plan"]["lost_link"]["failed"]
    assert [one["missing_wh"] for one in failed] == pytest.approx([one["missing_wh"] for one in fresh], abs=0.02)


def test_a_draft_keeps_the_wish_without_a_check(here: World, client: Client) -> None:
    mission = post(client, "missions", mission_body(here.towers[5], uavs=[IRIS])).json()
    changed = patch(client, f"missions/{mission['id']}", {"lost_link": {"behaviour": "return"}}).json()
    assert (changed["lost_link"]["behaviour"], changed["plan"], changed["state"]) == ("return", None, "draft")


def test_a_route_changed_by_hand_is_checked_anew(here: World, client: Client) -> None:
    """A waypoint more before those that fail: their places move up by one."""
    zone_around((10.010, 55.9998), 0.0012, name="Fire brigade")
    mission = planned(client, here, lost_link={"behaviour": "return"})
    route, failed = mission["plan"]["routes"][0], mission["plan"]["lost_link"]["failed"]
    points = [{"position": at["position"], "altitude_agl_m": at["altitude_agl_m"], "was": was} for was, at in enumerate(route["waypoints"])]
    first, second = points[0]["position"], points[1]["position"]
    between = {"position": [(a + b) / 2 for a, b in zip(first, second, strict=True)], "altitude_agl_m": 60.0, "was": None}
    address = f"/api/v1/missions/{mission['id']}/routes/0/waypoints"
    body = {"waypoints": [points[0], between, *points[1:]]}
    answer = client.put(address, body, content_type="application/json", headers={"If-Match": "*"})
    assert answer.status_code == 200, answer.content
    now = answer.json()["plan"]["lost_link"]["failed"]
    assert {one["waypoint"] for one in now} == {one["waypoint"] + 1 for one in failed}


def test_the_plan_of_a_job_is_taken_though_the_wish_came_after_it(here: World, client: Client) -> None:
    request = request_of_mission(mission=Mission.objects.get(pk=planned(client, here)["id"]))
    job = Job.objects.create(
        task=PLANNING_TASK, state=JobState.DONE, parameters={"request": request_to_json(request)}, result=make_plan(request=request)
    )
    wish = {"behaviour": "hold", "hold_s": 1200.0}
    draft = post(client, "missions", mission_body(here.towers[5], uavs=[IRIS], lost_link=wish)).json()
    taken = patch(client, f"missions/{draft['id']}", {"plan": True, "plan_of": str(job.pk)}).json()
    assert taken["plan"]["lost_link"]["behaviour"] == "hold"
    assert {one["trouble"] for one in taken["plan"]["lost_link"]["failed"]} == {"battery"}


def test_a_rally_point_in_a_zone_is_told_though_no_uav_would_return_to_it(here: World, client: Client) -> None:
    zone_around((10.3, 56.3), name="Heliport")
    found = checked(client, here, behaviour="return", rally_points=[[10.021, 56.0005], [10.3, 56.3]])
    assert (found["failed"], found["rally_points_in_zones"]) == ([], [{"rally_point": 2, "zone": "Heliport"}])
