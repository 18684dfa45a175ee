"""Each photo is stored once, whatever messages tell of it, in whatever order and however often they come."""

import random
from dataclasses import replace
from datetime import timedelta
from typing import Any

import pytest
from django.utils import timezone

from inspection.geodesy import LonLat
from mavlink.autopilot_type import AutopilotType
from mavlink.decoding.boots import VehicleTime
from mavlink.decoding.captures import CaptureDecoder
from missions.models import LinkKind, Mission, Uav
from telemetry.models import Capture, CaptureReport, TelemetryStream
from telemetry.services import forget_old_telemetry
from telemetry.services.captures import CaptureCount, NewCapture, store_captures
from telemetry.services.waypoints import LoadedList, PhotoItem
from tests.mavlink.decoding.photos import LON_E7, NOW_S, captured, feedback, synchronised, trigger
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import at

pytestmark = pytest.mark.django_db
START_S = at(0).timestamp()


@pytest.fixture
def uav() -> Uav:
    return a_uav("Tern")


def new(uav: Uav, message: Any, taken_s: float, *, received_s: float | None = None, stream: str = "boot-1", **more: Any) -> NewCapture:
    """What a gateway makes of a message; the photo was taken so many seconds after the start."""
    report = CaptureDecoder().receive(message, VehicleTime(), AutopilotType.ARDUPILOT, NOW_S)
    assert report is not None
    report = replace(report, taken_s=START_S + taken_s)
    return NewCapture(uav.pk, LinkKind.MAVLINK, stream, at(taken_s if received_s is None else received_s), report, **more)


def photo(uav: Uav, number: int, *, jitter_s: float = 0.0, **more: Any) -> list[NewCapture]:
    """The messages of one photo, one each 2.5 s: of the autopilot and of the camera, a little apart."""
    taken_s, lon_e7 = 2.5 * number, LON_E7 + 1_000 * number
    by_autopilot = new(uav, feedback(number + 1, time_us=(START_S + taken_s) * 1e6, lon_e7=lon_e7), taken_s, **more)
    return [by_autopilot, new(uav, captured(number, boot_s=number, lon_e7=lon_e7), taken_s + jitter_s, **more)]


def rows(uav: Uav) -> list[tuple[Any, ...]]:
    names = ("taken_at", "image_index", "camera", "position", "altitude_amsl_m", "yaw_deg", "attitude_source", "position_bound_m")
    return list(Capture.objects.filter(uav=uav).order_by("taken_at", "pk").values_list(*names))


def test_messages_of_two_kinds_about_one_photo_are_one_row(uav):
    assert store_captures(photo(uav, 3, jitter_s=0.6)) == CaptureCount(photos=1, joined=1)
    row = Capture.objects.get()
    assert (row.image_index, row.camera, row.attitude_source, row.yaw_frame) == (3, 100, "camera", "earth")
    assert (row.yaw_deg, row.pitch_deg) == (pytest.approx(200.0, abs=1e-3), pytest.approx(-30.0, abs=1e-3))
    assert (row.position.x, row.position_source, row.altitude_relative_m) == (pytest.approx(10.0003), "photo", 30.0)
    assert set(row.reports.values_list("source", flat=True)) == {"camera-feedback", "camera-image-captured"}


def test_messages_that_come_again_add_nothing(uav):
    batch = photo(uav, 1)
    store_captures(batch)
    later = [replace(one, received_at=one.received_at + timedelta(minutes=5)) for one in batch]
    assert store_captures([*later, *batch]) == CaptureCount(known=4)
    again = CaptureDecoder().receive(captured(1, boot_s=99.0, lon_e7=LON_E7 + 1_000), synchronised(), AutopilotType.ARDUPILOT, NOW_S)
    assert store_captures([NewCapture(uav.pk, LinkKind.MAVLINK, "boot-1", at(90), again)]) == CaptureCount(known=1)
    assert CaptureReport.objects.count() == 2


def test_a_log_of_the_flight_that_is_read_again_adds_nothing(uav):
    batch = photo(uav, 1)
    store_captures(batch)
    assert store_captures([replace(one, stream="boot-of-the-log") for one in batch]).known == 2
    assert Capture.objects.count() == 1


@pytest.mark.long
@pytest.mark.parametrize("seed", range(8))
def test_order_and_repetition_change_nothing(uav, seed):
    """30 photos, some with three messages and some with one; delivered in two orders, in batches, parts of them again."""
    chance = random.Random(seed)
    messages = []
    for number in range(30):
        both = photo(uav, number, jitter_s=chance.uniform(-0.45, 0.45))
        if chance.random() < 0.3:
            both.append(new(uav, trigger(number, time_us=(START_S + number) * 1e6), 2.5 * number + chance.uniform(-0.3, 0.3)))
        messages += chance.sample(both, chance.randint(1, len(both)))
    other = a_uav("Gull")

    def deliver(to: Uav, order: list[NewCapture]) -> list[tuple[Any, ...]]:
        place = 0
        while place < len(order):
            size = chance.randint(1, 9)
            store_captures([replace(one, uav_id=to.pk) for one in order[place : place + size]])
            place += size
        return rows(to)

    in_order = deliver(uav, messages)
    shuffled = deliver(other, chance.sample(messages, len(messages)) + chance.sample(messages, 20))
    assert shuffled == in_order
    assert len(in_order) == 30
    assert CaptureReport.objects.filter(capture__uav=other).count() == len(messages)


def test_indices_that_begin_anew_after_a_restart_are_other_photos(uav):
    first = new(uav, captured(0, boot_s=5.0), 0.0, stream="boot-1")
    second = new(uav, captured(0, boot_s=5.0), 60.0, stream="boot-2")
    third = new(uav, captured(0, boot_s=5.0, lon_e7=LON_E7 + 5), 90.0, stream="boot-2")  # the camera alone began anew
    assert store_captures([first, second, third]).photos == 3


def test_two_cameras_that_take_a_photo_at_once_take_two(uav):
    store_captures([new(uav, captured(4), 1.0), new(uav, captured(4, component=101), 1.1), new(uav, feedback(5), 1.05)])
    assert sorted(Capture.objects.values_list("camera", flat=True)) == [100, 101]
    assert CaptureReport.objects.count() == 3


def test_photo_that_the_camera_could_not_take_is_kept_as_such(uav):
    store_captures([new(uav, feedback(1), 1.0), new(uav, captured(0, result=0), 1.1)])
    assert Capture.objects.get().is_taken is False


def test_photos_belong_to_the_mission_that_the_uav_flies_and_unknown_uavs_have_none(uav):
    mission = Mission.objects.create(name="Bexley", organisation=uav.organisation)
    assert store_captures([replace(new(uav, captured(0), 0.0), mission_id=mission.pk), *photo(Uav(pk=10**6), 1)]) == CaptureCount(1, 0, 2)
    assert Capture.objects.get().mission == mission
    mission.delete()
    assert Capture.objects.get().mission is None


@pytest.mark.parametrize(("autopilot", "first"), [("px4", 0), ("ardupilot", 1)])
def test_photo_belongs_to_the_waypoint_that_it_was_taken_at_wherever_the_list_is_by_then(autopilot, first):
    """Two waypoints 40 m apart with a photo each: MISSION_CURRENT comes before, with, or after the photo."""
    loaded = LoadedList(
        Mission().pk, at(0), first, (0, 5, 5, 6, 6, 7), 2,
        (PhotoItem(2, 5, LonLat(10.0, 55.0), 20.0), PhotoItem(4, 6, LonLat(10.0, 55.0), 60.0)),
    )  # fmt: skip
    for item in range(1, 6):
        assert loaded.waypoint_of_photo(item + first, LonLat(10.00001, 55.0), 21.0) == 5
        assert loaded.waypoint_of_photo(item + first, LonLat(10.00001, 55.0), 58.0) == 6
    assert loaded.waypoint_of_photo(3 + first, None, None) == 6
    far = replace(loaded, waypoints=(*loaded.waypoints, *[9] * 20))
    assert far.waypoint_of_photo(24 + first, LonLat(10.0, 55.0), 20.0) == 9
    assert far.waypoint_of_photo(24 + first, LonLat(10.0, 55.0), 20.0, is_late=True) == 5, "asked for again"
    assert loaded.waypoint_of_photo(None, LonLat(10.0, 55.0), 20.0) is None
    assert replace(loaded, photos=()).waypoint_of_photo(1 + first, LonLat(10.0, 55.0), 60.0) == 5


def test_photos_are_kept_as_long_as_other_telemetry(uav, settings):
    settings.TELEMETRY_DAYS = 30
    store_captures([*photo(uav, 1), *photo(uav, 5)])
    now = timezone.now()
    old = Capture.objects.order_by("taken_at").first()
    Capture.objects.update(received_at=now)
    Capture.objects.filter(pk=old.pk).update(received_at=now - timedelta(days=31))
    TelemetryStream.objects.update(started_at=now - timedelta(days=31))
    forget_old_telemetry()
    assert Capture.objects.count() == 1 and CaptureReport.objects.count() == 2
    assert TelemetryStream.objects.exists(), "its reports name it"
