"""What photos prove: promised by the plan, rehearsed in wind, achieved by reported photos."""

import csv
import io
import math
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from unittest import mock
from uuid import uuid4

import pytest
from django.core.cache import cache
from django.test import Client

from inspection.models import Asset
from missions.models import Mission, MissionState, UavType, Waypoint
from missions.services import photo_coverage
from planning.views.camera import Camera, Gimbal, camera_to_json
from planning.views.catalogue import catalogue
from simulation.models import RehearsalTrack
from telemetry.models import Capture
from tests.accounts.users import a_user, client_of
from tests.cases import long
from tests.missions.api import post
from tests.missions.photo_missions import CAMERA, body, made, plan_photos_once, tern, terrain
from tests.missions.worlds import World, world
from tests.simulation.rehearsals.rehearsed import rehearsed
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db

TURNING = replace(CAMERA, gimbal=Gimbal(-120.0, 45.0))  # the UAV turns for its photos
WIDE = catalogue()["dji-m30t-wide"].camera
LONG = catalogue()["dji-p1-50"].camera
VIEWS = {"gsd_mm": 2, "camera": camera_to_json(TURNING)}
NOW = datetime(2026, 11, 29, 12, tzinfo=UTC)


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
def person() -> User:
    return a_user(Role.OPERATOR)


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


def planned(client: Client, *targets: dict[str, Any], camera: Camera = TURNING) -> Mission:
    uav = tern()
    UavType.objects.update(cameras=[camera_to_json(camera)])
    return Mission.objects.get(pk=made(client, body(*targets, uav=uav))["id"])


def coverage(client: Client, mission: Mission, query: str = "") -> list[dict[str, Any]]:
    answer = client.get(f"/api/v1/missions/{mission.pk}/coverage{query}")
    assert answer.status_code == 200, answer.content
    return answer.json()["results"]


def photographed(tower: Asset, camera: Camera = TURNING) -> dict[str, Any]:
    return {"asset": tower.pk, "task": {"kind": "photo", "views": VIEWS | {"camera": camera_to_json(camera)}}}


def photo_waypoints(mission: Mission, target: int = 0) -> list[Waypoint]:
    rows = Waypoint.objects.filter(route__mission=mission, target__sequence=target, task__has_key="view").order_by("sequence")
    return list(rows.select_related("route__mission_uav"))


def captured(mission: Mission, rows: list[Waypoint], **changed: Any) -> list[Capture]:
    """Photos as the plan has them, as a UAV reports them."""
    mission.state, mission.started_at, mission.ended_at = MissionState.COMPLETED, NOW, NOW
    mission.save()
    told = {
        "flight": 1,
        "time_source": "utc",
        "position_source": "photo",
        "roll_deg": 0.0,
        "yaw_frame": "earth",
        "attitude_source": "camera",
    }
    return Capture.objects.bulk_create(Capture(**{**_as_planned(mission, row), **told, **changed}) for row in rows)


def _as_planned(mission: Mission, row: Waypoint) -> dict[str, Any]:
    view = row.task["view"]
    return {
        "uav_id": row.route.mission_uav.uav_id, "mission": mission, "waypoint_sequence": row.sequence, "taken_at": NOW, "received_at": NOW,
        "position": row.position, "altitude_amsl_m": row.altitude_amsl_m, "pitch_deg": view["pitch_deg"], "yaw_deg": view["yaw_deg"],
    }  # fmt: skip


def test_the_plans_own_poses_show_what_a_plan_of_photos_promises(here: World, client: Client) -> None:
    plan = post(client, "view-plans", {"asset": here.towers[2].pk} | VIEWS).json()
    (found,) = coverage(client, planned(client, photographed(here.towers[2])))
    promised = found["promised"]
    assert promised["photos"] == len(plan["photos"])
    assert promised["not_counted"] == []
    assert promised["coverage"]["shown"] == pytest.approx(plan["coverage"]["shown"], abs=0.005)
    for own, of_plan in zip(promised["coverage"]["components"], plan["coverage"]["components"], strict=True):
        assert (own["component"], own["number"], own["area_m2"]) == (of_plan["component"], of_plan["number"], of_plan["area_m2"])
        assert own["shown"] == pytest.approx(of_plan["shown"], abs=0.05)
    assert (found["rehearsed"], found["achieved"], found["is_short"]) == ([], None, None)
    assert (found["camera"], found["gsd_mm"], found["asset"]) == (CAMERA.name, 2.0, here.towers[2].pk)


@pytest.mark.parametrize("camera", [*long(TURNING), CAMERA], ids=["nose", "gimbal of 90 degrees to each side"])
def test_photos_flown_in_wind_show_what_was_promised(here: World, client: Client, person: User, camera: Camera) -> None:
    mission = planned(client, photographed(here.towers[2], camera), camera=camera)
    rehearsal = rehearsed(mission, person, "calm", "strong-wind")
    (found,) = coverage(client, mission)
    assert [(own["code"], own["rehearsal"], own["is_outdated"]) for own in found["rehearsed"]] == [
        ("calm", str(rehearsal.pk), False), ("strong-wind", str(rehearsal.pk), False),
    ]  # fmt: skip
    for own in found["rehearsed"]:
        assert own["photos"] == found["promised"]["photos"]
        assert own["coverage"]["shown"] == pytest.approx(found["promised"]["coverage"]["shown"], abs=0.02)
        assert (own["deviations"], own["not_counted"]) == ([], [])


@pytest.mark.long
def test_an_overview_flown_in_wind_shows_what_was_promised(here: World, client: Client, person: User) -> None:
    overview = {"kind": "photo", "views": {"pattern": "overview", "camera": camera_to_json(WIDE)}}
    mission = planned(client, {"asset": here.towers[2].pk, "task": overview}, camera=WIDE)
    rehearsed(mission, person, "strong-wind")
    (found,) = coverage(client, mission)
    (windy,) = found["rehearsed"]
    assert windy["photos"] == found["promised"]["photos"] == 4
    assert windy["coverage"]["shown"] == pytest.approx(found["promised"]["coverage"]["shown"], abs=0.02)
    assert (windy["deviations"], windy["not_counted"]) == ([], [])


@pytest.mark.long
def test_photos_of_wires_flown_in_wind_show_what_was_promised(here: World, client: Client, person: User) -> None:
    wires = {"kind": "photo", "views": {"pattern": "spans", "gsd_mm": 8, "camera": camera_to_json(LONG)}}
    mission = planned(client, {"asset": here.towers[2].pk, "task": wires}, camera=LONG)
    rehearsed(mission, person, "strong-wind")
    (found,) = coverage(client, mission)
    (windy,) = found["rehearsed"]
    assert {row["component"] for row in found["promised"]["coverage"]["components"]} == {"wires"}
    assert found["promised"]["coverage"]["shown_of_reachable"] >= 0.99
    assert windy["photos"] == found["promised"]["photos"] >= 12
    assert windy["coverage"]["shown"] == pytest.approx(found["promised"]["coverage"]["shown"], abs=0.02)
    assert (windy["deviations"], windy["not_counted"]) == ([], [])


@pytest.mark.long
@pytest.mark.parametrize("beyond_deg", [0.0, 0.00003], ids=["in place", "2 m nearer to the other tower"])
def test_photos_of_wires_without_a_waypoint_count_for_the_tower_that_they_are_planned_for(
    here: World, client: Client, beyond_deg: float
) -> None:
    wires = {"kind": "photo", "views": {"pattern": "spans", "gsd_mm": 8, "camera": camera_to_json(LONG)}}
    mission = planned(client, *({"asset": here.towers[place].pk, "task": wires} for place in (2, 3)), camera=LONG)
    middle = (here.towers[2].centre.x + here.towers[3].centre.x) / 2.0
    rows = photo_waypoints(mission, target=1)
    own = min(rows, key=lambda row: abs(row.position.x - middle))
    for row in rows:
        row.position.x -= beyond_deg if row is own else 0.0
    captured(mission, rows, waypoint_sequence=None)
    first, second = coverage(client, mission)
    assert (first["achieved"]["photos"], second["achieved"]["photos"]) == (0, len(rows))


def test_photos_that_a_rehearsal_missed_or_took_of_something_else_are_named(here: World, client: Client, person: User) -> None:
    mission = planned(client, photographed(here.towers[2]))
    rehearsed(mission, person, "calm")
    track = RehearsalTrack.objects.get()
    photos = track.flights[0]["photos"]
    lost, turned = photos.pop(1), photos[3]
    turned["yaw_deg"] += 60.0
    track.save()
    (found,) = coverage(client, mission)
    (calm,) = found["rehearsed"]
    assert calm["photos"] == found["promised"]["photos"] - 1
    assert calm["coverage"]["shown"] < found["promised"]["coverage"]["shown"] - 0.02
    first, second = calm["deviations"]
    assert (first["photo"], first["waypoint"], first["off_m"]) == (2, lost["waypoint"], None)
    assert (second["photo"], second["waypoint"]) == (5, turned["waypoint"])
    assert second["off_m"] < 0.5 < 30.0 < second["off_deg"] <= 60.5


@pytest.mark.long
def test_a_rehearsal_of_another_plan_is_told_and_one_that_is_nowhere_is_not_there(here: World, client: Client, person: User) -> None:
    mission = planned(client, photographed(here.towers[2]))
    rehearsal = rehearsed(mission, person, "calm")
    post(client, f"missions/{mission.pk}/plan", {}, **{"HTTP_IF_MATCH": "*"})
    Mission.objects.filter(pk=mission.pk).update(departs_at=NOW)
    (calm,) = coverage(client, mission, f"?rehearsal={rehearsal.pk}")[0]["rehearsed"]
    assert (calm["is_outdated"], calm["deviations"]) == (True, [])
    assert client.get(f"/api/v1/missions/{mission.pk}/coverage?rehearsal={uuid4()}").status_code == 404
    assert client.get(f"/api/v1/missions/{mission.pk}/coverage?rehearsal=newest").status_code == 400


def test_photos_as_planned_achieve_what_was_promised(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]))
    captured(mission, photo_waypoints(mission))
    (found,) = coverage(client, mission)
    assert found["achieved"] == found["promised"] | {"deviations": []}
    assert (found["is_short"], found["missing"]) == (False, [])


@pytest.mark.long
def test_height_above_take_off_counts_more_than_a_height_above_the_sea_with_the_error_of_a_fix(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]))
    for capture, row in zip(captured(mission, photo_waypoints(mission)), photo_waypoints(mission), strict=True):
        capture.altitude_relative_m, capture.altitude_amsl_m = row.altitude_relative_m, row.altitude_amsl_m + 9.0
        capture.save()
    (found,) = coverage(client, mission)
    assert found["achieved"]["coverage"]["shown"] == pytest.approx(found["promised"]["coverage"]["shown"], abs=1e-3)


@pytest.mark.long
def test_without_a_photo_its_components_are_shown_less_and_the_rest_is_planned_by_one_request(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]), photographed(here.towers[4]))
    captured(mission, [*photo_waypoints(mission, 0), *photo_waypoints(mission, 1)[:2]])
    whole, part = coverage(client, mission)
    assert (whole["is_short"], part["is_short"]) == (False, True)
    before, after = (part[name]["coverage"]["components"] for name in ("promised", "achieved"))
    assert all(row["shown"] <= own["shown"] for own, row in zip(before, after, strict=True))
    assert any(row["shown"] < own["shown"] - 0.2 for own, row in zip(before, after, strict=True))
    lost = photo_waypoints(mission, 1)[2:]
    assert [(own["waypoint"], own["off_m"]) for own in part["achieved"]["deviations"]] == [(row.sequence, None) for row in lost]
    assert post(client, f"missions/{mission.pk}/follow-up", {"targets": [7]}).status_code == 409
    assert post(client, f"missions/{mission.pk}/follow-up", {"targets": []}).status_code == 400
    draft = post(client, f"missions/{mission.pk}/follow-up", {"targets": [part["target"]]}).json()
    assert [(own["asset"], own["task"]["views"]["gsd_mm"]) for own in draft["targets"]] == [(here.towers[4].pk, 2.0)]


PROVE_NOTHING: list[tuple[dict[str, Any], str]] = [
    ({"attitude_source": "vehicle"}, "attitude"),
    ({"yaw_frame": "vehicle"}, "attitude"),
    ({"yaw_frame": "", "attitude_source": "", "yaw_deg": None, "pitch_deg": None, "roll_deg": None}, "attitude"),
    ({"pitch_deg": None}, "attitude"),
    ({"pitch_deg": math.nan}, "attitude"),
    ({"yaw_deg": math.inf}, "attitude"),
    ({"altitude_amsl_m": None, "altitude_agl_m": 20.0}, "height"),
    ({"altitude_amsl_m": math.nan}, "height"),
    ({"altitude_amsl_m": 1e300}, "height"),
    ({"position": None}, "position"),
    ({"is_taken": False}, "failed"),
    ({"roll_deg": 4.0}, "tilted"),
    ({"altitude_amsl_m": 5_000.0}, "far"),
    ({"position": "POINT(-170 -89)"}, "far"),
]


@pytest.mark.long
def test_photos_that_prove_nothing_are_not_counted_and_told(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]))
    rows = photo_waypoints(mission)
    for changed, reason in PROVE_NOTHING:
        Capture.objects.all().delete()
        captured(mission, rows[:1], **changed)
        captured(mission, rows[1:])
        (found,) = coverage(client, mission)
        assert found["achieved"]["photos"] == len(rows) - 1, changed
        assert found["achieved"]["not_counted"] == [{"reason": reason, "count": 1}], changed
        first = found["achieved"]["deviations"][0]
        assert (first["photo"], first["not_counted"]) == (1, None if reason == "far" else reason), changed
        assert first["off_m"] > 1_000.0 if reason == "far" else first["off_m"] is None, changed


@pytest.mark.long
def test_a_photo_without_waypoint_belongs_to_the_nearest_tower(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]), photographed(here.towers[3]))
    captured(mission, [*photo_waypoints(mission, 0), *photo_waypoints(mission, 1)], waypoint_sequence=None, flight=None)
    for found in coverage(client, mission):
        assert found["achieved"] == found["promised"] | {"deviations": []}


def test_what_was_proven_is_kept_until_a_photo_comes(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]))
    rows = photo_waypoints(mission)
    captured(mission, rows[:-1])
    first = coverage(client, mission)
    counted = mock.Mock(wraps=photo_coverage.proof_surface)
    with mock.patch.object(photo_coverage, "proof_surface", counted):
        assert coverage(client, mission) == first
        assert counted.call_count == 0
        captured(mission, rows[-1:])
        (found,) = coverage(client, mission)
        assert counted.call_count == 1
    assert found["is_short"] is False


@pytest.mark.long
def test_targets_come_in_pages_and_all_of_them_in_the_file(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[1]), photographed(here.towers[3]))
    captured(mission, photo_waypoints(mission, 0))
    first = client.get(f"/api/v1/missions/{mission.pk}/coverage?limit=1").json()
    rest = client.get(first["next"]).json()
    assert [own["target"] for own in [*first["results"], *rest["results"]]] == [0, 1]
    assert rest["next"] is None
    answer = client.get(f"/api/v1/missions/{mission.pk}/coverage.csv")
    rows = list(csv.DictReader(io.StringIO(b"".join(answer.streaming_content).decode())))
    assert {(row["target"], row["proof"]) for row in rows} == {(at, proof) for at in "01" for proof in ("promised", "achieved")}
    body_row = next(row for row in rows if (row["target"], row["proof"], row["component"]) == ("0", "achieved", "body"))
    of_body = first["results"][0]["achieved"]["coverage"]["components"][0]
    assert (float(body_row["shown"]), float(body_row["gsd_mm"])) == (round(of_body["shown"], 4), round(of_body["gsd_mm"], 4))


def test_a_mission_that_photographs_nothing_has_no_coverage(here: World, client: Client) -> None:
    mission = planned(client, {"asset": here.towers[2].pk})
    assert coverage(client, mission) == []
    assert client.get(f"/api/v1/missions/{mission.pk}/coverage.csv").status_code == 409
    stranger = client_of(a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Elsewhere")))
    assert stranger.get(f"/api/v1/missions/{mission.pk}/coverage").status_code == 404
    assert stranger.get(f"/api/v1/missions/{mission.pk}/coverage.csv").status_code == 404


@pytest.mark.long
def test_a_tower_that_is_gone_proves_nothing(here: World, client: Client) -> None:
    mission = planned(client, photographed(here.towers[2]))
    mission.targets.update(asset=None)
    (found,) = coverage(client, mission)
    assert (found["promised"], found["achieved"], found["rehearsed"]) == (None, None, [])
