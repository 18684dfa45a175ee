"""Many commands over bad links, with gateways that are killed: each ends, in its order, and what is urgent hardly waits."""

import random
import signal
import socket
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import pytest
from django.db.models import QuerySet

from mavlink.frames import frames_of_datagram, message_of
from mavlink.signing import FrameWriter
from missions.models import OPEN_COMMANDS, CommandKind, CommandPriority, CommandState, Uav, UavCommand
from missions.services.commands.commands import queue_command
from tests.telemetry.gateway.program import free_port, gateway_program
from tests.telemetry.gateway.station import gateway_at_work, port_of, position, unsigned_uav, wait_for
from tests.telemetry.vehicles.px4 import Px4

pytestmark = pytest.mark.django_db(transaction=True)

LOSS = 0.3
KILLS = 5
UAVS = 40
WANTED_FOR_S = 3_600.0
MAX_DURATION_S = 420.0
UAVS_IN_OVERLOAD = 160
LIFE_S = 12.0
URGENT = (CommandKind.HOLD, CommandKind.RETURN)


@dataclass
class Fleet:
    """Scripted vehicles on one socket, in one thread; a share of messages gets lost, each way."""

    port: int
    systems: list[int]
    vehicles: dict[int, Px4] = field(default_factory=dict)

    def __enter__(self) -> "Fleet":
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", self.port))
        self._socket.setblocking(False)
        self._chance = random.Random(7)
        self._writers = {system: FrameWriter(system, 1) for system in self.systems}
        self.vehicles = {system: Px4(system, heartbeats=True, is_armed=True, is_in_air=True) for system in self.systems}
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="fleet")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(10)
        self._socket.close()

    def _run(self) -> None:
        began_s = time.monotonic()
        next_s = 0.0
        while not self._ends.wait(0.01):
            now_s = time.monotonic()
            for message in self._received():
                vehicle = self.vehicles.get(getattr(message, "target_system", 0))
                if vehicle is not None and self._chance.random() >= LOSS:
                    self._send(vehicle, vehicle.receive(message, now_s))
            reports = now_s >= next_s
            next_s = now_s + 1.0 if reports else next_s
            for vehicle in self.vehicles.values():
                self._send(vehicle, vehicle.tick(now_s))
                if reports:
                    self._send(vehicle, [position(int((now_s - began_s) * 1000))])

    def _received(self) -> list[Any]:
        messages = []
        while True:
            try:
                datagram = self._socket.recv(65_535)
            except (BlockingIOError, ConnectionError):
                return [message for message in messages if message is not None]
            messages += [message_of(frame) for frame in frames_of_datagram(datagram, Counter())]

    def _send(self, vehicle: Px4, messages: list[Any]) -> None:
        for message in messages:
            if self._chance.random() >= LOSS:
                try:
                    self._socket.send(self._writers[vehicle.system].frame_of(message, 0.0))
                except (BlockingIOError, ConnectionError):
                    continue


def give(uav: Uav, chance: random.Random) -> UavCommand:
    """One in twenty is urgent; speeds tell which command they are of."""
    share = chance.random()
    if share < 0.05:
        kind, parameters = chance.choice([CommandKind.HOLD, CommandKind.RETURN]), {}
        if is_open().filter(uav=uav, kind=CommandKind.RETURN).exists():
            kind = CommandKind.RETURN  # nothing less takes its place
    elif share < 0.3:
        kind, parameters = CommandKind.CLEAR_MISSION, {}
    else:
        given = UavCommand.objects.filter(uav=uav).count()
        kind, parameters = CommandKind.CHANGE_SPEED, {"speed_mps": 1.0 + given / 1_000}
    return queue_command(uav=uav, kind=kind, actor=None, parameters=parameters, expires_in_s=WANTED_FOR_S)


def is_open() -> QuerySet[UavCommand]:
    return UavCommand.objects.filter(state__in=OPEN_COMMANDS)


def percentile(values: list[float], share: float) -> float:
    return sorted(values)[min(int(len(values) * share), len(values) - 1)]


@pytest.mark.long
@pytest.mark.parametrize("number", [1_000, 300])
def test_commands_over_bad_links_and_killed_gateways(number, tmp_path):
    uavs = [unsigned_uav(system) for system in range(1, UAVS + 1)]
    chance, port = random.Random(number), free_port()
    kill_after = [(kill + 1) * number // (KILLS + 1) for kill in range(KILLS)]
    given = 0
    with Fleet(port, [uav.mavlink_system_id for uav in uavs]) as fleet:
        for end in [*kill_after, number]:
            with gateway_program(port, tmp_path, name="storm") as program:
                while given < end:
                    give(chance.choice(uavs), chance)
                    given += 1
                    time.sleep(0.01)
                if end != number:
                    program.send_signal(signal.SIGKILL)
                    program.wait()
                    continue
                wait_for(lambda: not is_open().exclude(kind=CommandKind.CLEAR_MISSION).exists(), "all orders", patience_s=MAX_DURATION_S)
                for vehicle in fleet.vehicles.values():  # what flies keeps its mission
                    vehicle.is_armed = vehicle.is_in_air = False
                wait_for(lambda: not is_open().exists(), "all missions to be off", patience_s=MAX_DURATION_S)
        taken = {system: list(vehicle.taken) for system, vehicle in fleet.vehicles.items()}
    ends = Counter(UavCommand.objects.values_list("state", "outcome_code"))
    assert sum(ends.values()) == number
    reported = {(CommandState.APPLIED, ""), (CommandState.EXPIRED, "superseded")}
    assert set(ends) <= reported, ends
    in_order(uavs, taken)


@pytest.mark.long
def test_what_is_urgent_hardly_waits_though_gateways_are_killed(tmp_path, monkeypatch, record_property):
    """A gateway that may carry two commands at once is killed five times; all the time more speeds are wanted than it can bring.

    The waits are those of the people who gave the commands, from given to done: the time in which no gateway runs is in all of them.
    """
    monkeypatch.setenv("SPANWISE_GATEWAY_MAX_COMMANDS", "2")
    uavs = [unsigned_uav(system) for system in range(1, UAVS_IN_OVERLOAD + 1)]
    chance, port, given = random.Random(11), free_port(), 0
    with Fleet(port, [uav.mavlink_system_id for uav in uavs]) as fleet:
        for uav in uavs:
            speed(uav)
        for life in range(KILLS + 1):
            with gateway_program(port, tmp_path, name="storm") as program:
                until_s = time.monotonic() + LIFE_S
                while time.monotonic() < until_s:
                    time.sleep(0.25)
                    urgent(chance.choice(uavs), chance)
                    given += 1
                if life < KILLS:
                    program.send_signal(signal.SIGKILL)
                    program.wait()
                    urgent(chance.choice(uavs), chance)  # while nobody is there
                    given += 1
                else:
                    wait_for(lambda: not is_open().exists(), "all commands", patience_s=MAX_DURATION_S)
        taken = {system: list(vehicle.taken) for system, vehicle in fleet.vehicles.items()}
    reported = {(CommandState.APPLIED, ""), (CommandState.EXPIRED, "superseded")}
    assert set(UavCommand.objects.values_list("state", "outcome_code")) <= reported
    assert UavCommand.objects.count() == given + len(uavs)
    in_order(uavs, taken)
    top, lowest = (p99_wait_s(priority) for priority in (CommandPriority.SAFETY, CommandPriority.PARAMETER))
    record_property("figure", f"with {KILLS} kills: p99 {top:.1f} s and {lowest:.1f} s, {top / lowest:.1%}")
    print(f"p99 from given to done, {given} urgent, {len(uavs)} speeds, {KILLS} kills: {top:.1f} s and {lowest:.1f} s, {top / lowest:.1%}")
    assert top <= 0.1 * lowest


def speed(uav: Uav) -> None:
    queue_command(uav=uav, kind=CommandKind.CHANGE_SPEED, actor=None, parameters={"speed_mps": 5.0}, expires_in_s=WANTED_FOR_S)


def urgent(uav: Uav, chance: random.Random) -> None:
    kind = CommandKind.RETURN if is_open().filter(uav=uav, kind=CommandKind.RETURN).exists() else chance.choice(URGENT)
    queue_command(uav=uav, kind=kind, actor=None, expires_in_s=WANTED_FOR_S)


def p99_wait_s(priority: CommandPriority) -> float:
    done = UavCommand.objects.filter(priority=priority, state=CommandState.APPLIED)
    return percentile([(finished - given).total_seconds() for given, finished in done.values_list("created_at", "finished_at")], 0.99)


@pytest.mark.long
def test_what_is_urgent_hardly_waits_under_overload(tmp_path, settings, record_property):
    """Of a gateway that can do four things at once forty speeds are wanted; now and then a UAV must hold."""
    settings.GATEWAY_MAX_COMMANDS = 4
    uavs = [unsigned_uav(system) for system in range(1, UAVS + 1)]
    with gateway_at_work(tmp_path) as gateway, Fleet(port_of(gateway), [uav.mavlink_system_id for uav in uavs]):
        wait_for(lambda: len(gateway.sessions) == UAVS and all(session.state.autopilot_type for session in gateway.sessions.values()))
        for uav in uavs:
            queue_command(uav=uav, kind=CommandKind.CHANGE_SPEED, actor=None, parameters={"speed_mps": 5.0}, expires_in_s=WANTED_FOR_S)
        for uav in uavs[::4]:
            time.sleep(0.3)
            queue_command(uav=uav, kind=CommandKind.HOLD, actor=None)
        wait_for(lambda: not UavCommand.objects.filter(state__in=OPEN_COMMANDS).exists(), "all commands", patience_s=120)
    waits = {
        priority: percentile([(command.sent_at - command.created_at).total_seconds() for command in commands], 0.99)
        for priority in (CommandPriority.SAFETY, CommandPriority.PARAMETER)
        if (commands := UavCommand.objects.filter(priority=priority, state=CommandState.APPLIED))
    }
    record_property("figure", f"p99 of sending {waits[CommandPriority.SAFETY]:.2f} s and {waits[CommandPriority.PARAMETER]:.2f} s")
    assert waits[CommandPriority.SAFETY] <= 0.1 * waits[CommandPriority.PARAMETER], waits


def in_order(uavs: list[Uav], taken: dict[int, list]) -> None:
    """No vehicle took a speed that had been replaced, and each ended with the last that was applied."""
    for uav in uavs:
        speeds = [values[1] for command, values in taken[uav.mavlink_system_id] if command == 178]
        assert speeds == sorted(speeds), f"{uav}: an older speed after a newer one"
        applied = UavCommand.objects.filter(uav=uav, kind=CommandKind.CHANGE_SPEED, state=CommandState.APPLIED)
        for command in applied:
            assert any(abs(speed - command.parameters["speed_mps"]) < 1e-4 for speed in speeds), f"{command} was never taken"
