"""Photos are placed at the target that they were stated for, or that is clearly the nearest; all others stay unplaced."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import Point
from django.test import Client

from missions.models import InspectionTarget, Mission, MissionUav, Route, Waypoint
from results.matching.photos import CapturePlace, TargetPlace, capture_of_photo, place_photo
from results.models import Placement
from results.services.reading import read_waiting
from telemetry.models import Capture
from telemetry.services import forget_old_telemetry
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.missions.commands.outbox import a_uav
from tests.results.photos import dji_photo, exif_of, file_of, picture
from tests.results.sending import begin, upload_and_read
from workspace.models import AuditEntry

pytestmark = pytest.mark.django_db
AT = datetime(2026, 6, 1, 8, tzinfo=UTC)  # of dji_photo's clock


def point(key: int, east_m: float, visit_s: tuple[float, float] | None = None) -> TargetPlace:
    return TargetPlace(key, ((east_m, 0.0),), visit_s)


@pytest.mark.parametrize(
    ("targets", "taken_s", "chosen", "candidates"),
    [
        ([point(1, 20.0), point(2, 250.0)], None, 1, [1]),
        ([point(1, 20.0), point(2, 45.0)], None, 1, [1, 2]),
        ([point(1, 20.0), point(2, 35.0)], None, None, [1, 2]),  # less than twice as far
        ([point(1, 4.0), point(2, 12.0)], None, None, [1, 2]),  # within what positions are good for
        ([point(1, 121.0)], None, None, []),
        ([point(1, 60.0), point(2, 70.0), point(3, 80.0)], None, None, [1, 2]),
        ([point(1, 40.0, (0.0, 10.0)), point(2, 30.0, (500.0, 510.0))], 5.0, 1, [1]),  # the other was visited at another time
        ([point(1, 40.0, (0.0, 10.0)), point(2, 30.0)], 5.0, None, [1, 2]),
        ([point(1, 40.0, (0.0, 10.0)), point(2, 65.0)], 5.0, 1, [1, 2]),
        ([point(1, 40.0, (0.0, 10.0))], 3_600.0, None, []),  # a clock that is an hour off places nothing
        ([TargetPlace(1, ((-500.0, 30.0), (500.0, 30.0))), point(2, 100.0)], None, 1, [1, 2]),  # a stretch is as near as its nearest point
        ([], None, None, []),
    ],
)
def test_only_a_clear_target_is_chosen(
    targets: list[TargetPlace], taken_s: float | None, chosen: int | None, candidates: list[int]
) -> None:
    placing = place_photo(taken_s, targets)
    assert (placing.chosen, [one.key for one in placing.candidates]) == (chosen, candidates)


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def mission_of(*lons: float, **facts: Any) -> Mission:
    mission = Mission.objects.create(name="Bexley")
    for sequence, lon in enumerate(lons):
        tower = ground.tower((lon, 56.0))
        InspectionTarget.objects.create(mission=mission, sequence=sequence, asset=tower, label=f"T{sequence}", **facts)
    return mission


def test_a_photo_of_a_mission_is_placed_at_the_nearest_target(client: Client) -> None:
    mission = mission_of(10.000, 10.004, 10.008)
    medium = upload_and_read(client, dji_photo(10.0043, 56.0), mission=str(mission.pk))
    second = mission.targets.get(sequence=1)
    assert (medium.placement, medium.target, medium.asset) == (Placement.NEAREST, second, second.asset)
    [best] = medium.candidates
    assert (best["target"], best["distance_m"], best["is_in_visit"]) == (second.pk, pytest.approx(18.7, abs=0.1), None)


def reported(mission: Mission, lon: float, seconds: float, waypoint: int | None, **facts: Any) -> Capture:
    """A photo that the mission's UAV reported, at some seconds after AT."""
    uav = mission.mission_uavs.get().uav
    return Capture.objects.create(
        uav=uav, mission=mission, waypoint_sequence=waypoint, taken_at=AT + timedelta(seconds=seconds), time_source="utc",
        received_at=AT, position=Point(lon, 56.0, srid=4326), **facts,
    )  # fmt: skip


def flown_mission() -> Mission:
    """Two towers 62 m apart, between which positions do not decide, and a route with a waypoint at each."""
    mission = mission_of(10.000, 10.001)
    start = Point(10.0, 56.0, srid=4326)
    flies = MissionUav.objects.create(mission=mission, uav=a_uav("Tern"), sequence=0, start=start, cruise_speed_mps=12.0)
    route = Route.objects.create(mission=mission, mission_uav=flies, graph_version=1, length_m=1.0, duration_s=1.0)
    for sequence, target in enumerate(mission.targets.order_by("sequence"), start=1):
        Waypoint.objects.create(
            route=route, sequence=sequence, kind="target", position=start, target=target, altitude_agl_m=30.0, altitude_relative_m=30.0
        )
    return mission


def test_the_uavs_report_of_the_photo_names_its_waypoint(client: Client) -> None:
    mission = flown_mission()
    reported(mission, 10.0005, -30.0, 1)
    capture = reported(mission, 10.0005, 0.4, 2)
    medium = upload_and_read(client, dji_photo(10.0005), mission=str(mission.pk))
    assert (medium.placement, medium.target, medium.capture) == (Placement.CAPTURED, mission.targets.get(sequence=1), capture)
    assert medium.uav == capture.uav
    assert client.get(f"/api/v1/media/{medium.pk}").json()["capture"] == capture.pk


def test_a_report_is_forgotten_with_the_telemetry_and_the_photo_stays(client: Client, settings: Any) -> None:
    mission = flown_mission()
    reported(mission, 10.0005, 0.4, 2)
    medium = upload_and_read(client, dji_photo(10.0005), mission=str(mission.pk))
    settings.TELEMETRY_DAYS = 1
    Capture.objects.update(received_at=AT - timedelta(days=400), taken_at=AT - timedelta(days=400))
    forget_old_telemetry()
    assert Capture.objects.count() == 0
    found = client.get(f"/api/v1/media/{medium.pk}").json()
    assert (found["placement"], found["target"]) == ("captured", mission.targets.get(sequence=1).pk)


def test_the_uavs_report_names_the_mission_of_a_photo_that_states_none(client: Client) -> None:
    mission = flown_mission()
    reported(mission, 10.0005, 0.0, 1)
    medium = upload_and_read(client, dji_photo(10.0005))
    assert (medium.mission, medium.target) == (mission, mission.targets.get(sequence=0))


@pytest.mark.parametrize(
    ("lon", "seconds", "facts"),
    [(10.0005, 10.0, {}), (10.01, 0.0, {}), (10.0005, 0.0, {"is_taken": False})],
    ids=["another time", "another place", "the camera failed"],
)
def test_a_report_of_elsewhere_or_of_another_time_says_nothing(client: Client, lon: float, seconds: float, facts: dict[str, Any]) -> None:
    mission = flown_mission()
    reported(mission, lon, seconds, 1, **facts)
    medium = upload_and_read(client, dji_photo(10.0005), mission=str(mission.pk))
    assert (medium.placement, medium.capture, len(medium.candidates)) == (Placement.UNPLACED, None, 2)


@pytest.mark.parametrize(
    ("captures", "chosen"),
    [
        ([(1, "a", 0.0), (2, "b", 2.0)], 1),
        ([(1, "a", 0.3), (2, "b", -0.5)], None),  # two waypoints about as near in time
        ([(1, "a", 0.3), (2, "a", -0.5)], 1),  # of one waypoint either will do
        ([(1, "a", 3.5)], None),
        ([], None),
    ],
)
def test_only_a_clear_report_is_chosen(captures: list[tuple[int, str, float]], chosen: int | None) -> None:
    places = [CapturePlace(key, group, taken_s, 3.0, 4.0) for key, group, taken_s in captures]
    assert capture_of_photo(0.0, places) == chosen


def test_the_bounds_of_a_report_widen_what_is_near() -> None:
    wide = CapturePlace(1, "a", 8.0, 60.0, 0.0, time_bound_s=6.0, position_bound_m=40.0)
    assert capture_of_photo(0.0, [wide]) == 1
    assert capture_of_photo(0.0, [replace(wide, position_bound_m=30.0)]) is None
    assert capture_of_photo(0.0, [replace(wide, time_bound_s=4.0)]) is None


def test_between_two_targets_it_stays_unplaced_with_both(client: Client) -> None:
    mission = mission_of(10.000, 10.002)
    medium = upload_and_read(client, dji_photo(10.0011, 56.0), mission=str(mission.pk))
    assert (medium.placement, medium.target) == (Placement.UNPLACED, None)
    assert [one["label"] for one in medium.candidates] == ["T1", "T0"]


def test_the_time_of_the_visit_counts(client: Client) -> None:
    mission = mission_of(10.000, 10.001)
    mission.targets.filter(sequence=0).update(reached_at=AT, held_s=20.0)
    mission.targets.filter(sequence=1).update(reached_at=AT + timedelta(minutes=5))
    medium = upload_and_read(client, dji_photo(10.0006, 56.0), mission=str(mission.pk))
    assert medium.target == mission.targets.get(sequence=0)


def test_without_a_position_or_a_mission_it_stays_unplaced(client: Client) -> None:
    mission = mission_of(10.004)
    for content, stated in ((file_of(picture(), exif=exif_of()), {"mission": str(mission.pk)}), (dji_photo(), {})):
        medium = upload_and_read(client, content, **stated)
        assert (medium.placement, medium.candidates) == (Placement.UNPLACED, [])


def test_a_photo_without_a_mission_is_placed_when_it_is_sent_for_one(client: Client) -> None:
    mission, other = mission_of(10.000, 10.004), mission_of(10.004)
    content = dji_photo(10.0043, 56.0)
    medium = upload_and_read(client, content)
    assert begin(client, content, mission=str(mission.pk)).json()["is_known"]
    read_waiting(budget_s=60.0)
    medium.refresh_from_db()
    assert (medium.mission, medium.target, medium.placement) == (mission, mission.targets.get(sequence=1), Placement.NEAREST)
    begin(client, content, mission=str(other.pk))  # it belongs to a mission already
    medium.refresh_from_db()
    assert medium.mission == mission


def test_what_was_stated_counts_more_than_what_is_near(client: Client) -> None:
    mission = mission_of(10.000, 10.004)
    stated = mission.targets.get(sequence=0)
    by_target = upload_and_read(client, dji_photo(10.004), target=stated.pk)
    assert (by_target.placement, by_target.target, by_target.asset, by_target.mission) == ("stated", stated, stated.asset, mission)
    by_asset = upload_and_read(client, dji_photo(10.0041), mission=str(mission.pk), asset=stated.asset_id)
    assert (by_asset.placement, by_asset.target) == ("stated", stated)


def test_a_user_places_and_unplaces_by_hand(client: Client) -> None:
    mission, other = mission_of(10.000, 10.002), mission_of(10.1)
    medium = upload_and_read(client, dji_photo(10.0011), mission=str(mission.pk))
    target = mission.targets.get(sequence=1)

    def change(**values: Any) -> Any:
        return client.patch(f"/api/v1/media/{medium.pk}", values, content_type="application/json")

    placed = change(target=target.pk).json()
    assert (placed["placement"], placed["target"], placed["asset"], placed["target_label"]) == ("manual", target.pk, target.asset_id, "T1")
    entry = AuditEntry.objects.get(subject_type="medium")
    assert (entry.before["placement"], entry.after["target"]) == ("unplaced", target.pk)
    assert change(mission=str(mission.pk), target=other.targets.get().pk).status_code == 400
    assert change(target=None, asset=None).json()["placement"] == "unplaced"
    assert change(asset=target.asset_id).json()["asset"] == target.asset_id
