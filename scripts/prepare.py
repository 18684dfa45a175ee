"""Prepare a database for the program before it starts: migrations, static files, data, the graph.

python -m scripts.prepare [--osm FILE]... [--zones FILE]...
python -m scripts.prepare --static-files      (only these; the first form starts it in parallel)
"""

import argparse
import hashlib
import json
import os
import secrets
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path

import django
from django.apps import apps
from django.contrib.staticfiles.finders import get_finders
from django.core.management import CommandError, call_command
from django.db import connection
from django.db.migrations.executor import MigrationExecutor

from config import page_bundles, static_files
from config.private_servers import state_directory
from scripts.compile_core import compile_core, is_core_compiled
from scripts.places import DEMO_USER, Places
from scripts.progress import step


def migrate() -> None:
    executor = MigrationExecutor(connection)
    executor.check_replacements()  # a replacing migration counts as applied where all replaced ones are
    if executor.migration_plan(executor.loader.graph.leaf_nodes()):
        with step("Database migrations"):
            call_command("migrate", interactive=False, verbosity=0)


def collect_static_files(places: Places) -> None:
    """Copy and rename static files, unless they are unchanged since the last time: scanning all of them takes seconds."""
    digest = hashlib.sha256()
    for source in (page_bundles, static_files):
        digest.update(Path(str(source.__file__)).read_bytes())
    for finder in get_finders():
        for name, storage in finder.list([]):
            digest.update(f"{name} {storage.size(name)} {storage.get_modified_time(name)}\n".encode())
    stamp = places.static / ".collected"
    if stamp.exists() and stamp.read_text() == digest.hexdigest():
        return
    with step("Static files"):
        call_command("collectstatic", interactive=False, verbosity=0)
        stamp.write_text(digest.hexdigest())


@contextmanager
def static_files_meanwhile() -> Iterator[None]:
    """Collect static files in a parallel process. Raises CommandError if that fails."""
    command = [sys.executable, "-m", "scripts.prepare", "--static-files"]
    collecting = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield
        lines = collecting.communicate()[0]
    finally:
        if collecting.returncode is None:
            collecting.kill()
            collecting.wait()
    if collecting.returncode:
        raise CommandError(f"Static files could not be collected:\n{lines}")
    print(lines, end="", flush=True)


def wait_for_core() -> None:
    """Compile the planners' core, unless the set-up did, or is doing so in the background. Raises CommandError."""
    if is_core_compiled():
        return
    with step("Planners' core, about a minute"):
        try:
            compile_core()
        except subprocess.CalledProcessError as error:
            raise CommandError(f"The planners' core could not be compiled ({error.cmd})") from error


def is_without_ground() -> bool:
    """Whether there is neither an asset nor a zone yet."""
    return not any(apps.get_model("inspection", name).objects.exists() for name in ("Asset", "NoFlyZone"))


def password_file(places: Places) -> Path:
    """Return the file with the demo user's password: generated once, readable by its owner only."""
    path = places.demo_password
    if not path.exists():
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(descriptor, "w") as file:
            file.write(f"{secrets.token_urlsafe(12)}\n")
    return path


def load_demo_region(folder: Path) -> None:
    """Make the demo region's files and import them with the ordinary importers."""
    commands = [
        ("Demo region (synthetic): files", ["make_demo_region", str(folder)]),
        ("Demo region: towers, lines, railways, bridges", ["import_osm", str(folder / "demo.osm.pbf"), "--synthetic"]),
        ("Demo region: no-fly zones", ["import_zones", str(folder / "demo-zones.json"), "--synthetic"]),
        ("Demo region: terrain", ["import_terrain", str(folder / "demo-terrain.tif"), "--synthetic"]),
        ("Demo region: UAVs", ["load_demo"]),
    ]
    for text, command in commands:
        with step(text):
            call_command(*command, stdout=StringIO())


def load_own_data(osm_files: list[Path], zone_files: list[Path]) -> None:
    """Import the operator's files; the importers report what they found, and skip unchanged files."""
    for command, paths in (("import_osm", osm_files), ("import_zones", zone_files)):
        for path in paths:
            print(f"{command} {path}", flush=True)
            call_command(command, str(path))


def make_demo_user(password_file: Path) -> None:
    """Create an administrator in a new database of ./run, unless it has an account already."""
    call_command("load_demo", "--no-uavs", "--user", DEMO_USER, "--password-file", str(password_file), stdout=StringIO())


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--osm", type=Path, action="append", default=[])
    parser.add_argument("--zones", type=Path, action="append", default=[])
    parser.add_argument("--static-files", action="store_true")
    options = parser.parse_args()
    places = Places(state_directory())
    os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
    django.setup()

    if options.static_files:
        collect_static_files(places)
        call_command("make_api_document")
        return
    with static_files_meanwhile():
        migrate()
        wait_for_core()
        load_data(places, options.osm, options.zones)


def load_data(places: Places, osm_files: list[Path], zone_files: list[Path]) -> None:
    """Load the demo region into a database that is new or empty, or the operator's files, and build the graph."""
    is_demo = False
    if places.first_load.exists() or is_without_ground():
        # Exists until all is done, so that an interrupted load is repeated. ./run creates it before it creates a database.
        if not places.first_load.exists():
            places.first_load.write_text(json.dumps({"demo_user": False}))
        if json.loads(places.first_load.read_text())["demo_user"]:
            make_demo_user(password_file(places))
        if not (osm_files or zone_files):
            load_demo_region(places.state / "demo")
        is_demo = not (osm_files or zone_files)
    load_own_data(osm_files, zone_files)
    with step("Inspection graph"):
        call_command("build_graph", stdout=StringIO())
    if is_demo:
        call_command("make_demo_missions", stdout=StringIO())
    places.first_load.unlink(missing_ok=True)


if __name__ == "__main__":
    try:
        main()
    except CommandError as error:
        sys.exit(f"{error}")
    except KeyboardInterrupt:
        sys.exit(130)
