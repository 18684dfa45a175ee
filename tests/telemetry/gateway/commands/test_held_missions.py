"""Somebody holds the row of a mission for long, to look whether it may still be flown: no UAV waits for that."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from django.db import connections, transaction
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.models import CommandKind, CommandState, Mission, Uav, UavCommand
from missions.services.approval.approval import locked_mission
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import dispatch_mission
from telemetry.gateway.process import Gateway
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import UAV_AT, world
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.station import gateway_at_work, port_of, unsigned_uav, wait_for
from tests.telemetry.vehicles.px4 import HOLD, Px4

pytestmark = pytest.mark.django_db(transaction=True)
LONGER_THAN_A_LEASE_IS_SURE_S = 5.0


@contextmanager
def held(mission: Mission) -> Iterator[None]:
    """By another transaction."""
    is_held, over = threading.Event(), threading.Event()

    def hold() -> None:
        with transaction.atomic():
            locked_mission(mission.pk, None)
            is_held.set()
            over.wait(30)
        connections.close_all()

    thread = threading.Thread(target=hold)
    thread.start()
    try:
        assert is_held.wait(10)
        yield
    finally:
        over.set()
        thread.join(10)


def applied(command: UavCommand) -> bool:
    return UavCommand.objects.filter(pk=command.pk, state=CommandState.APPLIED).exists()


@pytest.mark.long
def test_no_uav_waits_while_a_mission_is_held(settings, tmp_path):
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    author, uav, other = a_user(), unsigned_uav(7, is_simulated=True), unsigned_uav(8, is_simulated=True)
    ground(tmp_path / "hill.tif", 100.0)
    mission, approval = approved(author, [uav], world().towers[:2])
    flying, beside = Px4(7), Px4(8, is_armed=True, is_in_air=True)
    with (
        gateway_at_work(tmp_path) as gateway,
        Flyer(flying, port_of(gateway), at=UAV_AT, altitude_amsl_m=101.0) as voice,
        Flyer(beside, port_of(gateway)),
    ):
        start_flight(uav, mission, approval, gateway)
        with held(mission):
            began_s = time.monotonic()
            voice.report(mavlink.MAVLink_mission_item_reached_message(1))
            hold = queue_command(uav=uav, kind=CommandKind.HOLD, actor=None, mission=mission, approval=approval)
            wait_for(lambda: flying.sub_mode == HOLD, "the hold")
            assert not applied(hold), "its end waits for the mission"
            for kind in (CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND, CommandKind.ABORT):
                command = queue_command(uav=other, kind=kind, actor=None)
                wait_for(lambda command=command: applied(command), f"{kind} of the other UAV", patience_s=8)
            time.sleep(max(0.0, began_s + LONGER_THAN_A_LEASE_IS_SURE_S - time.monotonic()))
            assert all(session.is_held for session in gateway.sessions.values())
        wait_for(lambda: applied(hold), "the end of the hold")


def start_flight(uav: Uav, mission: Mission, approval: object, gateway: Gateway) -> None:
    (upload,) = dispatch_mission(mission=mission, actor=mission.author)
    wait_for(lambda: applied(upload), "the upload")
    start = queue_command(uav=uav, kind=CommandKind.START, actor=None, mission=mission, approval=approval, parameters={"flight": 1})
    wait_for(lambda: applied(start), "the start")
    wait_for(lambda: gateway.sessions[7].state.is_in_air, "that it is seen in the air")
