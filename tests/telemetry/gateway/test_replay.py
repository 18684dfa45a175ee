"""A real flight of 2015, as its ground station logged it, sent to the gateway frame by frame."""

import time

import pytest

from telemetry.models import TelemetryRecord
from tests.telemetry.gateway.station import Link, gateway_at_work, port_of, unsigned_uav, wait_for
from tests.telemetry.tlogs import frames_of_tlog, positions_of

pytestmark = pytest.mark.django_db(transaction=True)

FIRST_S = 120.0


@pytest.mark.parametrize("speed", [40.0, pytest.param(1.0, marks=pytest.mark.long)])
def test_every_position_of_a_real_flight_is_stored_once_and_in_order(speed, shared_data, tmp_path):
    frames = frames_of_tlog(shared_data("telemetry/dronekit-flight-2015.tlog"))
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
