"""Checks before start: what is ready, what blocks, and which act comes next."""

from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from django.utils import timezone

from missions.models import CommandKind, LinkKind, Mission, MissionState, PlannedStarts, Uav
from missions.selectors.missions import mission_of_organisation
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.outbox import note_failed
from missions.services.commands.refused import Refused
from missions.services.commands.rtl_check import note_rtl_behaviour
from missions.services.commands.steering import command_uav
from telemetry.models import AlertLevel, UavLink
from telemetry.services.alerts.alerts import open_alert
from telemetry.services.alerts.down_alerts import close_down_alert
from telemetry.services.preflight import CheckState, NextAct, Preflight, preflight_of
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.commands.outbox import claim, fence
from tests.missions.flights import an_operator, approved, carry, fleet
from tests.missions.photo_missions import CAMERA, body, made, tern, terrain
from tests.missions.worlds import world, zone_around
from tests.telemetry.records import received
from workspace.models import AuditEntry, Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def two(person: User) -> tuple[Mission, Uav, Uav]:
    """An approved mission of two UAVs, sent to none yet."""
    uavs = fleet("Tern", "Kite")
    mission, _approval = approved(person, uavs, world().towers[4:6])
    return mission, *uavs


def checks(mission: Mission) -> Preflight:
    return preflight_of(mission_of_organisation(mission.organisation, mission.pk), now=timezone.now())


def begins(person: User, mission: Mission, *uavs: Uav) -> Any:
    return post(client_of(person), f"missions/{mission.pk}/planned-starts", {"uavs": [uav.pk for uav in uavs]})


def states(found: Preflight, uav: Uav) -> dict[str, CheckState]:
    row = next(row for row in found.uavs if row.uav == uav.pk)
    return {check.code: check.state for check in row.checks}


def test_acts_follow_each_other_until_nothing_is_left_to_start(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, *uavs = two
    assert checks(mission).next_act == NextAct.CONNECT
    received(*uavs)
    assert checks(mission).next_act == NextAct.UPLOAD
    dispatch_mission(mission=mission, actor=person)
    assert checks(mission).next_act == NextAct.WAIT
    carry(*uavs)
    found = checks(mission)
    assert found.next_act == NextAct.START
    assert not any(row.blocks for row in found.uavs)
    assert [check.code for check in found.checks] == ["ground"]
    for uav in uavs:
        command_uav(uav=uav, kind=CommandKind.START, actor=person, parameters={"out_of_slot": True})
    carry(*uavs)
    assert checks(mission) == Preflight(None, (), ())


def test_one_that_nobody_hears_holds_up_no_others_upload(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, tern, kite = two
    received(tern)
    assert checks(mission).next_act == NextAct.UPLOAD
    dispatch_mission(mission=mission, actor=person)
    carry(tern)
    found = checks(mission)
    assert states(found, kite)["link"] == CheckState.FAILED
    assert states(found, tern)["mission"] == CheckState.OK


def test_one_that_is_not_connected_holds_up_no_others_start(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, tern, kite = two
    received(tern)
    dispatch_mission(mission=mission, actor=person)
    carry(tern)
    found = checks(mission)
    assert found.next_act == NextAct.START
    assert {row.uav: row.is_ready for row in found.uavs} == {tern.pk: True, kite.pk: False}
    answer = begins(person, mission, tern)
    assert answer.status_code == 201, answer.content
    assert [start["uav"] for start in answer.json()["uavs"]] == [tern.pk]
    left = checks(mission)
    assert [row.uav for row in left.uavs] == [kite.pk], "what is being started is not offered again"
    assert left.next_act == NextAct.CONNECT


def test_the_service_checks_again_those_that_it_is_to_start(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, tern, kite = two
    received(tern, kite)
    dispatch_mission(mission=mission, actor=person)
    carry(tern, kite)
    received(kite, gps_fix=1, stream="boot-2")  # since the page was read
    answer = begins(person, mission, tern, kite)
    assert answer.status_code == 409, answer.content
    assert "Kite: It has no position yet." in answer.content.decode()
    assert begins(person, mission, tern).status_code == 201


def test_a_uav_of_another_mission_is_not_started_with_these(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, tern, kite = two
    received(tern, kite)
    dispatch_mission(mission=mission, actor=person)
    carry(tern, kite)
    [other] = fleet("Crow")
    answer = begins(person, mission, tern, other)
    assert (answer.status_code, PlannedStarts.objects.count()) == (409, 0)


def test_a_simulated_uav_is_not_to_be_switched_on(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    Uav.objects.filter(pk=tern.pk).update(is_simulated=True)
    Uav.objects.filter(pk=kite.pk).update(is_simulated=False)
    simulated, real = [row.checks[0].message for row in checks(mission).uavs]
    assert simulated == "Not connected. It connects by itself once its simulation runs."
    assert real == "Never connected. Switch it on, and check its connection."


def test_a_uav_that_was_heard_long_ago_is_not_connected(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    received(tern, kite)
    assert states(preflight_of(mission, now=timezone.now() + timedelta(minutes=5)), tern)["link"] == CheckState.FAILED


def test_a_uav_in_another_place_without_a_fix_or_with_too_little_battery_is_not_started(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    received(tern, longitude_deg=10.1)
    received(kite, gps_fix=1)
    assert states(checks(mission), tern)["position"] == CheckState.FAILED
    assert states(checks(mission), kite)["position"] == CheckState.FAILED


def test_a_battery_that_would_land_below_its_reserve_blocks(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    mission.routes.update(battery_percent=60.0)
    received(tern, battery_percent=59.0)
    received(kite, battery_percent=61.0)
    assert states(checks(mission), tern)["battery"] == CheckState.FAILED
    assert states(checks(mission), kite)["battery"] == CheckState.OK


def test_what_is_not_told_is_unknown_and_no_state(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, _kite = two
    UavLink.objects.create(uav=tern, last_message_at=timezone.now())
    found = states(checks(mission), tern)
    assert (found["battery"], found["position"], found["mission"]) == (CheckState.UNKNOWN,) * 3
    assert (found["home"], found["wind"]) == (CheckState.UNKNOWN,) * 2
    assert "fence" not in found, "the plan has none"


def test_a_home_position_away_from_the_planned_take_off_is_warned_of(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    received(tern, kite)
    start = tern.mission_uavs.get().start
    UavLink.objects.filter(uav=tern).update(home=start)
    UavLink.objects.filter(uav=kite).update(home=start)  # which takes off 250 m from there
    found = checks(mission)
    assert states(found, tern)["home"] == CheckState.OK
    assert states(found, kite)["home"] == CheckState.WARNING
    assert "Return leads there" in str(found.uavs)


@pytest.mark.parametrize(
    ("autopilot", "parameters", "state", "words"),
    [
        ("ardupilot", {"FENCE_ENABLE": 1.0}, CheckState.OK, "Fence active: FENCE_ENABLE 1"),
        ("ardupilot", {"FENCE_ENABLE": 0.0, "FENCE_AUTOENABLE": 1.0}, CheckState.OK, "Fence active: FENCE_AUTOENABLE 1"),
        ("ardupilot", {"FENCE_ENABLE": 0.0}, CheckState.WARNING, "its autopilot has FENCE_ENABLE 0."),
        ("ardupilot", {"RTL_ALT": 3_000.0}, CheckState.UNKNOWN, "not reported by the autopilot"),
        ("px4", {"GF_ACTION": 3.0}, CheckState.OK, "Fence active: GF_ACTION 3"),
        ("px4", {"GF_ACTION": 1.0}, CheckState.WARNING, "its autopilot has GF_ACTION 1."),
        ("px4", {"RTL_RETURN_ALT": 60.0}, CheckState.UNKNOWN, "not reported by the autopilot"),
    ],
)
def test_the_fence_is_active_off_or_not_known(
    autopilot: str, parameters: dict[str, float], state: CheckState, words: str, person: User
) -> None:
    [tern] = fleet("Tern")
    towers = world().towers
    zone_around((10.010, 56.02), 0.001)
    mission, _approval = approved(person, [tern], [towers[0], towers[5]])
    note_rtl_behaviour(uav_id=tern.pk, autopilot=autopilot, parameters=parameters)
    received(tern)
    [fence_check] = [check for check in checks(mission).uavs[0].checks if check.code == "fence"]
    assert fence_check.state == state
    assert words in fence_check.message
    parameter = "FENCE_ENABLE" if autopilot == "ardupilot" else "GF_ACTION"
    assert fence_check.detail == (parameter if state == CheckState.UNKNOWN else "")


def test_wind_is_compared_where_it_is_reported(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    received(tern, wind_east_mps=9.0, wind_north_mps=0.0)
    received(kite)
    found = checks(mission)
    assert (states(found, tern)["wind"], states(found, kite)["wind"]) == (CheckState.WARNING, CheckState.UNKNOWN)


def test_an_upload_that_failed_and_one_in_doubt_are_told(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, tern, kite = two
    received(tern, kite)
    dispatch_mission(mission=mission, actor=person)
    [command] = claim(tern)
    assert note_failed(command.pk, "mission-refused", "Item 3 is refused.", **fence(command))
    carry(kite)
    UavLink.objects.filter(uav=kite).update(loaded_doubt="rebooted")
    found = checks(mission)
    assert found.next_act == NextAct.START, "the other one is ready"
    assert states(found, tern)["mission"] == CheckState.FAILED
    assert "Item 3 is refused." in str(found.uavs)
    assert states(found, kite)["mission"] == CheckState.WARNING


def test_a_zone_that_came_since_blocks(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern, kite = two
    received(tern, kite)
    zone_around((10.018, 56.0), 0.001)
    found = checks(mission)
    against = [*found.checks, *(check for row in found.uavs for check in row.checks)]
    assert any(check.code == "zone" and check.state == CheckState.FAILED for check in against)


def test_of_a_mission_that_is_not_approved_nothing_is_checked(two: tuple[Mission, Uav, Uav]) -> None:
    mission, _tern, _kite = two
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.COMPLETED)
    assert checks(mission) == Preflight(None, (), ())


def test_viewers_read_it_and_nobody_of_another_organisation_does(two: tuple[Mission, Uav, Uav]) -> None:
    mission, _tern, _kite = two
    answer = client_of(a_user(role=Role.VIEWER)).get(f"/api/v1/missions/{mission.pk}/preflight")
    assert answer.status_code == 200
    assert answer.json()["next_act"] == "connect"
    assert answer.json()["uavs"][0]["checks"][0]["code"] == "link"
    stranger = a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Elsewhere"))
    assert client_of(stranger).get(f"/api/v1/missions/{mission.pk}/preflight").status_code == 404


def test_a_uav_that_is_down_off_its_plan_is_not_started_until_a_person_has_said_what_became_of_it(
    two: tuple[Mission, Uav, Uav], person: User
) -> None:
    mission, tern, kite = two
    received(tern, kite)
    dispatch_mission(mission=mission, actor=person)
    carry(tern, kite)
    alert = open_alert(uav=tern, level=AlertLevel.CRITICAL, code="down-off-plan", message="down")
    found = checks(mission)
    assert states(found, tern)["crash"] == CheckState.FAILED
    assert "crash" not in states(found, kite)
    for kind in (CommandKind.ARM, CommandKind.START, CommandKind.TAKE_OFF):
        parameters = {"altitude_relative_m": 10.0} if kind == CommandKind.TAKE_OFF else {}
        with pytest.raises(Refused) as refused:
            command_uav(uav=tern, kind=kind, actor=person, parameters=parameters)
        assert [reason.code for reason in refused.value.reasons] == ["is_down"]
    close_down_alert(alert=alert, actor=person, reason="Brought back")
    assert "crash" not in states(checks(mission), tern)
    assert command_uav(uav=tern, kind=CommandKind.START, actor=person).kind == CommandKind.START


def test_polls_of_one_period_check_the_map_once(two: tuple[Mission, Uav, Uav], django_assert_max_num_queries: Any) -> None:
    mission, tern, kite = two
    received(tern, kite)
    checks(mission)
    loaded = mission_of_organisation(mission.organisation, mission.pk)
    # Approval, starts under way, routes with UAVs, crashes, ground, cameras of photos, and an upload of each UAV.
    with django_assert_max_num_queries(9):
        preflight_of(loaded, now=timezone.now())


def test_the_pilots_own_check_is_kept_with_the_starts(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, *uavs = two
    received(*uavs)
    dispatch_mission(mission=mission, actor=person)
    carry(*uavs)
    answer = post(client_of(person), f"missions/{mission.pk}/planned-starts", {"pilot_checked": True})
    assert answer.status_code == 201, answer.content
    assert AuditEntry.objects.get(action="begin-starts").after["pilot_checked"] is True


def test_a_uav_that_lacks_its_type_does_not_start_and_says_what_is_missing(two: tuple[Mission, Uav, Uav], person: User) -> None:
    mission, tern, kite = two
    received(tern, kite)
    dispatch_mission(mission=mission, actor=person)
    carry(tern, kite)
    assert "incomplete" not in states(checks(mission), tern)
    Uav.objects.filter(pk=tern.pk).update(uav_type=None)
    found = checks(mission)
    assert states(found, tern)["incomplete"] == CheckState.FAILED
    assert "incomplete" not in states(found, kite)
    assert {row.uav: row.blocks for row in found.uavs} == {tern.pk: True, kite.pk: False}
    answer = begins(person, mission, tern)
    assert answer.status_code == 409
    assert "Tern is incomplete: it has no type. Choose one on its page." in answer.content.decode()


@pytest.fixture
def photos(person: User, tmp_path: Path) -> tuple[Mission, Uav]:
    """An approved mission with an overview of a tower."""
    towers = world(height_m=30.0).towers
    terrain(tmp_path)
    uav = tern()
    views = {"gsd_mm": 50, "camera_key": "dji-m30t-zoom", "pattern": "overview"}
    asked = body({"asset": towers[2].pk, "task": {"kind": "photo", "views": views}}, uav=uav)
    mission = mission_of_organisation(person.organisation, made(client_of(person), asked)["id"])
    approve_mission(mission=mission, actor=person)
    return mission, uav


REPORTED = {
    "component": 100, "name": "DJI M30T", "focal_length_mm": CAMERA.focal_lengths_mm[-1], "sensor_width_mm": CAMERA.sensor_width_mm,
    "sensor_height_mm": CAMERA.sensor_height_mm, "pixels_wide": CAMERA.pixels_wide, "pixels_high": CAMERA.pixels_high,
}  # fmt: skip
WITHOUT_FIGURES = REPORTED | dict.fromkeys(("focal_length_mm", "sensor_width_mm", "sensor_height_mm", "pixels_wide", "pixels_high"))


def test_the_camera_of_photos_is_as_planned_another_or_not_reported(photos: tuple[Mission, Uav]) -> None:
    mission, uav = photos
    other = REPORTED | {"pixels_wide": 640, "pixels_high": 512}
    Uav.objects.filter(pk=uav.pk).update(link=LinkKind.MAVLINK)
    link = UavLink.objects.create(uav=uav)
    cases = {
        CheckState.UNKNOWN: [[], [WITHOUT_FIGURES], [WITHOUT_FIGURES | {"focal_length_mm": CAMERA.focal_lengths_mm[0]}]],
        CheckState.OK: [[REPORTED], [other, REPORTED]],
        CheckState.WARNING: [[other], [other, WITHOUT_FIGURES | {"focal_length_mm": CAMERA.focal_lengths_mm[0]}]],
    }
    for state, reports in cases.items():
        for cameras in reports:
            link.cameras = cameras
            link.save()
            assert states(checks(mission), uav)["camera"] == state, cameras
    (row,) = checks(mission).uavs
    words = next(check.message for check in row.checks if check.code == "camera")
    assert f"640 × 512 pixels instead of {CAMERA.pixels_wide} × {CAMERA.pixels_high}" in words and CAMERA.name in words
    assert not row.blocks or "camera" not in [check.code for check in row.checks if check.state == CheckState.FAILED]


def test_without_photos_no_camera_is_checked(two: tuple[Mission, Uav, Uav]) -> None:
    mission, tern_, _kite = two
    UavLink.objects.create(uav=tern_, cameras=[REPORTED])
    assert "camera" not in states(checks(mission), tern_)
