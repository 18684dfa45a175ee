"""Carriers of commands as processes of their own, over a link that loses: what a gateway is to the outbox, and nothing more.

Run as a program it is their nursery: it loads Django once and forks a carrier for each line "slot seed" that it reads, so that a carrier
that was killed has a successor at once. Each carrier serves the UAVs of its slot, one command at a time, and renews nothing: a lease
outlives the time that a command takes.
"""

import json
import os
import random
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

LEASE_S = 1.0
AT_ONCE = 2  # commands that are claimed together: those of a carrier that dies wait for the lease
TRIES = 40
ACK_WAIT_S = 0.01
IDLE_S = 0.02


@dataclass(frozen=True)
class Link:
    """Where the vehicles listen, and the share of datagrams that is lost each way."""

    port: int
    loss: float


def carry(uav_ids: Sequence[int], link: Link, holder: str, chance: random.Random) -> None:
    """For ever: the most urgent commands to these UAVs, until each was acknowledged."""
    from missions.services.commands.commands import claim_commands  # noqa: PLC0415 - Django is set up by then

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as radio:
        radio.connect(("127.0.0.1", link.port))
        while True:
            claimed = claim_commands(uav_ids=uav_ids, holder=holder, lease_s=LEASE_S, limit=AT_ONCE)
            for command in claimed:
                _bring(command, radio, link, chance)
            if not claimed:
                radio.settimeout(IDLE_S)
                _received(radio, None)


def _bring(command: object, radio: socket.socket, link: Link, chance: random.Random) -> None:
    from missions.services.commands.commands import note_acknowledged, note_applied, note_released, note_sent  # noqa: PLC0415

    fence = {"attempt": command.attempts, "holder": command.holder}
    reported = {"command": str(command.pk), "uav": command.uav_id, "axis": command.axis, "sequence": command.sequence, "kind": command.kind}
    radio.settimeout(ACK_WAIT_S)
    for number in range(TRIES):
        if number == 0 and not note_sent(command.pk, **fence):
            return  # overtaken since it was claimed
        if number % 5 == 4 and not _is_held(command):
            return
        if chance.random() >= link.loss:
            radio.send(json.dumps(reported).encode())
        if _received(radio, reported["command"]):
            if note_acknowledged(command.pk, **fence):
                note_applied(command.pk, **fence)
            return
    note_released(command.pk, **fence, note="Not acknowledged")


def _is_held(command: object) -> bool:
    from missions.models import OPEN_COMMANDS, UavCommand  # noqa: PLC0415

    return UavCommand.objects.filter(pk=command.pk, attempts=command.attempts, holder=command.holder, state__in=OPEN_COMMANDS).exists()


def _received(radio: socket.socket, command: str | None) -> bool:
    """Whether the acknowledgement of this command came in time; late ones of others are passed over."""
    try:
        while True:
            if radio.recv(1_000).decode() == command:
                return True
    except (TimeoutError, ConnectionRefusedError):
        return False


class Nursery:
    """From which carriers come, by slot; see below."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self._generation = 0
        self.pids: dict[int, int] = {}

    def start(self, slot: int) -> None:
        self._generation += 1
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(f"{slot} {self._generation}\n")
        self._process.stdin.flush()
        self.pids[slot] = int(self._process.stdout.readline())

    def kill(self, slot: int) -> None:
        """As kill -9 does; a successor is started at once."""
        os.kill(self.pids[slot], signal.SIGKILL)
        self.start(slot)


@contextmanager
def nursery(slots: Sequence[Sequence[int]], link: Link) -> Iterator[Nursery]:
    """uav ids by slot. All carriers are killed in the end."""
    from django.db import connection  # noqa: PLC0415

    facts = connection.settings_dict
    port = f":{facts['PORT']}" if facts["PORT"] else ""
    password = f":{quote(facts['PASSWORD'], safe='')}" if facts["PASSWORD"] else ""
    address = f"postgres://{facts['USER']}{password}@{quote(facts['HOST'], safe='')}{port}/{facts['NAME']}"
    root = Path(__file__).resolve().parents[3]
    environment = os.environ | {"DATABASE_URL": address, "DJANGO_SETTINGS_MODULE": "config.settings", "PYTHONPATH": str(root)}
    reported = json.dumps([list(slot) for slot in slots]), str(link.port), str(link.loss)
    process = subprocess.Popen(  # noqa: S603
        [sys.executable, "-m", "tests.telemetry.links.command_carriers", *reported],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment, cwd=root,
    )  # fmt: skip
    try:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        yield Nursery(process)
    finally:
        assert process.stdin is not None
        process.stdin.close()  # at which the nursery kills its own
        process.wait(timeout=30)


def _main() -> None:
    import django  # noqa: PLC0415

    django.setup()
    import missions.services.commands.commands  # noqa: PLC0415, F401 - loaded once for all

    slots, link = json.loads(sys.argv[1]), Link(int(sys.argv[2]), float(sys.argv[3]))
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for those that were killed
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    children = []
    for line in iter(sys.stdin.readline, ""):
        slot, seed = map(int, line.split())
        child = os.fork()
        if child == 0:
            os.close(0)
            carry(slots[slot], link, f"carrier-{slot}-{seed}", random.Random(seed))
        children.append(child)
        sys.stdout.write(f"{child}\n")
        sys.stdout.flush()
    for child in children:
        try:
            os.kill(child, signal.SIGKILL)
        except ProcessLookupError:
            continue


if __name__ == "__main__":
    _main()
