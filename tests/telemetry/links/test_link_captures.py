"""Photos that a companion computer reports: stored once, faults named, and one with what the autopilot told of them."""

from datetime import timedelta
from typing import Any

import pytest
from django.utils import timezone

from missions.models import Mission
from telemetry.models import Capture, CaptureReport
from telemetry.services.captures import store_captures
from tests.mavlink.decoding.photos import feedback
from tests.telemetry.links.uav_clients import UavClient, linked_uav, seconds_ago
from tests.telemetry.records import START
from tests.telemetry.test_captures import new

pytestmark = pytest.mark.django_db


@pytest.fixture
def kite() -> UavClient:
    return linked_uav()


def photo(sequence: int = 1, **values: Any) -> dict[str, Any]:
    return {"sequence": sequence, "taken_at": seconds_ago(5), "position": [10.001, 55.995]} | values


def send(kite: UavClient, *photos: Any, stream: str = "photos-1") -> dict[str, Any]:
    answer = kite.post("captures", {"stream": stream, "captures": list(photos)})
    assert answer.status_code == 200, answer.content
    return dict(answer.json())


def test_every_value_is_stored_as_it_was_sent(kite):
    told = {
        "altitude_amsl_m": 130.5, "altitude_relative_m": 30.5, "altitude_agl_m": 29.0, "roll_deg": 0.5, "pitch_deg": -45.0,
        "position_bound_m": 0.05, "image_index": 7, "camera": 100, "file_url": "DJI_0007.JPG", "is_taken": True,
    }  # fmt: skip
    sent = photo(yaw_deg=-90.0, waypoint_sequence=4, **told)
    assert send(kite, sent) == {"stored": 1, "known": 0, "refused": []}
    row = Capture.objects.get()
    assert {name: getattr(row, name) for name in told} == told
    assert (row.yaw_deg, row.yaw_frame, row.attitude_source, row.waypoint_sequence) == (270.0, "earth", "camera", 4)
    assert (row.time_source, row.time_bound_s, row.position_source) == ("uav", None, "photo")
    assert (row.position.coords, row.uav) == ((10.001, 55.995), kite.uav)


def test_photos_that_are_sent_again_are_known_and_numbers_that_are_used_again_are_refused(kite):
    first = photo(1)
    assert send(kite, first, photo(2))["stored"] == 2
    assert send(kite, first, photo(3)) == {"stored": 1, "known": 1, "refused": []}
    again = send(kite, photo(1, taken_at=seconds_ago(1)))
    assert (again["stored"], again["known"], [list(one["faults"]) for one in again["refused"]]) == (0, 0, [["sequence"]])
    assert send(kite, photo(1, taken_at=seconds_ago(60)), stream="photos-2")["stored"] == 1


def test_faulty_photos_are_named_and_the_others_stored(kite):
    other = Mission.objects.create(name="Of others")
    answer = send(
        kite, photo(1), photo(2, position=[0.0, 0.0]), photo(3, pitch_deg="down"), photo(4, altitude=3.0), {"sequence": 5}, "photo",
        photo(7, mission=str(other.pk)), photo(8, taken_at="yesterday"), photo(9, image_index=-1), photo(10, file_url="x" * 300),
    )  # fmt: skip
    assert answer["stored"] == 1
    assert [(one["index"], list(one["faults"])) for one in answer["refused"]] == [
        (1, ["position"]), (2, ["pitch_deg"]), (3, ["altitude"]), (4, ["taken_at"]), (5, [""]), (6, ["mission"]), (7, ["taken_at"]),
        (8, ["image_index"]), (9, ["file_url"]),
    ]  # fmt: skip


def test_photo_from_the_future_has_the_time_of_its_receipt(kite):
    send(kite, photo(taken_at=(timezone.now() + timedelta(hours=2)).isoformat()))
    row = Capture.objects.get()
    assert (row.time_source, row.taken_at) == ("receipt", row.received_at)


def test_photo_that_the_autopilot_told_of_is_the_same_one(kite):
    taken_at = timezone.now() - timedelta(seconds=20)
    store_captures([new(kite.uav, feedback(3), (taken_at - START).total_seconds())])
    send(kite, photo(taken_at=(taken_at + timedelta(seconds=0.4)).isoformat(), pitch_deg=-45.0, yaw_deg=10.0, file_url="a.jpg"))
    row = Capture.objects.get()
    assert CaptureReport.objects.count() == 2
    assert (row.attitude_source, row.pitch_deg, row.file_url, row.image_index) == ("camera", -45.0, "a.jpg", 3)
