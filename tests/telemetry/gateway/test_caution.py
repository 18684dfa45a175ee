"""What a gateway does not do: act on a lease that may be over, set in motion what is being loaded, or fly what stands elsewhere."""

import asyncio
import time
from collections import Counter, deque
from datetime import timedelta
from types import SimpleNamespace
from uuid import uuid4

import pytest
from django.db.models import F
from django.db.models.functions import Now
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.approved_route import TakeOff
from mavlink.autopilot_type import AutopilotType
from mavlink.commands.actions import Order
from mavlink.frames import frames_of_datagram
from mavlink.mission_sync.flown_items import FlownMissionItem
from mavlink.signing import FrameWriter
from mavlink.timeouts import CommandRules
from mavlink.vehicle_plan import FlightLoad, MissionItem
from mavlink.vehicle_state import MAX_PARAMETERS, VehicleState
from missions.models import CommandAxis, CommandKind
from missions.services.commands.commands import claim_commands, queue_command, renew_claims
from telemetry.gateway.database import DatabaseUnavailable
from telemetry.gateway.delivery import Delivery
from telemetry.gateway.dispatcher import MAX_UPLOADS, Dispatcher
from telemetry.gateway.fleet import KnownUav
from telemetry.gateway.preparation import DeliveryTask, reason_not_to
from telemetry.gateway.process import _link_id
from telemetry.gateway.session import Session
from telemetry.gateway.store import Store
from telemetry.models import UavLink
from telemetry.services.links.links import Lease, save_links, take_leases
from tests.telemetry.gateway.station import unsigned_uav

HERE = LonLat(10.0, 56.0)
FAR = LonLat(10.02, 56.0)
MISSION = 4 << 16 | 4 << 24  # PX4


def an_item(command: int, place: LonLat, altitude_m: float) -> MissionItem:
    return MissionItem(command, 6, (0.0, 0.0, 0.0, 0.0), round(place.lon * 1e7), round(place.lat * 1e7), altitude_m)


TO_FAR = FlightLoad((an_item(22, HERE, 30.0), an_item(16, FAR, 60.0), an_item(21, FAR, 0.0)))
IN_AIR, ON_GROUND = mavlink.MAV_LANDED_STATE_IN_AIR, mavlink.MAV_LANDED_STATE_ON_GROUND


class Database:
    """Answers as told, or not at all."""

    def __init__(self, **answers) -> None:
        self.is_away, self.answers, self.asked = False, answers, []

    async def run(self, do, *_values, **named):
        self.asked.append((do, named))
        if self.is_away:
            raise DatabaseUnavailable("away")
        answer = self.answers.get(do.__name__, True)
        return answer() if callable(answer) else answer


def a_command(kind: CommandKind, uav_id: int = 1, *, priority: int = 2) -> SimpleNamespace:
    axis = CommandAxis.MISSION if kind in (CommandKind.UPLOAD_MISSION, CommandKind.CLEAR_MISSION) else CommandAxis.FLIGHT
    return SimpleNamespace(
        pk=uuid4(), uav_id=uav_id, kind=kind, axis=axis, priority=priority, created_at=0, attempts=1, holder="one", sequence=1
    )


def a_desk(database: Database, *sessions, lease_s: float = 10.0) -> Dispatcher:
    desk = Dispatcher("one", lease_s, lambda: list(sessions))
    desk.database.close()
    desk.database = database
    return desk


def received(*messages) -> VehicleState:
    state, frames = VehicleState(7), mavlink.MAVLink(None, srcSystem=7, srcComponent=1)
    for message in messages:
        state.receive(mavlink.MAVLink(None).parse_char(message.pack(frames)), time.monotonic())
    return state


def test_nothing_is_sent_on_a_lease_that_may_be_over(settings):
    settings.VEHICLE_COMMAND_RULES = CommandRules(timeout_s=0.05)
    sent = []
    state = received(mavlink.MAVLink_heartbeat_message(2, 3, 1, 0, 3, 3))
    session = SimpleNamespace(
        state=state, listeners=[], is_held=True, commanded_s=None, uav=SimpleNamespace(system=7, name="Tern", uav_id=1),
        send=lambda messages: sent.extend(time.monotonic() for _ in messages), unsettled_until_s=lambda _: None,
    )  # fmt: skip
    command = a_command(CommandKind.ARM)
    database = Database(task_of=DeliveryTask(order=Order.ARM), renew_claims=lambda: {command.pk: 1}, claim_commands=list)
    desk = a_desk(database, lease_s=0.5)
    began_s = time.monotonic()
    carried = desk._deliveries[command.pk] = Delivery(command, session, database, began_s + 0.4)

    async def run() -> None:
        desk._begin()
        await asyncio.sleep(0.1)
        database.is_away = True
        await asyncio.sleep(0.7)
        for task in desk._tasks.values():
            task.cancel()

    asyncio.run(run())
    assert len(sent) > 1 and max(sent) < began_s + 0.4 + 0.02
    assert not carried.is_ours and not carried.is_dropped, "nobody had to tell it"


@pytest.mark.parametrize("kind", [CommandKind.RESUME, CommandKind.ARM, CommandKind.TAKE_OFF, CommandKind.START])
@pytest.mark.parametrize("loading", [CommandKind.UPLOAD_MISSION, CommandKind.CLEAR_MISSION])
def test_nothing_is_set_in_motion_while_it_is_loaded(kind, loading):
    desk, upload, motion = a_desk(Database()), a_command(loading), a_command(kind, priority=1)
    for under_way, waiting in ((upload, motion), (motion, upload)):
        desk._deliveries = {under_way.pk: Delivery(under_way, None, None)}
        desk._tasks = {under_way.pk: object()}
        assert not desk._may_begin(waiting)
        assert desk._may_begin(a_command(kind, uav_id=2)), "another UAV"
    desk._deliveries, desk._tasks = {upload.pk: Delivery(upload, None, None)}, {upload.pk: object()}
    assert desk._may_begin(a_command(CommandKind.HOLD, priority=0))


def test_an_abort_is_claimed_however_many_uploads_there_are():
    session = SimpleNamespace(uav=SimpleNamespace(uav_id=1), is_served=lambda *_: True, may_receive=lambda _: True)
    uploads = [a_command(CommandKind.UPLOAD_MISSION, number) for number in range(MAX_UPLOADS)]
    database = Database(renew_claims=lambda: {upload.pk: 1 for upload in uploads}, claim_commands=list)
    desk = a_desk(database, session)
    desk._deliveries = {upload.pk: Delivery(upload, None, None) for upload in uploads}
    desk._tasks = {upload.pk: SimpleNamespace(done=lambda: False) for upload in uploads}
    asyncio.run(desk.poll())
    claims = [named for do, named in database.asked if do is claim_commands]
    others = [[CommandAxis.FLIGHT], [CommandAxis.SPEED], [CommandAxis.PARAMETER]]
    assert [claim["axes"] for claim in claims] == others, "and no upload more than may begin"

    del desk._deliveries[uploads[0].pk], desk._tasks[uploads[0].pk]
    database.asked.clear()
    asyncio.run(desk.poll())
    claims = [named for do, named in database.asked if do is claim_commands]
    assert [claim["limit"] for claim in claims if claim["axes"] == [CommandAxis.MISSION]] == [1]


def test_what_was_given_back_and_claimed_anew_is_carried_on():
    desk, command = a_desk(Database()), a_command(CommandKind.ABORT)
    desk._deliveries = {command.pk: Delivery(command, None, None)}
    desk._tasks = {command.pk: SimpleNamespace(done=lambda: True)}  # of the attempt before
    desk._forget_ended()
    assert list(desk._deliveries) == [command.pk] and not desk._tasks


@pytest.mark.parametrize(
    ("landed", "position", "home", "home_m", "code"),
    [
        (ON_GROUND, HERE, HERE, 100.0, None),
        (IN_AIR, FAR, HERE, 104.0, None),
        (ON_GROUND, FAR, HERE, 100.0, "elsewhere"),
        (IN_AIR, FAR, FAR, 100.0, "home-elsewhere"),
        (ON_GROUND, HERE, FAR, 100.0, "home-elsewhere"),
        (IN_AIR, HERE, HERE, 111.0, "home-height"),
        (ON_GROUND, HERE, HERE, 89.0, "home-height"),
        (IN_AIR, HERE, None, None, "no-home"),
        (ON_GROUND, HERE, None, None, "no-home"),
    ],
)
@pytest.mark.parametrize("order", [Order.START, Order.RESUME])
def test_a_list_is_flown_only_from_the_home_it_was_planned_for(order, landed, position, home, home_m, code):
    state = VehicleState(
        7, autopilot_type=AutopilotType.PX4, landed_state=landed, landed_at_s=0.0, received_at_s=0.0, position=position,
        altitude_amsl_m=100.0, altitude_relative_m=30.0, position_at_s=0.0,
        home=home, home_amsl_m=home_m, home_at_s=0.0, mission_item=1, mission_item_at_s=0.0,
    )  # fmt: skip
    found = reason_not_to(DeliveryTask(order=order, onboard=TO_FAR, take_off=TakeOff(HERE, 100.0)), state, 1.0)
    assert (found and found.code) == code


@pytest.mark.parametrize(
    ("facts", "code"),
    [
        ({}, None),
        ({"position": LonLat(10.01, 56.0002)}, None),
        ({"position": LonLat(10.01, 56.0005)}, "off-route"),
        ({"position": LonLat(10.021, 56.0)}, "off-route"),
        ({"position": LonLat(10.021, 56.0), "custom_mode": MISSION}, None),  # it does so already: nothing is sent
        ({"altitude_relative_m": 75.0}, "off-height"),
        ({"altitude_relative_m": 15.0}, "off-height"),
        ({"mission_item": 3}, "flown-already"),
        ({"mission_item": None}, "no-item"),
        ({"position_at_s": -20.0}, "no-position"),
        ({"mission_item_at_s": -20.0}, "no-item"),
        ({"home_at_s": -20.0}, "no-home"),
        ({"autopilot_type": AutopilotType.ARDUPILOT, "mission_item": 2}, "no-item"),
        ({"autopilot_type": AutopilotType.ARDUPILOT, "mission_item": 2, "parameters": {"MIS_RESTART": 0.0}}, None),
        ({"autopilot_type": AutopilotType.ARDUPILOT, "mission_item": 2, "parameters": {"MIS_RESTART": 1.0}}, "off-route"),
    ],
)
@pytest.mark.parametrize("order", [Order.START, Order.RESUME])
def test_a_uav_in_the_air_goes_on_only_from_the_leg_that_was_approved(order, facts, code):
    """After a hold it may have been flown elsewhere by hand, or be on its way back: from there the way was looked at by nobody."""
    usual = {
        "autopilot_type": AutopilotType.PX4, "custom_mode": 0, "landed_state": IN_AIR, "landed_at_s": 0.0, "received_at_s": 0.0,
        "position": LonLat(10.01, 56.0), "altitude_relative_m": 50.0, "position_at_s": 0.0, "home": HERE, "home_amsl_m": 100.0,
        "home_at_s": 0.0, "mission_item": 1, "mission_item_at_s": 0.0,
    }  # fmt: skip
    state = VehicleState(7, **usual | facts)
    found = reason_not_to(DeliveryTask(order=order, onboard=TO_FAR, take_off=TakeOff(HERE, 100.0)), state, 1.0)
    assert (found and found.code) == code


def test_gateways_sign_as_different_links():
    assert _link_id("gateway-12") != _link_id("gateway-21")
    assert len({_link_id(f"spanwise-gateway-{number}") for number in range(8)}) == 8


@pytest.mark.django_db
def test_when_a_vehicle_was_heard_is_told_by_the_databases_clock(monkeypatch, tmp_path):
    """A gateway whose clock is an hour behind has heard it just now all the same, so that no other takes it away."""
    uav = unsigned_uav(7)
    hour_ago_s = time.time() - 3_600.0
    monkeypatch.setattr(time, "time", lambda: hour_ago_s)
    session = Session(KnownUav(uav.pk, uav.organisation_id, uav.name, 7, True, None, None), deque(), link_id=1)
    (lease,) = take_leases(uav_ids=[uav.pk], holder="one/1", lease_s=10.0)
    session.serve(lease, time.monotonic() + 8.0)
    session.authentication.last_message_s = hour_ago_s - 1.0
    save_links(states=[session.link_state()], holder="one/1")
    (ago_s,) = UavLink.objects.annotate(ago=Now() - F("last_message_at")).values_list("ago", flat=True)
    assert 1.0 <= ago_s.total_seconds() < 4.0
    assert take_leases(uav_ids=[uav.pk], holder="two/1", lease_s=10.0) == []


@pytest.mark.django_db
def test_two_gateways_of_one_name_do_not_take_uavs_from_each_other():
    uav = unsigned_uav(7)
    values = {"uav_ids": [uav.pk], "lease_s": 10.0}
    assert take_leases(holder="gateway/one", **values)
    assert take_leases(holder="gateway/two", **values) == [], "it runs"
    UavLink.objects.update(lease_expires_at=Now() + timedelta(seconds=7))
    assert take_leases(holder="other/one", **values) == []
    assert take_leases(holder="gateway/two", **values), "it was started again"


@pytest.mark.django_db
def test_what_a_gateway_had_claimed_waits_for_no_lease_once_another_serves_the_uav():
    uav, other = unsigned_uav(7), unsigned_uav(8)
    for one in (uav, other):
        queue_command(uav=one, kind=CommandKind.ABORT, actor=None)
    claimed = {"limit": 10, "lease_s": 10.0, "uav_ids": [uav.pk, other.pk]}
    for_them = claim_commands(holder="one/1", **claimed)
    assert len(for_them) == 2 and claim_commands(holder="two/1", **claimed) == []
    take_leases(uav_ids=[uav.pk], holder="two/1", lease_s=10.0)
    (abort,) = claim_commands(holder="two/1", **claimed)
    assert (abort.uav_id, abort.attempts) == (uav.pk, 2)
    assert list(renew_claims(holder="one/1", lease_s=10.0)) == [command.pk for command in for_them if command.uav_id == other.pk]


def test_a_vehicle_that_says_too_much_keeps_to_its_room():
    session = Session(KnownUav(1, 1, "Tern", 7, True, None, None), deque(), link_id=1)
    session.serve(Lease(1, {}, [], {}, ""), time.monotonic() + 60.0)
    writer, peer = FrameWriter(7, 1), SimpleNamespace(name="udp", send=lambda _: None)
    in_mission = mavlink.MAVLink_heartbeat_message(2, mavlink.MAV_AUTOPILOT_PX4, 1 | 128, MISSION, 4, 3)
    messages = [in_mission, mavlink.MAVLink_extended_sys_state_message(0, IN_AIR)]
    messages += [mavlink.MAVLink_mission_item_reached_message(number % 7) for number in range(500)]
    messages += [mavlink.MAVLink_param_value_message(f"P{number}".encode(), 1.0, 9, 1, 0) for number in range(MAX_PARAMETERS + 50)]
    for message in messages:
        for frame in frames_of_datagram(writer.frame_of(message, 0.0), Counter()):
            session.receive(frame, peer, time.time())
    assert [flown.item for flown in session.flown] == [0, 499 % 7], "the first, which may be being told, and the last"
    assert len(session.state.parameters) == MAX_PARAMETERS


def test_one_that_sends_far_too_much_takes_no_room_from_the_others():
    records = [SimpleNamespace(uav_id=1 if number % 10 else 2, number=number) for number in range(100)]
    store = Store(None, "one/1", 50, list, lambda _: None, records=deque(records))
    store._drop_overflow()
    kept = {uav_id: [record.number for record in store.records if record.uav_id == uav_id] for uav_id in (1, 2)}
    assert kept == {1: [number for number in range(100) if number % 10][-40:], 2: list(range(0, 100, 10))}
    assert store.lost == 50


def test_a_clock_that_was_set_back_makes_nobody_wait_for_it():
    session = Session(KnownUav(1, 1, "Tern", 7, True, None, None), deque(), link_id=1)
    session.serve(Lease(1, {}, [], {}, ""), time.monotonic() + 60.0)
    first, other = (SimpleNamespace(name=name, send=lambda _: None) for name in ("first", "other"))
    writer, now_s = FrameWriter(7, 1), time.time()

    def feed(peer, at_s: float) -> None:
        for frame in frames_of_datagram(writer.frame_of(mavlink.MAVLink_heartbeat_message(2, 3, 1, 0, 3, 3), 0.0), Counter()):
            session.receive(frame, peer, at_s)

    feed(first, now_s)
    assert session.is_served(now_s, 5.0)
    hour_ago_s = now_s - 3_600.0
    assert not session.is_served(hour_ago_s, 5.0), "nobody knows how long ago it was heard"
    feed(other, hour_ago_s)
    assert session.peer is other and not session.losses, "the first one may have been silent for long"


@pytest.mark.django_db
@pytest.mark.parametrize(
    ("facts", "reported"), [({"is_in_air": True}, [FlownMissionItem(6, is_reached=False, is_down=True)]), ({"is_in_air": False}, [])]
)
def test_a_flight_ends_though_the_gateway_that_saw_it_was_killed_before(facts, reported):
    uav = unsigned_uav(7)
    UavLink.objects.create(uav=uav, mode="AUTO", is_armed=True, **facts)
    (lease,) = take_leases(uav_ids=[uav.pk], holder="one/2", lease_s=10.0)
    session = Session(KnownUav(uav.pk, uav.organisation_id, uav.name, 7, True, None, None), deque(), link_id=1)
    session.serve(lease, time.monotonic() + 60.0)
    writer, peer = FrameWriter(7, 1), SimpleNamespace(name="udp", send=lambda _: None)
    landed = mavlink.MAVLink_extended_sys_state_message(0, ON_GROUND)
    for message in (mavlink.MAVLink_mission_current_message(7), landed, mavlink.MAVLink_heartbeat_message(2, 3, 1, 3, 3, 3), landed):
        for frame in frames_of_datagram(writer.frame_of(message, 0.0), Counter()):
            session.receive(frame, peer, time.time())
    assert session.flown == reported


def test_a_vehicle_that_comes_back_must_say_how_it_is_before_anything_is_sent(monkeypatch):
    """It may have been armed meanwhile: a new list would change where it flies."""
    session = Session(KnownUav(1, 1, "Tern", 7, True, None, None), deque(), link_id=1)
    session.serve(Lease(1, {}, [], {}, ""), time.monotonic() + 3_600.0)
    writer, peer, began_s = FrameWriter(7, 1), SimpleNamespace(name="udp", send=lambda _: None), time.monotonic()
    heartbeat = mavlink.MAVLink_heartbeat_message(2, 3, 1, 0, 3, 3)
    attitude = mavlink.MAVLink_attitude_message(1_000, 0, 0, 0, 0, 0, 0)
    for at_s, message, is_served in ((0.0, heartbeat, True), (600.0, attitude, False), (600.5, heartbeat, True)):
        monkeypatch.setattr(time, "monotonic", lambda at_s=at_s: began_s + at_s)
        for frame in frames_of_datagram(writer.frame_of(message, 0.0), Counter()):
            session.receive(frame, peer, 1.7e9 + at_s)
        assert session.is_served(1.7e9 + at_s, 5.0) is is_served
