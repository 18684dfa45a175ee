"""What the record of a long mission costs: 100,000 telemetry records of ten UAVs, and as many estimates.

    python -m benchmarks.telemetry.mission_record [--records 100000] [--write]

In a database of its own on the server of the settings. With --write the table goes to docs/performance.md.
"""

import argparse
import os
import time
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.db import connection, connections  # noqa: E402
from django.test import Client  # noqa: E402

from benchmarks.report import machine, table, write_section  # noqa: E402
from benchmarks.telemetry.live_fleet import UAVS_A_MISSION, make_site, own_database  # noqa: E402
from missions.models import Mission, Uav  # noqa: E402
from telemetry.models import TelemetryStream  # noqa: E402
from workspace.models import User  # noqa: E402

ON_THE_PAGE = 4_000  # what static/js/report/load.js asks for at most
_RECORDS = """
INSERT INTO telemetry_telemetryrecord (stream_id, sequence, uav_id, mission_id, measured_at, received_at, stored_at, position,
    altitude_relative_m, altitude_amsl_m, battery_percent, mode, is_armed, is_in_air, waypoint_sequence, is_late, is_from_future)
SELECT %(stream)s, number, %(uav)s, %(mission)s, at, at, at,
    ST_SetSRID(ST_MakePoint(%(lon)s + 0.024 * number / %(records)s, %(lat)s + 0.00001 * sin(number)), 4326),
    60, 160, 100 - 60.0 * number / %(records)s, 'Mission', true, true, least(6, (7 * number / %(records)s)::int), false, false
FROM (SELECT number, now() - make_interval(secs => %(records)s - number) AS at FROM generate_series(1, %(records)s) number) told
"""

_ESTIMATES = """
INSERT INTO telemetry_positionestimate (uav_id, mission_id, estimated_for, made_at, report_at, position, altitude_amsl_m,
    altitude_relative_m, speed_mps, bound_along_m, bound_across_m, bound_bearing_deg, bound_height_m, bound_speed_mps, is_lost)
SELECT uav_id, mission_id, measured_at + interval '0.5 s', measured_at, measured_at, position, altitude_amsl_m, altitude_relative_m, 5,
    4, 3, 90, 3, 1, false FROM telemetry_telemetryrecord
"""


def fill(mission: Mission, records: int) -> None:
    for uav in Uav.objects.filter(mission_uavs__mission=mission).order_by("pk"):
        stream = TelemetryStream.objects.create(uav=uav, link="mavlink", key="flight")
        values = {
            "stream": stream.pk, "uav": uav.pk, "mission": mission.pk, "lon": uav.location.x, "lat": uav.location.y,
            "records": records // UAVS_A_MISSION,
        }  # fmt: skip
        with connection.cursor() as cursor:
            cursor.execute(_RECORDS, values)
    with connection.cursor() as cursor:
        cursor.execute(_ESTIMATES)
        cursor.execute("ANALYZE")


def _asked(path: str, user_id: int, reported: Any) -> None:
    """In a process of its own, so that its memory is its alone."""
    client = Client(SERVER_NAME="localhost")
    client.force_login(User.objects.get(pk=user_id))
    client.get("/healthz")
    before_mib, cpu_s, wall_s = _peak_mib(), time.process_time(), time.perf_counter()
    answer = client.get(path)
    size = sum(map(len, answer.streaming_content)) if answer.streaming else len(answer.content)
    if answer.status_code != 200:
        raise SystemExit(f"{path}: {answer.status_code}")
    reported.put((time.perf_counter() - wall_s, time.process_time() - cpu_s, _peak_mib() - before_mib, size))


def _peak_mib() -> float:
    """Of this program's own: what getrusage says counts in whoever started it."""
    peak = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(peak.split()[1]) / 1024


def measured(path: str, user: User, start: Callable[..., Any]) -> list[str]:
    reported = get_context("spawn").Queue()
    asking = start(target=_asked, args=(path, user.pk, reported))
    asking.start()
    wall_s, cpu_s, mib, size = reported.get(timeout=300)
    asking.join()
    return [f"{wall_s:.1f}", f"{cpu_s:.1f}", f"{mib:.0f}", f"{size / 1e6:.2f}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--records", type=int, default=100_000)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    with own_database():
        user, _ = make_site(UAVS_A_MISSION)
        mission = Mission.objects.get()
        fill(mission, options.records)
        asked = {
            "record": f"/api/v1/missions/{mission.pk}/record",
            "record.zip": f"/api/v1/missions/{mission.pk}/record.zip",
            "positions for the page": f"/api/v1/telemetry?mission={mission.pk}&most={ON_THE_PAGE}&limit=1000",
        }
        connections.close_all()
        start = get_context("spawn").Process
        rows = [[name, *measured(path, user, start)] for name, path in asked.items()]
    text = (
        f"`python -m benchmarks.telemetry.mission_record`: a mission of {UAVS_A_MISSION} UAVs with {options.records:,} telemetry "
        f"records and as many "
        f"estimates. {machine('django', 'numpy')}\n\n" + table(["what is asked for", "s", "s of processor", "MiB more", "MB"], rows)
    )
    print(text)
    if options.write:
        write_section("The record of a long mission", text)


if __name__ == "__main__":
    main()
