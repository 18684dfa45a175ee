"""How fast the register of assets answers in each order and for each filter, counts, exports, and edits of many.

    python -m benchmarks.asset_register [--assets 100000] [--write]

Lines with their supports are put into the database, in a transaction that is rolled back. Each request goes through the web application
without a network. With --write the table goes to docs/performance.md. Exits with 1 where an answer takes longer than MAX_MS.
"""

import argparse
import os
import sys
from statistics import median
from time import perf_counter
from typing import Any

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.conf import settings  # noqa: E402 (Django first)
from django.contrib.gis.geos import LineString, Point  # noqa: E402
from django.db import connection, transaction  # noqa: E402
from django.test import Client  # noqa: E402

from benchmarks.report import machine, table, write_section  # noqa: E402
from inspection.models import Asset, DataImport  # noqa: E402
from inspection.services.ground import mark_ground_changed, number_supports  # noqa: E402
from inspection.services.imports.regions import join_region  # noqa: E402
from inspection.tasks import export_register  # noqa: E402
from workspace.models import DEFAULT_ORGANISATION_ID, Role, User  # noqa: E402

MAX_MS = 200.0
SUPPORTS_A_LINE = 25
ROUNDS = 5
EDITED = 5_000
STEP_DEG = 0.004
VOLTAGES_V = (380_000, 220_000, 110_000, 20_000)
QUERIES = (
    "limit=100", "limit=100&sort=name", "limit=100&sort=-voltage", "limit=100&sort=operator", "limit=100&sort=-changed",
    "limit=100&sort=-height", "limit=100&sort=-length",
    "limit=100&sort=inspected", "limit=100&kind=line&sort=-length", "limit=100&voltage_v=110000&sort=name",
    "limit=100&region={region}&sort=name", "limit=100&operator=Grid%203&kind=tower&sort=-height", "limit=100&line={line}",
    "limit=100&inspected=false&sort=name", "limit=100&text=T77", "limit=100&bbox=8,45,8.3,45.3&sort=name",
)  # fmt: skip
COUNTS = ("", "kind=tower", "voltage_v=110000", "operator=Grid%203", "region={region}", "bbox=8,45,8.3,45.3", "inspected=false", "text=T77")


def store(assets: int) -> tuple[int, int]:
    """Insert the assets. Returns the keys of a line and of their region."""
    data_import = DataImport.objects.create(kind="osm", file_name="register.osm.pbf", sha256="register")
    lines, supports = [], []
    for number in range(assets // (SUPPORTS_A_LINE + 1)):
        west, south = 8.0 + (number % 100) * 0.06, 45.0 + (number // 100) * 0.05
        path = [(west + place * STEP_DEG, south + 0.01 * ((place * 7) % 3)) for place in range(SUPPORTS_A_LINE)]
        first = 10_000_000_000 + number * SUPPORTS_A_LINE
        voltage_v = VOLTAGES_V[number % 4]
        shared: dict[str, Any] = {"data_import": data_import, "osm_id": first}
        lines.append(Asset(
            kind="line", subtype="line", osm_type="w", geometry=LineString(path, srid=4326), centre=Point(path[0], srid=4326),
            ref=f"L{number}", operator=f"Grid {number % 12}", voltages_v=[voltage_v], max_voltage_v=voltage_v, length_m=9_000.0 + number,
            node_osm_ids=list(range(first, first + SUPPORTS_A_LINE)), **shared,
        ))  # fmt: skip
        for place, position in enumerate(path):
            point = Point(position, srid=4326)
            supports.append(Asset(
                kind="tower", subtype="tower", osm_type="n", geometry=point, centre=point, ref=f"T{number}-{place}" if place % 3 else "",
                height_m=20.0 + (place * 7 + number) % 40, **shared | {"osm_id": first + place},
            ))  # fmt: skip
    Asset.objects.bulk_create(lines, batch_size=2_000)
    Asset.objects.bulk_create(supports, batch_size=2_000)
    number_supports()
    region = join_region(data_import)
    mark_ground_changed()
    with connection.cursor() as cursor:
        cursor.execute("ANALYZE inspection_asset")
    line = Asset.objects.filter(data_import=data_import, kind="line").order_by("pk").values_list("pk", flat=True)[len(lines) // 2]
    return line, region.pk if region is not None else 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=int, default=100_000)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    settings.ALLOWED_HOSTS = ["*"]
    rows: list[list[str]] = []
    slowest = 0.0
    with transaction.atomic():
        line, region = store(options.assets)
        client = Client(headers={"host": "localhost"})
        user = User.objects.create(username="register-benchmark", role=Role.CURATOR, organisation_id=DEFAULT_ORGANISATION_ID)
        client.force_login(user)
        _milliseconds(client, "/api/v1/assets?limit=1")  # loads the application
        for path, queries in (("/api/v1/assets", QUERIES), ("/api/v1/assets/summary", COUNTS)):
            for query in queries:
                address = f"{path}?{query.format(line=line, region=region)}"
                median_ms = median(_milliseconds(client, address) for _ in range(ROUNDS))
                slowest = max(slowest, median_ms)
                rows.append([f"`{path.removeprefix('/api/v1')}?{query}`", f"{median_ms:.0f}"])
        for ending in ("csv", "geojson"):
            began = perf_counter()
            answer: Any = client.get(f"/api/v1/assets/export.{ending}")
            size = sum(len(piece) for piece in answer.streaming_content)
            rows.append([f"all as {ending}, {size / 1e6:.0f} MB", f"{(perf_counter() - began) * 1000.0:.0f}"])
        began = perf_counter()
        job = client.post("/api/v1/assets/exports").json()["id"]
        export_register(job)
        size = int(client.get(f"/api/v1/exports/{job}")["Content-Length"])
        rows.append([f"all as gpkg, by a job, {size / 1e6:.0f} MB", f"{(perf_counter() - began) * 1000.0:.0f}"])
        rows += [[f"{name} {EDITED:,} supports", f"{took_ms:.0f}"] for name, took_ms in _edits(client)]
        transaction.set_rollback(True)
    head = f"`python -m benchmarks.asset_register`: {options.assets:,} assets. {machine('django')}\n\n"
    text = head + table(["request", "median [ms]"], rows)
    print(text)
    if options.write:
        write_section("Register of assets", text)
    sys.exit(slowest > MAX_MS)


def _edits(client: Client) -> list[tuple[str, float]]:
    keys = list(Asset.objects.filter(kind="tower").order_by("pk").values_list("pk", flat=True)[:EDITED])
    began = perf_counter()
    answer = client.post("/api/v1/assets/edits", {"ids": keys, "values": {"operator": "Other"}}, content_type="application/json")
    changed = perf_counter()
    client.post("/api/v1/assets/edits/undo", {"entries": answer.json()["entries"]}, content_type="application/json")
    return [("change the operator of", (changed - began) * 1000.0), ("undo the change of", (perf_counter() - changed) * 1000.0)]


def _milliseconds(client: Client, address: str) -> float:
    began = perf_counter()
    answer = client.get(address)
    took_ms = (perf_counter() - began) * 1000.0
    if answer.status_code != 200:
        raise RuntimeError(f"{address}: {answer.status_code}")
    return took_ms


if __name__ == "__main__":
    main()
