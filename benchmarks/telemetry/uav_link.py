"""What the HTTP link and the log cost: polls without news, batches of reports, reading and exporting 100,000 records.

    python -m benchmarks.telemetry.uav_link [--records 100000] [--write]

Everything is asked through all of Django, without a web server in front, in a transaction that is taken back; processor time is that
of this process, PostgreSQL's own is not in it. With --write the table goes to docs/performance.md.
"""

import argparse
import json
import os
import resource
import sys
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from statistics import median
from time import perf_counter, process_time
from typing import Any

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.conf import settings  # noqa: E402 (Django first)
from django.contrib.gis.geos import Point  # noqa: E402
from django.db import connection, transaction  # noqa: E402
from django.test import Client  # noqa: E402

from benchmarks.report import machine, table, write_section  # noqa: E402
from mavlink.decoding.measurement import Measurement  # noqa: E402
from missions.models import CredentialKind, LinkKind, Uav  # noqa: E402
from missions.services import make_credential  # noqa: E402
from telemetry.services import NewRecord, store_records  # noqa: E402
from telemetry.views.uav_authentication import UavRate  # noqa: E402
from workspace.models import Role, User  # noqa: E402

LINK = "/api/v1/uav-link"
Row = tuple[str, str, str]


def timed(ask: Callable[[], Any], times: int) -> tuple[float, float]:
    """Medians of seconds on the clock and of processor seconds."""
    clock, processor = [], []
    for _ in range(times):
        began, worked = perf_counter(), process_time()
        ask()
        clock.append(perf_counter() - began)
        processor.append(process_time() - worked)
    return median(clock), median(processor)


def row(name: str, measured: tuple[float, float]) -> Row:
    return name, f"{measured[0] * 1e3:.2f}", f"{measured[1] * 1e3:.2f}"


def link_rows(token: str) -> list[Row]:
    client, headers = Client(), {"Authorization": f"Bearer {token}"}
    etag = client.get(f"{LINK}/route", headers=headers)["ETag"]

    def poll() -> None:
        assert client.get(f"{LINK}/route", headers={**headers, "If-None-Match": etag}).status_code == 304  # noqa: S101

    sent = 0

    def report(number: int) -> None:
        nonlocal sent
        records = [record_json(sent + place) for place in range(number)]
        sent += number
        body = json.dumps({"stream": "benchmark", "records": records})
        answer = client.post(f"{LINK}/telemetry", body, content_type="application/json", headers=headers)
        assert answer.json()["stored"] == number, answer.content  # noqa: S101

    return [
        row("a poll without news (304)", timed(poll, 300)),
        row("a report of one record", timed(lambda: report(1), 100)),
        row("a batch of 1,000 records", timed(lambda: report(1_000), 10)),
    ]


def record_json(sequence: int) -> dict[str, Any]:
    measured_at = datetime.now(UTC) - timedelta(seconds=60)
    return {
        "sequence": sequence, "measured_at": measured_at.isoformat(), "position": [9.52, 47.14], "altitude_amsl_m": 500.0,
        "altitude_relative_m": 40.0, "velocity_north_mps": 5.0, "velocity_east_mps": 1.0, "velocity_down_mps": 0.0, "heading_deg": 12.0,
        "battery_percent": 80.0, "mode": "Mission", "is_armed": True, "is_in_air": True, "gps_fix": 3, "satellites": 14, "hdop": 0.8,
    }  # fmt: skip


def fill(uav: Uav, number: int) -> None:
    start = datetime.now(UTC) - timedelta(seconds=number + 60)

    def record(place: int) -> NewRecord:
        at = start + timedelta(seconds=place)
        reported = Measurement(
            longitude_deg=9.5 + place * 1e-6, latitude_deg=47.1, altitude_amsl_m=500.0, battery_percent=80.0, mode="Mission"
        )
        return NewRecord(uav.pk, LinkKind.MAVLINK, "log", place, at, at, reported)

    for first in range(0, number, 5_000):
        store_records([record(place) for place in range(first, min(first + 5_000, number))])
    with connection.cursor() as cursor:
        cursor.execute("ANALYZE telemetry_telemetryrecord")


def log_rows(client: Client, uav: Uav) -> list[Row]:
    def read(query: str) -> Callable[[], None]:
        def ask() -> None:
            assert client.get(f"/api/v1/{query}").status_code == 200  # noqa: S101

        return ask

    return [
        row("the newest record", timed(read(f"uavs/{uav.pk}/telemetry/latest"), 50)),
        row("a page of 100 records", timed(read(f"telemetry?uav={uav.pk}"), 20)),
        row("all of it thinned out to 1,000", timed(read(f"telemetry?uav={uav.pk}&most=1000&limit=1000"), 3)),
    ]


def export_rows(client: Client, uav: Uav, number: int) -> list[Row]:
    found = []
    for kind in ("csv", "geojson", "gpx", "kml"):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        began, worked, size = perf_counter(), process_time(), 0
        for piece in client.get(f"/api/v1/uavs/{uav.pk}/telemetry.{kind}").streaming_content:  # type: ignore[attr-defined]
            size += len(piece)
        clock, processor = perf_counter() - began, process_time() - worked
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
        name = f"{number:,} records as {kind.upper()}, {size / 1e6:.0f} MB (memory + {grown:.0f} MiB)"
        found.append((name, f"{clock * 1e3:,.0f}", f"{processor * 1e3:,.0f}"))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--records", type=int, default=100_000)
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    settings.ALLOWED_HOSTS = ["testserver"]
    UavRate.THROTTLE_RATES = {**UavRate.THROTTLE_RATES, "uav-link": None}
    with transaction.atomic():
        person = User.objects.create_user("benchmark", role=Role.ADMINISTRATOR)
        uav = Uav.objects.create(name="Benchmark", location=Point(9.52, 47.14, srid=4326), link=LinkKind.HTTP)
        token = make_credential(uav=uav, actor=person, kind=CredentialKind.LINK_TOKEN).secret
        client = Client()
        client.force_login(person)
        rows = link_rows(token)
        logged = Uav.objects.create(name="Benchmark, logged", location=Point(9.52, 47.14, srid=4326))
        fill(logged, asked.records)
        rows += [*log_rows(client, logged), *export_rows(client, logged, asked.records)]
        transaction.set_rollback(True)
    text = table(("", "clock, ms", "processor, ms"), rows)
    print(text)
    if asked.write:
        head = (
            f"`python -m benchmarks.telemetry.uav_link`; {machine('django')}\n\nMedians, one process, a log of {asked.records:,} records."
        )
        write_section("The HTTP link and the log", f"{head}\n\n{text}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
