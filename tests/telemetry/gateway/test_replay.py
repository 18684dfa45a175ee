"""Flights as their ground station logged them, a simulated one and a real one of 2015, sent to the gateway frame by frame."""

import time

import pytest

from telemetry.models import TelemetryRecord
from tests.telemetry.gateway.station import Link, gateway_at_work, port_of, unsigned_uav, wait_for
from tests.telemetry.tlogs import frames_of_tlog, positions_of, write_tlog_of_flight

pytestmark = pytest.mark.django_db(transaction=True)

FIRST_S = 120.0


@pytest.fixture
def log(request, shared_data, tmp_path):
    return write_tlog_of_flight(tmp_path / "simulated.tlog") if request.param == "simulated" else shared_data(f"telemetry/{request.param}")


@pytest.mark.parametrize("log", ["simulated", "dronekit-flight-2015.tlog"], indirect=True)
@pytest.mark.parametrize("speed", [40.0, pytest.param(1.0, marks=pytest.mark.long)])
def test_every_position_of_a_logged_flight_is_stored_once_and_in_order(speed, log, tmp_path):
    frames = frames_of_tlog(log)
    frames = [(at_s, raw) for at_s, raw in frames if at_s < frames[0][0] + FIRST_S]
    positions = positions_of(raw for _, raw in frames)
    assert len(positions) > 100
    unsigned_uav(1)
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as link:
        began_s, first_s = time.monotonic(), frames[0][0]
        for at_s, raw in frames:
            time.sleep(max(began_s + (at_s - first_s) / speed - time.monotonic(), 0.0))
            link.send_raw(raw)
        wait_for(lambda: TelemetryRecord.objects.count() >= len(positions))
    rows = TelemetryRecord.objects.order_by("measured_at", "pk")
    assert list(rows.values_list("sequence", flat=True)) == [message.time_boot_ms for message in positions]
    headings = [message.hdg / 100 for message in positions]
    assert list(rows.values_list("heading_deg", flat=True)) == headings
    assert all(row.position is None for row in rows if row.gps_fix in (None, 0, 1))
    assert sum(row.position is not None for row in rows) > 100
