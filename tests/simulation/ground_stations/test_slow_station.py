"""A simulation faster than real time waits for a station that does not keep up, instead of losing reports."""

import socket
import time

import pytest
from pymavlink.dialects.v20 import common

from simulation.vehicle_endpoint.launch import Launch
from tests.simulation.fleets import AT, flying, free_port, wait_for

SPEED = 10.0
SILENT_S = 4.0


def heartbeat() -> bytes:
    sender = common.MAVLink(None, srcSystem=255, srcComponent=190)
    return bytes(common.MAVLink_heartbeat_message(common.MAV_TYPE_GCS, common.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3).pack(sender))


@pytest.mark.long
def test_simulated_time_falls_to_real_time_while_a_station_is_silent_and_goes_on_after() -> None:
    port = free_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("127.0.0.1", port))
        with flying([Launch(1, AT, talks_to=[("127.0.0.1", port)])], speed=SPEED) as fleet:
            _, uav = station.recvfrom(65_535)
            for _ in range(4):
                station.sendto(heartbeat(), uav)
                time.sleep(0.2)
            wait_for(lambda: fleet.uavs[0].received_count >= 4)
            time.sleep(2.5)
            began_s, began = time.monotonic(), fleet.uavs[0].uav.now_s
            time.sleep(SILENT_S)
            slow = (fleet.uavs[0].uav.now_s - began) / (time.monotonic() - began_s)
            assert slow <= 1.1
            station.sendto(heartbeat(), uav)
            began_s, began = time.monotonic(), fleet.uavs[0].uav.now_s
            time.sleep(1.0)
            assert (fleet.uavs[0].uav.now_s - began) / (time.monotonic() - began_s) > 3.0
