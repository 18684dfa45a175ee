"""Records are stored once, flagged where their time is wrong, and only the newest moves a UAV."""

from math import inf, nan

import numpy as np
import pytest
from django.contrib.gis.geos import Point
from django.db.models import F
from django.utils import timezone

from inspection.services import import_terrain
from mavlink.decoding.measurement import Measurement, believable
from missions.models import Approval, CommandKind, LinkKind, Mission, MissionState, MissionUav, Uav
from missions.services.commands.commands import queue_command
from telemetry.models import TelemetryRecord, TelemetryStream
from telemetry.selectors.watched import watched_flights
from telemetry.services import StoredCount, store_records
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.telemetry.flown_missions import flies_route
from tests.telemetry.records import START, at, record

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return Uav.objects.create(name="One", location=Point(0, 0), located_at=at(-100))


def test_every_value_is_stored(uav):
    reported = {
        "longitude_deg": 10.5, "latitude_deg": -55.5, "altitude_amsl_m": 100.5, "altitude_relative_m": 30.5, "altitude_agl_m": 29.5,
        "velocity_north_mps": 1.5, "velocity_east_mps": -2.5, "velocity_down_mps": 0.5, "airspeed_mps": 4.5, "roll_deg": -5.5,
        "pitch_deg": 6.5, "heading_deg": 7.5, "battery_percent": 80.5, "battery_v": 12.5, "battery_a": 9.5, "mode": "Mission",
        "is_armed": True, "is_in_air": False, "link_quality_percent": 99.5, "gps_fix": 3, "satellites": 14, "hdop": 0.75,
        "wind_north_mps": 1.25, "wind_east_mps": -3.25, "mission_item": 4, "waypoint_sequence": 3,
    }  # fmt: skip
    assert store_records([record(uav, 1, **reported)]) == StoredCount(stored=1)
    row = TelemetryRecord.objects.get()
    assert (row.position.x, row.position.y, row.position.srid) == (10.5, -55.5, 4326)
    assert {name: getattr(row, name) for name in reported if name not in {"longitude_deg", "latitude_deg"}} == {
        name: value for name, value in reported.items() if name not in {"longitude_deg", "latitude_deg"}
    }
    assert (row.uav, row.stream.uav, row.stream.key, row.stream.link) == (uav, uav, "boot", LinkKind.MAVLINK)
    assert (row.measured_at, row.received_at, row.sequence, row.mission) == (at(1), at(1), 1, None)


def test_nothing_known_is_stored_as_nothing(uav):
    store_records([record(uav, 1, longitude_deg=None, latitude_deg=None)])
    row = TelemetryRecord.objects.get()
    assert row.position is None and row.altitude_agl_m is None and row.mode == ""


def test_a_record_is_stored_once_however_often_it_comes(uav):
    first, second = record(uav, 1), record(uav, 2)
    assert store_records([first, second, first]) == StoredCount(stored=2, duplicates=1)
    assert store_records([second, record(uav, 3)]) == StoredCount(stored=1, duplicates=1)
    assert store_records([first]).duplicates == 1
    assert list(TelemetryRecord.objects.order_by("sequence").values_list("sequence", flat=True)) == [1, 2, 3]
    assert TelemetryStream.objects.count() == 1


def test_the_same_number_in_another_stream_or_of_another_uav_is_another_record(uav):
    other = Uav.objects.create(name="Two", location=Point(0, 0))
    assert store_records([record(uav, 1), record(uav, 1, stream="next boot"), record(other, 1)]).stored == 3


def test_records_of_a_uav_that_is_gone_do_not_hinder_others(uav):
    gone = Uav.objects.create(name="Gone", location=Point(0, 0))
    records = [record(gone, 1), record(uav, 1)]
    gone.delete()
    assert store_records(records) == StoredCount(stored=1, of_unknown_uavs=1)
    assert store_records(records[:1]) == StoredCount(of_unknown_uavs=1)
    assert store_records([]) == StoredCount()


def test_a_record_from_the_future_is_kept_flagged_and_never_the_latest(uav):
    counted = store_records([record(uav, 1, measured_s=1), record(uav, 2, measured_s=3_600, received_s=2, longitude_deg=99.0)])
    assert counted == StoredCount(stored=2, from_future=1)
    assert store_records([record(uav, 3, measured_s=3)]) == StoredCount(stored=1)
    assert list(TelemetryRecord.objects.filter(is_from_future=True).values_list("sequence", flat=True)) == [2]
    uav.refresh_from_db()
    assert (uav.location.x, uav.located_at) == (10.0, at(3))


def test_a_minute_ahead_is_not_the_future(uav):
    assert store_records([record(uav, 1, measured_s=60, received_s=0)]).from_future == 0
    assert store_records([record(uav, 2, measured_s=60.001, received_s=0)]).from_future == 1


def test_late_records_are_kept_flagged_and_move_nothing_back(uav):
    assert store_records([record(uav, 10, longitude_deg=11.0), record(uav, 5)]) == StoredCount(stored=2, late=1)
    assert store_records([record(uav, 7), record(uav, 12, longitude_deg=12.0)]) == StoredCount(stored=2, late=1)
    assert list(TelemetryRecord.objects.filter(is_late=True).order_by("sequence").values_list("sequence", flat=True)) == [5, 7]
    uav.refresh_from_db()
    assert (uav.location.x, uav.located_at) == (12.0, at(12))


def test_a_location_set_later_than_measured_stays(uav):
    Uav.objects.filter(pk=uav.pk).update(located_at=at(50), location=Point(3, 4))
    store_records([record(uav, 10)])
    uav.refresh_from_db()
    assert (uav.location.x, uav.located_at) == (3.0, at(50))
    store_records([record(uav, 51, heading_deg=90.0, battery_percent=55.0)])
    store_records([record(uav, 52)])
    uav.refresh_from_db()
    assert (uav.location.x, uav.heading_deg, uav.battery_percent, uav.revision) == (10.0, 90.0, 55.0, 1)


def test_a_record_is_of_the_mission_that_is_flown(uav):
    dispatched, active, planned = (
        Mission.objects.create(name=state, state=state, planned_at=timezone.now(), graph_version=1)
        for state in (MissionState.DISPATCHED, MissionState.ACTIVE, MissionState.PLANNED)
    )
    for mission in (dispatched, active, planned):
        flies_route(mission, uav)
    store_records([record(uav, 1)])
    Mission.objects.filter(pk=active.pk).update(state=MissionState.COMPLETED)
    store_records([record(uav, 2)])
    Mission.objects.filter(pk=dispatched.pk).update(deleted_at=timezone.now())
    store_records([record(uav, 3)])
    assert list(TelemetryRecord.objects.order_by("sequence").values_list("mission", flat=True)) == [active.pk, dispatched.pk, None]


def test_a_record_is_of_no_mission_that_lists_the_uav_and_has_no_route_for_it(uav):
    mission = Mission.objects.create(name="South", state=MissionState.ACTIVE, planned_at=timezone.now(), graph_version=1)
    MissionUav.objects.create(mission=mission, uav=uav, sequence=0, name="One", start=Point(0, 0), cruise_speed_mps=5)
    store_records([record(uav, 1)])
    assert TelemetryRecord.objects.get().mission is None


def test_a_record_is_of_the_mission_of_which_a_route_was_sent_last(uav):
    """South was started later, by its other UAV; its route of this one was never sent."""
    north, south = (
        Mission.objects.create(name=name, state=MissionState.ACTIVE, planned_at=timezone.now(), graph_version=1)
        for name in ("North", "South")
    )
    for mission in (north, south):
        flies_route(mission, uav)
    approval = Approval.objects.create(mission=north, document={}, content_sha256="a" * 64)
    queue_command(uav=uav, kind=CommandKind.UPLOAD_MISSION, actor=None, mission=north, approval=approval)
    Mission.objects.filter(pk=south.pk).update(updated_at=timezone.now())
    store_records([record(uav, 1)])
    assert TelemetryRecord.objects.get().mission == north
    Approval.objects.create(mission=south, document={}, content_sha256="b" * 64)
    assert [flight.mission_id for flight in watched_flights()] == [north.pk], "and the watch follows it on that route"


def test_what_cannot_be_is_not_believed(uav):
    wild = {
        "longitude_deg": 10.0, "latitude_deg": nan, "altitude_amsl_m": inf, "velocity_down_mps": -inf, "battery_percent": 101.0,
        "link_quality_percent": -1.0, "satellites": 70_000, "mission_item": -5, "waypoint_sequence": -1, "gps_fix": -1, "hdop": nan,
        "heading_deg": 361.0, "mode": "a\0b" + "c" * 40,
    }  # fmt: skip
    store_records([record(uav, 1, **wild)])
    row = TelemetryRecord.objects.get()
    unknown = ["position", "altitude_amsl_m", "velocity_down_mps", "battery_percent", "link_quality_percent", "satellites"]
    counted = ["mission_item", "waypoint_sequence", "gps_fix", "hdop"]
    assert [getattr(row, name) for name in [*unknown, *counted]] == [None] * 10
    assert (row.heading_deg, row.mode) == (1.0, "ab" + "c" * 28)
    uav.refresh_from_db()
    assert uav.located_at == at(-100)


@pytest.mark.parametrize(("reported", "kept"), [(-1e-20, 0.0), (-90.0, 270.0), (720.0, 0.0), (359.5, 359.5)])
def test_a_heading_comes_into_the_circle(reported, kept):
    assert believable(Measurement(longitude_deg=0.0, latitude_deg=0.0, heading_deg=reported)).heading_deg == kept


def test_measured_order_needs_no_order_of_arrival(uav):
    store_records([record(uav, sequence) for sequence in (3, 1, 2)])
    assert list(TelemetryRecord.objects.filter(measured_at__gte=START).values_list("sequence", flat=True)) == [1, 2, 3]
    assert not TelemetryRecord.objects.exclude(measured_at=F("received_at")).exists()


def test_height_above_ground_is_from_the_terrain_model(uav, tmp_path):
    file = write_geotiff(tmp_path / "hill.tif", np.full((300, 300), 100.0, dtype="f4"), srid=9707, origin=(9.9, 55.1))
    import_terrain(path=file)
    store_records([record(uav, 1, altitude_amsl_m=130.0), record(uav, 2, altitude_amsl_m=130.0, altitude_agl_m=28.0), record(uav, 3)])
    heights = list(TelemetryRecord.objects.order_by("sequence").values_list("altitude_agl_m", flat=True))
    assert heights == [pytest.approx(30.0), 28.0, None]
