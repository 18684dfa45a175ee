"""A million assets: how much memory their import takes beside a bare pass of pyosmium over the same file, and how quick their tiles are.

    python -m benchmarks.network.large_region [--assets 1000000]

The region is made, the same in every run: lines of towers and poles, railways and bridges over some 1,000 by 1,000 km. It is imported into
a database of its own on the server of the settings, which is dropped afterwards.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from math import cos, radians
from pathlib import Path

import numpy as np
import osmium
from osmium.osm import mutable

TOWERS_A_LINE = 24
WEST, SOUTH, SIDE_DEG = 5.0, 45.0, 10.0
VOLTAGES = ("400000", "220000", "132000", "66000", "20000", "20000", "20000")
ZOOMS = (0, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14)
TILES_A_ZOOM = 20
DATABASE = "spanwise_large_region"


def write_region(path: Path, assets: int, side_deg: float = SIDE_DEG) -> None:
    """Of 100 assets some 93 are supports, 4 lines, 2 railways, 1 bridge. Nodes first, then ways, by number, as files have them."""
    rng = np.random.default_rng(7)
    lines = assets * 93 // 100 // TOWERS_A_LINE
    railways, bridges = assets // 50, assets // 100
    writer = osmium.SimpleWriter(osmium.io.File(str(path), "pbf"), overwrite=True)
    ways: list[tuple[list[int], dict[str, str]]] = []
    number = 0

    def path_of(steps: int, step_deg: float, tags: dict[str, str] | None) -> list[int]:
        nonlocal number
        lon, lat = WEST + rng.random() * side_deg, SOUTH + rng.random() * side_deg
        bearing = rng.random() * 6.283
        refs = []
        for _ in range(steps):
            number += 1
            writer.add_node(mutable.Node(id=number, location=(round(lon, 7), round(lat, 7)), tags=tags or {}))
            refs.append(number)
            bearing += rng.normal(0, 0.15)
            lon += step_deg * np.sin(bearing) / cos(radians(lat))
            lat += step_deg * np.cos(bearing)
        return refs

    for line in range(lines):
        voltage = VOLTAGES[line % len(VOLTAGES)]
        support = {"power": "tower" if int(voltage) > 50_000 else "pole"}
        ways.append((path_of(TOWERS_A_LINE, 0.0028, support), {"power": "line", "voltage": voltage, "operator": f"Operator {line % 40}"}))
    for _ in range(railways):
        ways.append((path_of(12, 0.002, None), {"railway": "rail"}))
    for _ in range(bridges):
        ways.append((path_of(2, 0.0006, None), {"bridge": "yes", "highway": "primary"}))
    for way, (refs, tags) in enumerate(ways, start=1):
        writer.add_way(mutable.Way(id=way, nodes=refs, tags=tags))
    writer.close()


def bare_pass(path: str) -> None:
    """What reading the file costs with nothing kept: every object once, ways with their positions."""
    objects = 0
    for _ in osmium.FileProcessor(path).with_locations():
        objects += 1
    _report(objects=objects)


def import_pass(path: str) -> None:
    """The import as the worker does it."""
    _django()
    from inspection.services import import_osm  # noqa: PLC0415 -- Django stands only now

    counts = import_osm(path=Path(path)).counts
    _report(new=counts["new"])


def tiles_pass() -> None:
    """Tiles as the web process makes them, of every zoom those where most is and some by chance."""
    _django()
    from django.db import connection  # noqa: PLC0415

    from inspection.selectors import vector_tile  # noqa: PLC0415

    with connection.cursor() as cursor:
        cursor.execute("SELECT ST_X(centre), ST_Y(centre) FROM inspection_asset TABLESAMPLE SYSTEM (1) LIMIT 5000")
        places = np.array(cursor.fetchall())
    rng = np.random.default_rng(11)
    rows = []
    for zoom in ZOOMS:
        wanted = {tile_of(zoom, *places[index]) for index in rng.integers(0, len(places), TILES_A_ZOOM * 3)}
        times, sizes = [], []
        for column, row in sorted(wanted)[:TILES_A_ZOOM]:
            vector_tile(zoom, column, row)  # what the database reads from disk the first time is not what users wait for
            started = time.perf_counter()
            sizes.append(len(vector_tile(zoom, column, row)))
            times.append((time.perf_counter() - started) * 1_000)
        rows.append((zoom, len(times), float(np.percentile(times, 50)), float(np.percentile(times, 95)), max(times), max(sizes) / 1_000))
    _report(tiles=rows)


def tile_of(zoom: int, lon: float, lat: float) -> tuple[int, int]:
    across = (lon + 180) / 360 * 2**zoom
    down = (1 - np.log(np.tan(radians(lat)) + 1 / cos(radians(lat))) / np.pi) / 2 * 2**zoom
    return int(across), int(down)


def _django() -> None:
    import django  # noqa: PLC0415

    os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
    django.setup()


def _report(**facts: object) -> None:
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"peak_mib": peak_mib, **facts}))


def _child(what: str, path: Path, environment: dict[str, str]) -> dict[str, object]:
    started = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.network.large_region", "--pass", what, str(path)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(done.stderr[-3_000:])
    return json.loads(done.stdout.splitlines()[-1]) | {"took_s": time.perf_counter() - started}


def _own_database() -> tuple[str, str]:
    """The settings' database server, with a database that is ours alone."""
    _django()
    from django.conf import settings  # noqa: PLC0415
    from django.db import connection  # noqa: PLC0415

    held = settings.DATABASES["default"]
    with connection.cursor() as cursor:
        cursor.execute(f"DROP DATABASE IF EXISTS {DATABASE} WITH (FORCE)")
        cursor.execute(f"CREATE DATABASE {DATABASE}")
    host = held["HOST"].replace("/", "%2F")
    secret = f":{held['PASSWORD']}" if held["PASSWORD"] else ""
    port = f":{held['PORT']}" if held["PORT"] else ""
    return f"postgis://{held['USER']}{secret}@{host}{port}/{DATABASE}", DATABASE


def _drop(name: str) -> None:
    from django.db import connection  # noqa: PLC0415

    with connection.cursor() as cursor:
        cursor.execute(f"DROP DATABASE IF EXISTS {name} WITH (FORCE)")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=int, default=1_000_000)
    parser.add_argument("--pass", dest="only", choices=["bare", "import", "tiles"], help=argparse.SUPPRESS)
    parser.add_argument("file", nargs="?", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.only:
        {"bare": lambda: bare_pass(options.file), "import": lambda: import_pass(options.file), "tiles": tiles_pass}[options.only]()
        return
    address, name = _own_database()
    environment = os.environ | {"DATABASE_URL": address}
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "region.osm.pbf"
            write_region(path, options.assets)
            print(f"{options.assets:,} assets in {path.stat().st_size / 1e6:.1f} MB")
            subprocess.run([sys.executable, "manage.py", "migrate", "--verbosity", "0"], env=environment, check=True)
            bare = _child("bare", path, environment)
            imported = _child("import", path, environment)
            print(f"bare pass  {bare['took_s']:7.1f} s  {bare['peak_mib']:7.0f} MiB")
            print(f"import     {imported['took_s']:7.1f} s  {imported['peak_mib']:7.0f} MiB  ({imported['new']:,} new)")
            print(f"ratio      {imported['took_s'] / bare['took_s']:7.1f}    {imported['peak_mib'] / bare['peak_mib']:7.1f}")  # type: ignore[operator]
            tiles = _child("tiles", path, environment)["tiles"]
            print("zoom  tiles   p50 ms   p95 ms   max ms   largest kB")
            for zoom, number, middle, late, worst, largest in tiles:  # type: ignore[attr-defined]
                print(f"{zoom:4}  {number:5}  {middle:7.1f}  {late:7.1f}  {worst:7.1f}  {largest:10.0f}")
    finally:
        _drop(name)


if __name__ == "__main__":
    main()
