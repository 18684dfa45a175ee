"""UAVs know one address, behind which several gateways stand: one that loses its gateway does nothing, and is served by another one."""

import signal
from contextlib import ExitStack

import pytest

from missions.models import CommandKind, CommandState, Uav, UavCommand
from missions.services.commands.commands import queue_command
from telemetry.models import TelemetryRecord, TelemetryStream, UavLink
from tests.accounts.users import a_user
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.one_address import Backend, OneAddress
from tests.telemetry.gateway.program import free_port, gateway_program
from tests.telemetry.gateway.station import signed_uav, wait_for
from tests.telemetry.vehicles.px4 import Px4

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

TIMEOUT_S = 180.0
NAMES = ("one", "two")


def holder_of(uav: Uav) -> str:
    """The name of the gateway that serves it."""
    return UavLink.objects.filter(uav=uav).values_list("holder", flat=True).first() or ""


def newest(uav: Uav) -> int:
    return TelemetryRecord.objects.filter(uav=uav).order_by("-sequence").values_list("sequence", flat=True).first() or 0


def is_applied(command: UavCommand) -> bool:
    command.refresh_from_db()
    assert command.state not in (CommandState.FAILED, CommandState.EXPIRED), command.outcome
    return command.state == CommandState.APPLIED


def test_a_uav_whose_gateway_is_killed_is_served_by_another_one_behind_the_same_address(tmp_path):
    """Two of them, one on each gateway; both are with the one that is left in the end, with the commands that were on their way."""
    uavs, vehicles = [], []
    for system in (7, 8):
        uav, key = signed_uav(system, a_user())
        uavs.append(uav)
        vehicles.append((Px4(system, is_armed=True, is_in_air=True), key))
    with ExitStack() as running:
        ports = [free_port() for _ in NAMES]
        programs = [running.enter_context(gateway_program(port, tmp_path, name=name)) for port, name in zip(ports, NAMES, strict=True)]
        backends = [Backend(port) for port in ports]
        address = running.enter_context(OneAddress(backends))
        for vehicle, key in vehicles:
            running.enter_context(Flyer(vehicle, address.port, key=key))
        wait_for(lambda: {holder_of(uav).partition("/")[0] for uav in uavs} == set(NAMES), "each has one", patience_s=TIMEOUT_S)
        lost = next(uav for uav in uavs if holder_of(uav).startswith("one/"))
        stays = next(uav for uav in uavs if uav.pk != lost.pk)
        wait_for(lambda: newest(lost) and newest(stays), "both report", patience_s=TIMEOUT_S)

        programs[0].send_signal(signal.SIGKILL)
        programs[0].wait()
        hold = queue_command(uav=lost, kind=CommandKind.HOLD, actor=None)
        before, before_of_other = newest(lost), newest(stays)
        backends[0].is_there = False  # its pod is not ready any more
        wait_for(lambda: holder_of(lost).startswith("two/"), "the other one serves it", patience_s=TIMEOUT_S)
        wait_for(lambda: newest(lost) > before and newest(stays) > before_of_other, "both report", patience_s=TIMEOUT_S)
        wait_for(lambda: is_applied(hold), "the command", patience_s=TIMEOUT_S)
    for uav in uavs:
        sequences = list(TelemetryRecord.objects.filter(uav=uav).values_list("sequence", flat=True))
        assert len(sequences) == len(set(sequences)), "each once"
        assert TelemetryStream.objects.filter(uav=uav).count() == 1, "one flight, by whichever gateway"
