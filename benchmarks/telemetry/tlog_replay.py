"""A real flight, replayed through a gateway: every position that was logged must be in a row, once and in order.

    python -m benchmarks.telemetry.tlog_replay FILE.tlog [--speed 20] [--seconds 0] [--write]

Frames are sent one by one as they were logged, at so many times their pace, to a gateway of its own process on the database of the
settings. The UAV and its records are removed afterwards. Exits with 1 where one is missing, doubled or out of order.
"""

import argparse
import os
import socket
import sys
import time
from pathlib import Path

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.contrib.gis.geos import Point  # noqa: E402 (Django first)
from django.db import connection  # noqa: E402

from benchmarks.report import machine, write_section  # noqa: E402
from benchmarks.telemetry.gateway_rate import SETTLES_S, free_port, gateway  # noqa: E402
from missions.models import Uav  # noqa: E402
from telemetry.models import TelemetryRecord, TelemetryStream, UavLink  # noqa: E402
from tests.telemetry.tlogs import frames_of_tlog, positions_of  # noqa: E402

SYSTEM = 1


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("file", type=Path)
    parser.add_argument("--speed", type=float, default=20.0)
    parser.add_argument("--seconds", type=float, default=0.0, help="of the log from its beginning; 0: all")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    frames = frames_of_tlog(options.file)
    first_s = frames[0][0]
    if options.seconds:
        frames = [frame for frame in frames if frame[0] <= first_s + options.seconds]
    wanted = [message.time_boot_ms for message in positions_of(raw for _, raw in frames)]
    uav = Uav.objects.create(name="replay", location=Point(10, 55, srid=4326), mavlink_system_id=SYSTEM, allows_unsigned=True)
    port = free_port()
    try:
        with gateway(port), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.connect(("127.0.0.1", port))
            time.sleep(2)
            began_s = time.monotonic()
            for at_s, raw in frames:
                time.sleep(max(began_s + (at_s - first_s) / options.speed - time.monotonic(), 0.0))
                sender.send(raw)
            took_s, until_s = time.monotonic() - began_s, time.monotonic() + SETTLES_S
            rows = TelemetryRecord.objects.filter(uav=uav).order_by("measured_at", "pk")
            while rows.count() < len(wanted) and time.monotonic() < until_s:
                time.sleep(0.2)
            stored = list(rows.values_list("sequence", flat=True))
            boots = TelemetryStream.objects.filter(uav=uav).count()
            losses = UavLink.objects.get(uav=uav).losses
    finally:
        with connection.cursor() as cursor:
            cursor.execute("DELETE FROM telemetry_telemetryrecord WHERE uav_id = %s", [uav.pk])
        uav.delete()
    is_same = stored == wanted
    verdict = "each once and in order" if is_same else "NOT the same"
    text = (
        f"`python -m benchmarks.telemetry.tlog_replay {options.file.name} --speed {options.speed:g}`: {len(frames):,} frames in "
        f"{took_s:.1f} s, "
        f"{len(wanted):,} positions logged, {len(stored):,} rows in {boots} boots of the vehicle, {verdict}; "
        f"refused: {losses or 'none'}. {machine('pymavlink', 'psycopg', 'django')}"
    )
    print(text)
    if options.write:
        write_section("A real flight through the gateway", text)
    sys.exit(not is_same)


if __name__ == "__main__":
    main()
