"""A second ground station on the vehicle's channel keeps the streams that it lives by: the gateway does not stop them."""

import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.signing import FrameWriter
from telemetry.gateway import message_requests
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, unsigned_uav

pytestmark = pytest.mark.django_db(transaction=True)
LISTENS_S, FLOWN_S = 1.0, 4.0


@pytest.mark.parametrize("has_station", [False, True])
def test_streams_are_stopped_where_no_other_station_is_heard(has_station, settings, tmp_path, monkeypatch):
    monkeypatch.setattr(message_requests, "LISTENS_S", LISTENS_S)
    settings.FLIGHT_LOG_DIR = tmp_path
    unsigned_uav(7)
    station = FrameWriter(250, mavlink.MAV_COMP_ID_MISSIONPLANNER)
    beat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 7) as vehicle:
        received, began_s = [], time.monotonic()
        while (passed_s := time.monotonic() - began_s) < FLOWN_S:
            vehicle.send(heartbeat(), position(round(passed_s * 1000)))
            if has_station:
                vehicle.send_raw(station.frame_of(beat, time.time()))
            received += vehicle.received()
            time.sleep(0.1)
    kinds = [message.get_type() for message in received]
    assert "COMMAND_LONG" in kinds, "it is asked for intervals"
    assert ("REQUEST_DATA_STREAM" in kinds) != has_station
