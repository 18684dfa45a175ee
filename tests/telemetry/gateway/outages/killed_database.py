"""A program: a gateway stores and carries while its PostgreSQL is killed with all its processes, again and again; then both are compared.

Run with DATABASE_URL at a cluster of its own, whose files are in the folder that is given; tells one line of JSON.
"""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import Any

import django
from django.core.management import call_command
from django.db import Error, connection

from scripts.installation.database_cluster import wait_for_database
from scripts.places import Places
from scripts.supervision.processes import end_processes
from scripts.supervision.programs import database_server

KILLS, UAVS = 3, 5
BEFORE_KILL_S, AWAY_S = 5.0, 2.0


class Cluster:
    def __init__(self, places: Places, sockets: Path) -> None:
        self._program, self._sockets = database_server(places, sockets), sockets
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        for stale in self._program.stale_files:
            stale.unlink(missing_ok=True)
        user = {"user": self._program.user, "extra_groups": []} if self._program.user else {}
        self._process = subprocess.Popen(self._program.command, cwd=self._program.folder, stderr=subprocess.DEVNULL, **user)  # noqa: S603
        wait_for_database(self._sockets)

    def kill(self) -> None:
        """All of its processes at once: what was not on the disk is gone."""
        end_processes([self._program.folder], first_signal=signal.SIGKILL)
        if self._process is not None:
            self._process.wait()


def main(places: Places, sockets: Path) -> dict[str, Any]:
    cluster = Cluster(places, sockets)
    cluster.start()
    try:
        django.setup()
        call_command("migrate", verbosity=0)
        return _played(cluster, places.state)
    finally:
        cluster.kill()


def _played(cluster: Cluster, folder: Path) -> dict[str, Any]:
    from missions.models import OPEN_COMMANDS, CommandKind, CommandState, UavCommand  # noqa: PLC0415 - Django is set up by now
    from missions.services.commands.commands import queue_command  # noqa: PLC0415
    from telemetry.models import TelemetryRecord  # noqa: PLC0415
    from tests.telemetry.gateway.flyer import Flyer  # noqa: PLC0415
    from tests.telemetry.gateway.program import free_port, gateway_program  # noqa: PLC0415
    from tests.telemetry.gateway.station import unsigned_uav, wait_for  # noqa: PLC0415
    from tests.telemetry.vehicles.px4 import Px4  # noqa: PLC0415

    class Reporter(Flyer):
        """Remembers what it has told of its places."""

        def _reports(self, now_s: float) -> list[Any]:
            reported = super()._reports(now_s)
            self.reported = [*getattr(self, "reported", []), reported[0].time_boot_ms]
            return reported

    chance, port = random.Random(5), free_port()
    uavs = [unsigned_uav(system) for system in range(1, UAVS + 1)]
    given, stored = [], set()
    with gateway_program(port, folder, name="killed") as program:
        flyers = [Reporter(Px4(uav.mavlink_system_id, is_armed=True, is_in_air=True), port) for uav in uavs]
        for flyer in flyers:
            flyer.__enter__()
        try:
            for kill in range(KILLS + 1):
                until_s = time.monotonic() + BEFORE_KILL_S
                while time.monotonic() < until_s:
                    uav, number = chance.choice(uavs), len(given)
                    kind = chance.choice([CommandKind.CHANGE_SPEED, CommandKind.CHANGE_SPEED, CommandKind.HOLD])
                    parameters = {"speed_mps": 1.0 + number / 1_000} if kind == CommandKind.CHANGE_SPEED else {}
                    given.append(queue_command(uav=uav, kind=kind, actor=None, parameters=parameters, expires_in_s=3_600).pk)
                    time.sleep(chance.uniform(0.0, 0.04))
                stored |= set(TelemetryRecord.objects.values_list("uav_id", "sequence"))
                if kill < KILLS:
                    cluster.kill()
                    time.sleep(AWAY_S)
                    cluster.start()
                    connection.close()
                    with suppress(Error):
                        connection.ensure_connection()
            wait_for(lambda: not UavCommand.objects.filter(state__in=OPEN_COMMANDS).exists(), "the end of all commands", patience_s=120)
        finally:
            for flyer in flyers:
                flyer.__exit__()
        reported = {(uav.pk, boot_ms) for uav, flyer in zip(uavs, flyers, strict=True) for boot_ms in flyer.reported}
        wait_for(lambda: TelemetryRecord.objects.count() >= len(reported), "all records", patience_s=30)
        assert program.poll() is None, "the gateway has lived through it"
    rows = list(TelemetryRecord.objects.values_list("uav_id", "sequence"))
    ends = Counter(UavCommand.objects.filter(pk__in=given).values_list("state", "outcome_code"))
    out_of_order = 0
    for uav, flyer in zip(uavs, flyers, strict=True):
        speeds = [values[1] for command, values in flyer.vehicle.taken if command == 178]
        out_of_order += speeds != sorted(speeds)
        for command in UavCommand.objects.filter(uav=uav, kind=CommandKind.CHANGE_SPEED, state=CommandState.APPLIED):
            out_of_order += not any(abs(speed - command.parameters["speed_mps"]) < 1e-4 for speed in speeds)
    return {
        "kills": KILLS, "given": len(given), "ends": {" ".join(filter(None, end)): number for end, number in ends.items()},
        "out_of_order": out_of_order, "told": len(reported), "stored": len(rows), "doubled": len(rows) - len(set(rows)),
        "lost": len(reported - set(rows)), "lost_that_were_stored": len(stored - set(rows)),
    }  # fmt: skip


if __name__ == "__main__":
    os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
    print(json.dumps(main(Places(Path(sys.argv[1])), Path(sys.argv[2]))), flush=True)
