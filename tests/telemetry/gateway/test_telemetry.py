"""What vehicles report goes through real sockets into rows."""

import socket

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.signing import FrameWriter
from telemetry.models import TelemetryRecord, UavLink, UnknownVehicle, VehicleText
from telemetry.services.links.unknown_vehicles import NewUav, adopt_vehicle
from tests.accounts.users import a_user
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, unsigned_uav, wait_for
from workspace.models import Role

pytestmark = pytest.mark.django_db(transaction=True)

POSITION_ID = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT


def sequences(**of) -> list[int]:
    return list(TelemetryRecord.objects.filter(**of).order_by("measured_at", "pk").values_list("sequence", flat=True))


def test_every_position_is_stored_once_and_in_order(tmp_path):
    uav = unsigned_uav()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as vehicle:
        vehicle.send(heartbeat(is_armed=True, mode=3), mavlink.MAVLink_attitude_message(900, 0, 0, 0, 0, 0, 0))
        for number in range(200):
            vehicle.send(position(1_000 + number * 200, lon=10 + number / 1e4))
            if number % 3 == 0:
                vehicle.send(position(1_000 + number * 200))
        wait_for(lambda: TelemetryRecord.objects.count() >= 200)
    assert sequences() == [1_000 + number * 200 for number in range(200)]
    row = TelemetryRecord.objects.order_by("-measured_at").first()
    assert (row.uav, row.mode, row.is_armed, row.roll_deg, row.altitude_amsl_m) == (uav, "AUTO", True, 0.0, 30.0)
    uav.refresh_from_db()
    assert uav.location.x == pytest.approx(10 + 199 / 1e4)


def test_a_link_is_described(tmp_path):
    uav = unsigned_uav()
    with gateway_at_work(tmp_path, name="here") as gateway, Link(port_of(gateway)) as vehicle:
        vehicle.send(
            heartbeat(mode=5), mavlink.MAVLink_home_position_message(550_000_000, 100_000_000, 25_000, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0)
        )
        vehicle.send(position(5_000), mavlink.MAVLink_statustext_message(4, b"Flight plan received", 0, 0))
        link = wait_for(lambda: UavLink.objects.filter(uav=uav, home_amsl_m__isnull=False, clock_offset_s__isnull=False).first())
        assert link.holder.startswith("here/") and link.lease_expires_at is not None
        assert (link.autopilot, link.mode, link.is_armed, link.home.x, link.home_amsl_m) == ("ardupilot", "LOITER", False, 10.0, 25.0)
        assert link.address.startswith("udp:127.0.0.1:") and link.clock_rate == 1.0
        text = wait_for(lambda: VehicleText.objects.first())
        assert (text.uav, text.severity, text.text) == (uav, 4, "Flight plan received")
    link.refresh_from_db()
    assert (link.holder, link.lease_expires_at) == ("", None), "released at the end"


def test_a_vehicle_hears_a_ground_station_that_asks_for_messages(tmp_path):
    unsigned_uav()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as vehicle:
        received = []

        def asked() -> bool:
            vehicle.send(heartbeat())
            received.extend(vehicle.received())
            names = {message.get_type() for message in received}
            return {"HEARTBEAT", "REQUEST_DATA_STREAM", "COMMAND_LONG"} <= names

        wait_for(asked)
    (beat, *_) = [message for message in received if message.get_type() == "HEARTBEAT"]
    assert (beat.type, beat.autopilot, beat.get_srcSystem()) == (mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 255)
    commands = {(message.command, message.param1) for message in received if message.get_type() == "COMMAND_LONG"}
    assert {(511, 33), (512, 148), (512, 242)} <= commands


def test_a_connection_by_tcp_cut_into_pieces(tmp_path):
    unsigned_uav(9)
    writer = FrameWriter(9, 1)
    stream = b"".join(writer.frame_of(message, 0) for message in [heartbeat(), *(position(1_000 + n * 200) for n in range(50))])
    with gateway_at_work(tmp_path) as gateway, socket.create_connection(("127.0.0.1", port_of(gateway, "tcp"))) as connection:
        for start in range(0, len(stream), 37):
            connection.send(b"garbage"[: start % 8] if start == 37 * 20 else b"")
            connection.send(stream[start : start + 37])
        wait_for(lambda: TelemetryRecord.objects.count() >= 49)
        assert connection.recv(1_000), "it is answered on the same connection"
    assert len(sequences()) in (49, 50), "the frame that garbage was put into is lost, if any"


def test_ground_stations_and_strangers_are_no_uavs(tmp_path):
    unsigned_uav(1)
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 77) as stranger, Link(port_of(gateway), 255) as station:
        station.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3))
        with Link(port_of(gateway), 78) as camera:
            camera.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_CAMERA, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3))
        for _ in range(5):
            stranger.send(heartbeat(autopilot=mavlink.MAV_AUTOPILOT_PX4), position(1_000))
        unknown = wait_for(lambda: UnknownVehicle.objects.first())
    assert UnknownVehicle.objects.count() == 1
    assert (unknown.mavlink_system_id, unknown.autopilot, unknown.vehicle_type, unknown.is_signed) == (77, "px4", "quadrotor", False)
    assert not TelemetryRecord.objects.exists()


def test_a_stranger_is_asked_where_it_is_and_can_then_be_adopted_by_name(tmp_path):
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 77) as stranger:

        def is_placed() -> bool:
            stranger.send(heartbeat())
            asked = [message for message in stranger.received() if message.get_type() == "COMMAND_LONG"]
            if any((message.command, message.param1) == (mavlink.MAV_CMD_REQUEST_MESSAGE, POSITION_ID) for message in asked):
                stranger.send(position(1_000))
            return UnknownVehicle.objects.filter(location__isnull=False).exists()

        wait_for(is_placed)
        assert not stranger.received(), "it is asked no more"
    adopted = adopt_vehicle(vehicle=UnknownVehicle.objects.get(), actor=a_user(Role.ADMINISTRATOR), uav=NewUav("Kite"))
    assert adopted.location.coords == pytest.approx((position(1_000).lon / 1e7, position(1_000).lat / 1e7))


def test_nobody_can_fill_the_table_of_strangers(tmp_path):
    with gateway_at_work(tmp_path) as gateway:
        for system in [*range(256)] * 3:
            with Link(port_of(gateway), system) as stranger:
                stranger.send(heartbeat())
        wait_for(lambda: UnknownVehicle.objects.count() >= 254)
    assert UnknownVehicle.objects.count() == 254


def test_an_adopted_vehicle_is_served_without_a_restart(tmp_path):
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway), 12) as vehicle:
        vehicle.send(heartbeat())
        wait_for(lambda: UnknownVehicle.objects.exists())
        uav = unsigned_uav(12)

        def stored() -> bool:
            vehicle.send(heartbeat(), position(1_000))
            return TelemetryRecord.objects.filter(uav=uav).exists()

        wait_for(stored)


def test_values_that_cannot_be_are_not_stored(tmp_path):
    nan = float("nan")
    unsigned_uav()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as vehicle:
        vehicle.send(heartbeat(), mavlink.MAVLink_attitude_message(1, nan, nan, nan, nan, nan, nan))
        vehicle.send(mavlink.MAVLink_vfr_hud_message(float("inf"), nan, 0, 0, nan, nan))
        vehicle.send(mavlink.MAVLink_global_position_int_message(1_000, 0, 0, 0, 0, 0, 0, 0, 65_535))
        vehicle.send(
            mavlink.MAVLink_global_position_int_message(2_000, 2**31 - 1, -(2**31), 2**31 - 1, -(2**31), -32_768, 32_767, 0, 40_000)
        )
        vehicle.send(position(3_000))
        wait_for(lambda: TelemetryRecord.objects.count() == 3)
    places = list(TelemetryRecord.objects.order_by("sequence").values_list("position", "roll_deg", "airspeed_mps"))
    assert [place is None for place, *_ in places] == [True, True, False]
    assert {values for _, *rest in places for values in rest} == {None}
