"""Commands under overload, over a link that loses, by carriers that are killed: none is lost, none is applied out of order."""

import json
import random
import socket
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from datetime import timedelta
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.geos import Point

from missions.models import OPEN_COMMANDS, CommandKind, CommandPriority, CommandState, Uav, UavCommand
from missions.services.commands.commands import queue_command
from missions.services.commands.refused import Refused
from tests.accounts.users import a_user
from tests.telemetry.links.command_carriers import Link, nursery

pytestmark = pytest.mark.django_db(transaction=True)

LOSS = 0.3
SLOTS = 2
KILLS = 5
DEADLINE_S = 600
WANTED_S = 3_600.0
SAFETY = (CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND, CommandKind.ABORT)


class Vehicles:
    """All vehicles in one: do what they hear, in the order in which they hear it, and acknowledge; some of that is lost."""

    def __init__(self, ear: socket.socket, seed: int) -> None:
        self.applied: list[tuple[int, str, int, str]] = []  # UAV, axis, sequence, command
        self._ear = ear
        self._chance = random.Random(seed)

    def listen(self) -> None:
        while True:
            data, sender = self._ear.recvfrom(1_000)
            if data == b"over":
                return
            reported = json.loads(data)
            self.applied.append((reported["uav"], reported["axis"], reported["sequence"], reported["command"]))
            if self._chance.random() >= LOSS:
                self._ear.sendto(reported["command"].encode(), sender)


@contextmanager
def vehicles(seed: int) -> Iterator[tuple[Vehicles, Link]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(("127.0.0.1", 0))
        port = ear.getsockname()[1]
        all_of_them = Vehicles(ear, seed)
        thread = threading.Thread(target=all_of_them.listen, daemon=True)
        thread.start()
        try:
            yield all_of_them, Link(port, LOSS)
        finally:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as voice:
                voice.sendto(b"over", ("127.0.0.1", port))
            thread.join(timeout=10)


def fleet_of(count: int) -> list[Uav]:
    place = Point(10.0, 56.0, srid=4326)
    return Uav.objects.bulk_create(Uav(name=f"Kite {number}", location=place) for number in range(count))


def wait_until(is_so: Callable[[], bool], deadline_s: float) -> None:
    ends_s = time.monotonic() + deadline_s
    while not is_so():
        assert time.monotonic() < ends_s, "not in time"
        time.sleep(0.005)


def all_have_ended() -> bool:
    return not UavCommand.objects.filter(state__in=OPEN_COMMANDS).exists()


def kinds_of(count: int, chance: random.Random) -> tuple[list[CommandKind], list[CommandKind]]:
    """A backlog without urgent ones, and what comes while it is worked off: of all a fifth is urgent, half is of the lowest priority."""
    urgent = [chance.choice(SAFETY[:3]) if chance.random() < 0.95 else CommandKind.ABORT for _ in range(count // 5)]
    lowest = [CommandKind.CHANGE_SPEED] * (count // 2)
    between = [CommandKind.CLEAR_MISSION] * (count - len(urgent) - len(lowest))
    calm = lowest + between
    chance.shuffle(calm)
    split = len(calm) * 3 // 4
    later = calm[split:] + urgent
    chance.shuffle(later)
    return calm[:split], later


@pytest.mark.long
@pytest.mark.parametrize("count", [1_000, 10_000])
def test_no_command_is_lost_or_applied_out_of_order_and_the_urgent_wait_least(
    count: int, capsys: pytest.CaptureFixture[str], record_property: Any
) -> None:
    chance, person = random.Random(count), a_user()
    uavs = fleet_of(count // 2)
    backlog, later = kinds_of(count, chance)
    slots = [[uav.pk for uav in uavs[slot::SLOTS]] for slot in range(SLOTS)]

    def give(kind: CommandKind) -> None:
        """To any UAV that nothing safer waits for."""
        while True:
            with suppress(Refused):
                queue_command(uav=chance.choice(uavs), kind=kind, actor=person, expires_in_s=WANTED_S)
                return

    for kind in backlog:
        give(kind)
    kill_at = [count * (number + 1) // (KILLS + 2) for number in range(KILLS)]
    with vehicles(seed=7) as (received, link), nursery(slots, link) as carriers:
        for slot in range(SLOTS):
            carriers.start(slot)
        for number, kind in enumerate(later):
            wait_until(lambda number=number: len(received.applied) >= number or all_have_ended(), DEADLINE_S)  # as fast as they are carried
            give(kind)
            if kill_at and len(received.applied) >= kill_at[0]:
                carriers.kill(number % SLOTS)
                kill_at.pop(0)
        while kill_at:
            wait_until(
                lambda: len(received.applied) >= kill_at[0] or not UavCommand.objects.filter(state__in=OPEN_COMMANDS).exists(), DEADLINE_S
            )
            carriers.kill(len(kill_at) % SLOTS)
            kill_at.pop(0)
        wait_until(all_have_ended, DEADLINE_S)

    assert UavCommand.objects.count() == count
    none_is_lost(received)
    nothing_is_applied_out_of_order(received)
    every_step_is_reported()
    top, lowest = (wait_p99_s(priority) for priority in (CommandPriority.SAFETY, CommandPriority.PARAMETER))
    states = defaultdict(int)
    for state in UavCommand.objects.values_list("state", flat=True):
        states[str(state)] += 1
    record_property("figure", f"{count:,} commands: p99 {top:.2f} s and {lowest:.2f} s, {top / lowest:.1%}")
    with capsys.disabled():
        print(f"\n{count} commands, {KILLS} kills, {LOSS:.0%} loss each way: {dict(states)}; {len(received.applied)} datagrams heard;")
        print(f"p99 from given to applied: top {top:.2f} s, lowest {lowest:.2f} s: {top / lowest:.1%}")
    assert top <= 0.1 * lowest


def none_is_lost(received: Vehicles) -> None:
    """Each was applied, or a later one took its place; what was applied was heard by its vehicle."""
    known = {command for *_rest, command in received.applied}
    for command in UavCommand.objects.all():
        if command.state == CommandState.APPLIED:
            assert str(command.pk) in known
        else:
            assert (command.state, command.outcome_code) == (CommandState.EXPIRED, "superseded")
            later = UavCommand.objects.filter(uav=command.uav_id, sequence__gt=command.sequence)
            assert later.filter(axis=command.axis).exists() or later.filter(kind=CommandKind.ABORT).exists()
    for uav, axis in UavCommand.objects.values_list("uav", "axis").distinct():
        last = UavCommand.objects.filter(uav=uav, axis=axis).latest("sequence")
        overtaken = UavCommand.objects.filter(uav=uav, kind=CommandKind.ABORT, sequence__gt=last.sequence).exists()
        assert last.state == CommandState.APPLIED or overtaken


def nothing_is_applied_out_of_order(received: Vehicles) -> None:
    by_axis: dict[tuple[int, str], list[int]] = defaultdict(list)
    for uav, axis, sequence, _command in received.applied:
        by_axis[uav, axis].append(sequence)
    for sequences in by_axis.values():
        assert sequences == sorted(sequences)


def every_step_is_reported() -> None:
    for command in UavCommand.objects.prefetch_related("events"):
        states = [event.state for event in command.events.all()]
        assert states[0] == CommandState.QUEUED
        assert states[-1] == command.state
        if command.state == CommandState.APPLIED:
            assert CommandState.SENT in states


def wait_p99_s(priority: CommandPriority) -> float:
    applied = UavCommand.objects.filter(priority=priority, state=CommandState.APPLIED)
    waits = [finished - given for given, finished in applied.values_list("created_at", "finished_at")]
    return float(np.percentile([wait / timedelta(seconds=1) for wait in waits], 99))
