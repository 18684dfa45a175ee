"""Missions with targets of which every part is photographed: planned, stored, approved, refused."""

from itertools import pairwise
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest
from django.contrib.gis.geos import MultiPolygon, Polygon
from django.core.cache import cache
from django.test import Client
from django.utils import timezone
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from inspection.geodesy.local_frame import LocalFrame
from inspection.models import Asset
from inspection.network.spans import spans_of
from inspection.selectors.planning import planning_read
from missions.models import Mission, MissionState, Uav, UavType
from missions.selectors import photo_flights
from missions.selectors.missions import mission_of_organisation
from missions.services.approval.checks import reasons_against
from missions.services.approval.document import approval_document, frozen_route
from missions.services.commands.flight_progress import mark_waypoint_reached
from missions.services.planning import planner
from planning.views.camera import camera_to_json
from planning.views.catalogue import catalogue
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.missions.api import post
from tests.missions.photo_missions import CAMERA, MASL_M, body, made, plan_photos_once, tern, terrain
from tests.missions.worlds import World, power_line, rebuild, world, zone_around
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db

VIEWS = {"gsd_mm": 4, "camera_key": "dji-m30t-zoom"}
WIDE_CAMERA = catalogue()["dji-m30t-wide"].camera
WIRES_CAMERA = catalogue()["dji-p1-50"].camera


@pytest.fixture(autouse=True)
def _nothing_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    cache.clear()
    plan_photos_once(monkeypatch)


@pytest.fixture
def here(tmp_path: Path) -> World:
    found = world(height_m=30.0)
    terrain(tmp_path)
    return found


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def photos_of(asset: Any, **wishes: Any) -> dict[str, Any]:
    return {"asset": asset.pk, "task": {"kind": "photo", "views": VIEWS | wishes}}


def photos(plan: dict[str, Any], uav: int = 0) -> list[dict[str, Any]]:
    return [row for row in plan["routes"][uav]["waypoints"] if row["task"] and row["task"].get("view")]


def unassigned(mission: dict[str, Any]) -> str:
    (item,) = mission["plan"]["unassigned"]
    return f"{item['reason']}: {item['why'][0]['code']}"


def test_every_photo_is_a_waypoint_of_the_route(here: World, client: Client) -> None:
    mission = made(client, body(photos_of(here.towers[2]), {"asset": here.towers[4].pk}))
    plan = mission["plan"]
    assert plan["unassigned"] == []
    taken = photos(plan)
    assert len(taken) >= 4
    assert {row["target"] for row in taken} == {0}
    assert all(row["altitude_amsl_m"] == pytest.approx(MASL_M + row["altitude_agl_m"], abs=0.02) for row in taken)
    assert min(row["altitude_agl_m"] for row in taken) >= 4.0 - 0.01
    frame = LocalFrame.around(*here.towers[2].centre.coords)
    for row in taken:
        _east_m, north_m = frame.to_metres(np.array([row["position"]]))[0]
        view = row["task"]["view"]
        assert abs(north_m) >= view["clearance_m"] or row["altitude_agl_m"] >= 30.0 + view["clearance_m"], "beside the line, or over it"
    assert [row["kind"] for row in plan["routes"][0]["waypoints"]].count("target") == 2
    stored = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert [row["task"] for row in stored["plan"]["routes"][0]["waypoints"]] == [row["task"] for row in plan["routes"][0]["waypoints"]]
    task = stored["targets"][0]["task"]
    assert (task["kind"], task["hold_s"], task["views"]["gsd_mm"], task["views"]["camera"]["name"]) == ("photo", 3.0, 4.0, CAMERA.name)
    assert stored["targets"][0]["sensor"] == CAMERA.name


def test_what_is_flown_is_slow_beside_wires_and_aims(here: World, client: Client) -> None:
    answer = made(client, body(photos_of(here.towers[2])))
    mission = mission_of_organisation(Organisation.objects.get(), answer["id"])
    frozen = frozen_route(mission.routes.get(), mission)
    slow = {waypoint.sequence for waypoint in frozen.waypoints if waypoint.speed_mps == 4.0}
    taken = {waypoint.sequence for waypoint in frozen.waypoints if waypoint.task and waypoint.task.view}
    assert taken < slow
    assert len(slow) < len(frozen.waypoints) - 1, "on the way it flies as fast as else"
    items = approval_document(mission)["routes"][0]["flights"][0]["items"]["mission"]
    assert [item[0] for item in items].count(2000) == len(taken), "IMAGE_START_CAPTURE"
    assert [item[0] for item in items].count(195) == len(taken), "DO_SET_ROI_LOCATION"
    assert not answer["plan"]["routes"][0]["speeds_by_hand"]


@pytest.mark.long
def test_photos_are_planned_once_for_the_same_map(here: World, client: Client) -> None:
    uav, counted = tern(), mock.Mock(wraps=photo_flights.detail_plan)
    with mock.patch.object(photo_flights, "detail_plan", counted):
        first = made(client, body(photos_of(here.towers[2]), uav=uav))
        second = made(client, body(photos_of(here.towers[2]), uav=uav))
        assert counted.call_count == 1
        assert photos(first["plan"]) == photos(second["plan"])
        power_line([ground.tower((10.2, 56.1)), ground.tower((10.204, 56.1))])
        zone_around((10.3, 56.2))
        made(client, body(photos_of(here.towers[2]), uav=uav))
        assert counted.call_count == 2, "another map"


def test_a_plan_of_photos_on_the_map_is_the_missions(here: World, client: Client) -> None:
    plan = post(client, "view-plans", {"asset": here.towers[2].pk} | VIEWS).json()
    with mock.patch.object(photo_flights, "detail_plan", side_effect=AssertionError("it is kept")):
        mission = made(client, body(photos_of(here.towers[2])))
    assert [row["position"] for row in photos(mission["plan"])] == [pytest.approx(own["position"], abs=1e-7) for own in plan["photos"]]


@pytest.mark.long
def test_an_overview_is_flown_as_four_photos_and_kept_apart_from_every_part(here: World, client: Client) -> None:
    uav = tern()
    UavType.objects.update(cameras=[camera_to_json(WIDE_CAMERA)])
    overview = {"asset": here.towers[2].pk, "task": {"kind": "photo", "views": {"pattern": "overview", "camera_key": "dji-m30t-wide"}}}
    answer = made(client, body(overview, uav=uav))
    views = answer["targets"][0]["task"]["views"]
    assert (views["pattern"], views["gsd_mm"]) == ("overview", 50.0)
    assert len(photos(answer["plan"])) == 4
    detail = made(client, body(photos_of(here.towers[2], gsd_mm=50, camera_key="dji-m30t-wide"), uav=uav))
    assert "pattern" not in detail["targets"][0]["task"]["views"]
    assert [row["position"] for row in photos(detail["plan"])] != [row["position"] for row in photos(answer["plan"])]
    mission = mission_of_organisation(Organisation.objects.get(), answer["id"])
    frozen = frozen_route(mission.routes.get(), mission)
    assert sum(waypoint.task is not None and waypoint.task.view is not None for waypoint in frozen.waypoints) == 4


@pytest.mark.long
def test_wires_of_neighbouring_towers_are_photographed_from_both_sides(here: World, client: Client) -> None:
    uav = tern()
    UavType.objects.update(cameras=[camera_to_json(WIRES_CAMERA)])
    wires = {"kind": "photo", "views": {"pattern": "spans", "camera_key": "dji-p1-50", "gsd_mm": 8}}
    answer = made(client, body(*({"asset": here.towers[place].pk, "task": wires} for place in (2, 3)), uav=uav))
    assert answer["plan"]["unassigned"] == []
    assert [row["task"]["views"]["pattern"] for row in answer["targets"]] == ["spans", "spans"]
    frame = LocalFrame.around(*here.towers[2].centre.coords)
    span_m = float(frame.to_metres(np.array([here.towers[3].centre.coords]))[0, 0])
    for target, away_m in ((0, 0.0), (1, span_m)):
        taken = [row for row in photos(answer["plan"]) if row["target"] == target]
        at = frame.to_metres(np.array([row["position"] for row in taken])) - np.array([away_m, 0.0])
        assert {bool(north_m > 0.0) for north_m in at[:, 1]} == {True, False}, "from both sides of the line, which leads east"
        assert np.abs(at[:, 1]).min() >= taken[0]["task"]["view"]["clearance_m"]
        assert span_m / 4.0 < np.abs(at[:, 0]).max() <= span_m / 2.0 + 0.1, "up to the middle of the spans"
    mission = mission_of_organisation(Organisation.objects.get(), answer["id"])
    frozen = frozen_route(mission.routes.get(), mission)
    assert sum(waypoint.task is not None and waypoint.task.view is not None for waypoint in frozen.waypoints) == len(photos(answer["plan"]))


def test_without_the_camera_no_uav_takes_them(here: World, client: Client) -> None:
    uav = tern()
    UavType.objects.update(cameras=[])
    assert unassigned(made(client, body(photos_of(here.towers[2]), uav=uav))) == "not_allowed: no_uav_with_sensor"


def test_without_terrain_nobody_flies_beside_wires(client: Client) -> None:
    assert unassigned(made(client, body(photos_of(world(height_m=30.0).towers[2])))) == "no_photos: photos_need_terrain"


@pytest.mark.long
def test_terrain_that_ends_before_the_next_tower_is_not_enough(client: Client, tmp_path: Path) -> None:
    here = world(height_m=30.0)
    terrain(tmp_path, origin=(here.towers[2].centre.x - 0.002, 56.15))
    assert unassigned(made(client, body(photos_of(here.towers[2])))) == "no_photos: photos_need_terrain"


@pytest.mark.long
def test_terrain_that_ends_before_the_start_is_refused(client: Client, tmp_path: Path) -> None:
    here = world(height_m=30.0)
    terrain(tmp_path, origin=(10.004, 56.15))
    response = post(client, "missions", body(photos_of(here.towers[5])))
    assert response.status_code == 400, "its heights would count from ground that nobody knows"
    assert "targets.0.task" in response.json()["error"]["details"]


def test_a_zone_beside_the_tower_that_only_the_photos_would_meet(here: World, client: Client) -> None:
    lon, lat = here.towers[2].centre.coords
    zone_around((lon, lat + 0.00112), half_deg=0.0008)  # from 36 m to the north
    mission = made(client, body(photos_of(here.towers[2], gsd_mm=2)))
    assert unassigned(mission) == "inside_zone: photos_meet_zone"


def test_a_gsd_that_no_lens_reaches_and_wires_of_a_bridge_are_named(here: World, client: Client) -> None:
    uav = tern()
    fine = made(client, body(photos_of(here.towers[2], gsd_mm=0.1, camera_key="dji-p1-35"), uav=uav))
    assert unassigned(fine) == "no_photos: photos_none_possible"
    assert unassigned(made(client, body(photos_of(here.bridge, pattern="spans"), uav=uav))) == "no_photos: photos_not_a_tower"


@pytest.mark.parametrize("position", [None, [10.0082, 56.00605]])
def test_over_a_bridge_no_leg_of_its_photos_is_lower_than_its_keep_out(here: World, client: Client, position: list[float] | None) -> None:
    """Its tagged height and the usual 15 m over it are less than 12 m for masts on the deck and the clearance."""
    lon, lat = here.bridge.centre.coords
    outline = Polygon.from_bbox((lon - 3e-4, lat - 1e-4, lon + 3e-4, lat + 1e-4))  # 37 m by 22 m
    Asset.objects.filter(pk=here.bridge.pk).update(height_m=5.0, geometry=MultiPolygon(outline, srid=4326))
    rebuild()
    asked = photos_of(here.bridge) | ({} if position is None else {"position": position})
    mission = made(client, body(asked, photos_of(here.towers[2])))
    assert mission["plan"]["unassigned"] == []
    (route,) = mission["plan"]["routes"]
    rows = [row for row in route["waypoints"] if row["target"] == 0]
    places = LocalFrame.around(lon, lat).to_metres(np.array([row["position"] for row in rows]))
    agl_m = np.array([row["altitude_agl_m"] for row in rows])
    assert np.abs(places[0]).max() < 0.1, "photos are flown from over the middle"
    is_over = (np.abs(places) < (18.0, 11.0)).all(axis=1)
    assert is_over[[0, -1]].all()
    assert agl_m[is_over].min() >= 5.0 + 12.0 + 7.0
    promised = [row["promised"] for row in client.get(f"/api/v1/missions/{mission['id']}/coverage").json()["results"]]
    taken = [row["target"] for row in photos(mission["plan"])]
    assert [row["photos"] for row in promised] == [taken.count(0), taken.count(1)]
    shown = {row["component"]: row["shown"] for row in promised[0]["coverage"]["components"]}
    assert min(shown[kind] for kind in ("deck", "face")) > 0.9


@pytest.mark.parametrize(
    ("target", "field"),
    [
        ({"task": {"kind": "look", "views": VIEWS}}, "targets.0.task.views"),
        ({"task": {"kind": "photo", "views": VIEWS | {"gsd_mm": 0}}}, "targets.0.task.views.gsd_mm"),
        ({"task": {"kind": "photo", "views": {"gsd_mm": 2}}}, "targets.0.task.views.camera"),
        ({"task": {"kind": "photo", "views": VIEWS}, "sensor": "Lidar"}, "targets.0.sensor"),
        ({"asset": None, "position": [10.0, 56.0], "task": {"kind": "photo", "views": VIEWS}}, "targets.0.task"),
    ],
)
def test_what_is_wrong_with_photos_is_told_by_field(here: World, client: Client, target: dict[str, Any], field: str) -> None:
    response = post(client, "missions", body({"asset": here.towers[2].pk} | target))
    assert response.status_code == 400
    assert field in response.json()["error"]["details"]


def test_a_route_with_photos_is_not_bent_by_hand(here: World, client: Client) -> None:
    mission = made(client, body(photos_of(here.towers[2])))
    points = [
        {"position": row["position"], "altitude_agl_m": row["altitude_agl_m"], "was": place}
        for place, row in enumerate(mission["plan"]["routes"][0]["waypoints"])
    ]
    response = post(client, f"missions/{mission['id']}/routes/0/waypoints/look", {"waypoints": points})
    assert "planned photos" in str(response.json()), response.json()


def test_several_targets_with_photos_are_planned_by_a_job(here: World, client: Client) -> None:
    response = post(client, "missions", body(*(photos_of(tower) for tower in here.towers[1:4])))
    assert response.status_code == 202


@settings(max_examples=2, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 5), st.sampled_from([2.0, 4.0, 8.0]), st.floats(-90.0, 90.0), st.floats(18.0, 70.0))
def test_no_leg_of_photos_comes_near_any_wire(
    here: World, client: Client, tower: int, gsd_mm: float, turned_deg: float, beside_m: float
) -> None:
    """Against towers and wires of another line beside or across, wherever it is: measured from the stored waypoints."""
    frame = LocalFrame.around(*here.towers[tower].centre.coords)
    along = np.array([np.sin(np.radians(turned_deg)), np.cos(np.radians(turned_deg))])
    across = np.array([along[1], -along[0]])
    ends = frame.to_degrees(np.array([across * beside_m + along * side for side in (-150.0, 150.0)]))
    power_line([ground.tower(tuple(end), height_m=35.0) for end in ends.tolist()])
    zone_around((11.0, 57.0))
    Uav.objects.all().delete(), UavType.objects.all().delete()
    mission = made(client, body(photos_of(here.towers[tower], gsd_mm=gsd_mm)))
    waypoints = mission["plan"]["routes"][0]["waypoints"]
    taken = photos(mission["plan"])
    if not taken:
        assert mission["plan"]["unassigned"], "what is not flown is named"
        return
    clearance_m = taken[0]["task"]["view"]["clearance_m"]
    spans = spans_of(planning_read().ground().network())
    start, end = frame.to_metres(spans.start), frame.to_metres(spans.end)
    flown = [row for row in waypoints if row["target"] == 0]
    places = np.column_stack([frame.to_metres(np.array([row["position"] for row in flown])), [row["altitude_agl_m"] for row in flown]])
    for one, other in pairwise(places):
        for share in np.linspace(0.0, 1.0, 25):
            x, y, z = one + share * (other - one)
            for a, b, a_m, b_m in zip(start, end, spans.start_height_m, spans.end_height_m, strict=True):
                length2 = float(((b - a) ** 2).sum())
                part = 0.0 if length2 == 0.0 else float(np.clip(((np.array([x, y]) - a) @ (b - a)) / length2, 0.0, 1.0))
                away_m = float(np.hypot(*(np.array([x, y]) - a - part * (b - a))))
                assert away_m >= clearance_m - 0.3 or z >= a_m + part * (b_m - a_m) + clearance_m - 0.3
    Mission.objects.all().delete()


def test_photos_are_not_approved_on_another_map(here: World, client: Client) -> None:
    answer = made(client, body(photos_of(here.towers[2])))
    mission = mission_of_organisation(Organisation.objects.get(), answer["id"])
    assert "photos_outdated" not in [reason.code for reason in reasons_against(mission, now=timezone.now())]
    here.towers[1].height_m = 60.0
    here.towers[1].save()
    zone_around((11.0, 57.0))
    mission = mission_of_organisation(Organisation.objects.get(), answer["id"])
    assert "photos_outdated" in [reason.code for reason in reasons_against(mission, now=timezone.now())]


@pytest.mark.long
def test_a_map_that_changes_while_photos_are_planned_has_them_planned_anew(here: World, client: Client) -> None:
    """Photos and all else are of one map: a wire that came meanwhile is kept clear of."""
    uav, asked = tern(), []
    whole = planner.plan

    def plan_while_a_line_is_built(*values: Any, **names: Any) -> Any:
        found = whole(*values, **names)
        if not asked:
            frame = LocalFrame.around(*here.towers[2].centre.coords)
            ends = frame.to_degrees(np.array([[-200.0, 25.0], [200.0, 25.0]])).tolist()
            power_line([ground.tower(tuple(end), height_m=30.0) for end in ends])
            zone_around((11.0, 57.0))
        asked.append(found)
        return found

    with mock.patch.object(planner, "plan", plan_while_a_line_is_built):
        mission = made(client, body(photos_of(here.towers[2]), uav=uav))
    assert len(asked) == 2
    frame = LocalFrame.around(*here.towers[2].centre.coords)
    for row in photos(mission["plan"]):
        _east_m, north_m = frame.to_metres(np.array([row["position"]]))[0]
        clearance_m = row["task"]["view"]["clearance_m"]
        assert abs(north_m - 25.0) >= clearance_m or row["altitude_agl_m"] >= 30.0 + clearance_m


def test_a_target_is_in_progress_until_its_last_photo(here: World, client: Client) -> None:
    answer = made(client, body(photos_of(here.towers[2])))
    mission, uav = Mission.objects.get(pk=answer["id"]), Uav.objects.get()
    Mission.objects.update(state=MissionState.ACTIVE)
    rows = answer["plan"]["routes"][0]["waypoints"]
    own = [place for place, row in enumerate(rows) if row["target"] == 0]
    states = []
    for place in (own[0], own[1], own[-1], own[-1] + 1):
        mark_waypoint_reached(mission_id=mission.pk, uav_id=uav.pk, waypoint=place)
        states.append(mission.targets.get().state)
    assert states == ["in-progress", "in-progress", "in-progress", "complete"]


@pytest.mark.parametrize("hold_s", [0, 1.5, 61])
def test_the_time_at_a_photo_stops_the_uav_and_ends(here: World, client: Client, hold_s: float) -> None:
    response = post(client, "missions", body({"asset": here.towers[2].pk, "task": {"kind": "photo", "hold_s": hold_s, "views": VIEWS}}))
    assert response.status_code == 400
    assert "targets.0.task.hold_s" in response.json()["error"]["details"]
