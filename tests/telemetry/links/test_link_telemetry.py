"""What a companion computer reports: stored once, faults named, nothing behind a fault held up."""

from datetime import timedelta
from typing import Any

import pytest
from django.utils import timezone

from missions.models import LinkKind, Mission, Uav
from telemetry.models import TelemetryRecord
from tests.telemetry.flown_missions import flies_route
from tests.telemetry.links.uav_clients import UavClient, linked_uav, report, seconds_ago

pytestmark = pytest.mark.django_db


@pytest.fixture
def kite() -> UavClient:
    return linked_uav()


def faults(kite: UavClient, **values: Any) -> list[str]:
    answer = kite.report(report(**values)).json()
    assert (answer["stored"], len(answer["refused"])) == (0, 1), answer
    return list(answer["refused"][0]["faults"])


def test_every_value_is_stored_as_it_was_sent(kite: UavClient) -> None:
    reported = {
        "altitude_amsl_m": 100.5, "altitude_relative_m": 30.5, "altitude_agl_m": 29.5, "velocity_north_mps": 1.5, "velocity_east_mps": -2.5,
        "velocity_down_mps": 0.5, "airspeed_mps": 4.5, "roll_deg": -5.5, "pitch_deg": 6.5, "heading_deg": 7.5, "battery_percent": 80.5,
        "battery_v": 12.5, "battery_a": 9.5, "mode": "Mission", "is_armed": True, "is_in_air": False, "link_quality_percent": 99.5,
        "gps_fix": 3, "satellites": 14, "hdop": 0.75, "wind_north_mps": 1.25, "wind_east_mps": -3.25, "waypoint_sequence": 4,
    }  # fmt: skip
    measured_at = timezone.now() - timedelta(seconds=3)
    answer = kite.report(report(7, measured_at=measured_at.isoformat(), **reported))
    assert (answer.status_code, answer.json()) == (200, {"stored": 1, "known": 0, "from_future": 0, "late": 0, "refused": []})
    row = TelemetryRecord.objects.get()
    assert {name: getattr(row, name) for name in reported} == reported
    assert (row.sequence, row.stream.key, row.stream.link, row.uav) == (7, "boot-1", LinkKind.HTTP, kite.uav)
    assert row.measured_at == measured_at < row.received_at <= row.stored_at
    assert row.position.coords == (10.001, 55.995)


def test_a_replay_after_a_lost_link_is_stored_once_and_told(kite: UavClient) -> None:
    batch = [report(number) for number in range(20)]
    assert kite.report(*batch[:15]).json()["stored"] == 15
    answer = kite.report(*batch).json()
    assert (answer["stored"], answer["known"]) == (5, 15)
    assert kite.report(*batch[:1], stream="boot-2").json()["stored"] == 1
    assert TelemetryRecord.objects.count() == 21


def test_a_record_that_is_twice_in_one_batch_is_stored_once(kite: UavClient) -> None:
    twice = report(1)
    answer = kite.report(twice, report(2), twice).json()
    assert (answer["stored"], answer["known"], answer["refused"]) == (2, 1, [])


def test_a_companion_that_was_started_anew_and_counts_from_0_in_the_old_stream_is_told(kite: UavClient) -> None:
    """Silently dropped as known, its reports would be lost for as long as it takes to reach the old number."""
    before = [report(number, measured_at=seconds_ago(100 - number)) for number in range(10)]
    kite.report(*before)
    answer = kite.report(report(0), before[3], report(4), report(10)).json()
    assert (answer["stored"], answer["known"]) == (1, 1)
    assert [(refused["index"], list(refused["faults"])) for refused in answer["refused"]] == [(0, ["sequence"]), (2, ["sequence"])]
    assert kite.report(report(0), stream="boot-2").json()["stored"] == 1


def test_sound_records_of_a_batch_are_stored_and_faulty_ones_named(kite: UavClient) -> None:
    answer = kite.report(report(1), report(2, battery_percent=101), "three", report(4)).json()
    assert answer["stored"] == 2
    assert answer["refused"] == [
        {"index": 1, "sequence": 2, "faults": {"battery_percent": "A number from 0 to 100 is needed."}},
        {"index": 2, "sequence": None, "faults": {"": "A record is an object."}},
    ]


@pytest.mark.parametrize("number", [float("nan"), float("inf"), 1e999])
def test_what_is_no_number_is_named_and_holds_up_nothing(kite: UavClient, number: float) -> None:
    answer = kite.report(report(1, hdop=number), report(2, position=[number, 56.0]), report(3)).json()
    assert answer["stored"] == 1
    assert [list(refused["faults"]) for refused in answer["refused"]] == [["hdop"], ["position"]]


@pytest.mark.parametrize("position", [[10.0], [200.0, 10.0], [10.0, 91.0], ["10", "56"], {"lon": 10}, [True, False], [0, 0], [10**400, 1]])
def test_what_is_no_place_is_refused(kite: UavClient, position: Any) -> None:
    assert faults(kite, position=position) == ["position"]


def test_a_place_that_was_sent_latitude_first_is_told(kite: UavClient) -> None:
    answer = kite.report(report(position=[55.995, 10.001])).json()
    assert "longitude first" in answer["refused"][0]["faults"]["position"]


def test_a_uav_that_was_moved_far_away_is_believed(kite: UavClient) -> None:
    assert kite.report(report(position=[-70.0, -33.0])).json()["stored"] == 1


def test_a_height_without_a_reference_is_told(kite: UavClient) -> None:
    for name in ("altitude_m", "altitude"):
        assert faults(kite, **{name: 40.0}) == [name]


def test_an_item_of_an_autopilots_list_is_no_waypoint(kite: UavClient) -> None:
    answer = kite.report(report(1, mission_item=3)).json()
    assert "waypoint_sequence" in answer["refused"][0]["faults"]["mission_item"]


@pytest.mark.parametrize(
    "measured_at", ["yesterday", "2026-11-22T12:00:00", 1_763_000_000, None, "1900-01-01T00:00:00Z", "9999-12-31T23:59:59-10:00"]
)
def test_a_time_without_zone_or_sense_is_refused(kite: UavClient, measured_at: Any) -> None:
    assert faults(kite, measured_at=measured_at) == ["measured_at"]


def test_records_from_the_future_are_kept_flagged_and_move_nothing(kite: UavClient) -> None:
    kite.report(report(1))
    answer = kite.report(report(2, position=[10.5, 56.0], measured_at=seconds_ago(-10 * 365 * 86_400))).json()
    assert (answer["stored"], answer["from_future"]) == (1, 1)
    assert TelemetryRecord.objects.get(sequence=2).is_from_future
    assert Uav.objects.get().location.coords == (10.001, 55.995)


def test_records_out_of_order_are_kept_and_flagged(kite: UavClient) -> None:
    answer = kite.report(report(1, measured_at=seconds_ago(10)), report(2, measured_at=seconds_ago(30))).json()
    assert (answer["stored"], answer["late"]) == (2, 1)
    assert TelemetryRecord.objects.get(sequence=2).is_late


def test_a_record_names_only_a_mission_of_its_own_uav(kite: UavClient) -> None:
    own, other = Mission.objects.create(name="Own"), Mission.objects.create(name="Other")
    flies_route(own, kite.uav)
    answer = kite.report(report(1, mission=str(own.pk)), report(2, mission=str(other.pk)), report(3, mission="x")).json()
    assert [refused["index"] for refused in answer["refused"]] == [1, 2]
    assert TelemetryRecord.objects.get().mission == own


@pytest.mark.parametrize(
    "body",
    [
        [], {}, {"stream": "a"}, {"records": [{}]}, {"stream": "a b", "records": [{}]}, {"stream": "x" * 65, "records": [{}]},
        {"stream": "a", "records": []}, {"stream": "a", "records": [{}] * 1_001}, {"stream": "a", "records": [{}], "uav": 1},
    ],
)  # fmt: skip
def test_what_is_no_batch_is_refused(kite: UavClient, body: Any) -> None:
    assert kite.post("telemetry", body).status_code == 400


def test_the_largest_batch_is_taken(kite: UavClient) -> None:
    assert kite.report(*[report(number) for number in range(1_000)]).json()["stored"] == 1_000


@pytest.mark.parametrize("value", [10**30, -1, 1.5, "1", True, None])
def test_a_sequence_is_a_whole_number_that_can_be_stored(kite: UavClient, value: Any) -> None:
    assert faults(kite, sequence=value) == ["sequence"]
