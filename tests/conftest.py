"""Fixtures for every test: generated regions, real data beside the checkout, and a database that is copied from a migrated one."""

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import pytest
from django.apps import AppConfig, apps
from django.core.management import call_command
from django.db import connection
from django.db.backends.utils import CursorWrapper
from django.db.models.signals import post_migrate
from hypothesis import settings
from pytest_django import DjangoDbBlocker

from inspection.demo_region import make_quillmoor, make_region, write_osm_file

settings.register_profile("spanwise", deadline=None)  # tests do not time
settings.register_profile("check", deadline=None, derandomize=True)
settings.load_profile("spanwise")

GENERATED_REGIONS = {"elme-valley.osm.pbf": lambda: make_region().osm, "quillmoor.osm.pbf": make_quillmoor}
PROJECT_DIR = Path(__file__).resolve().parents[1]
SHARED_DATA = PROJECT_DIR.parent / "shared" / "data"
TEMPLATE_PREFIX = "spanwise_migrated_"
TEMPLATE_LOCK = 5_372_029  # any number that nothing else locks


def pytest_configure(config: pytest.Config) -> None:
    """Where the long tests are left out, each change is judged by the same cases; new ones are sought by the long tests and by hand."""
    if "not long" in config.getoption("markexpr", ""):
        settings.load_profile("check")


@pytest.fixture(scope="session")
def shared_data() -> Callable[[str], Path]:
    """Path of a file of the shared real data; the test is skipped where the folder is missing."""

    def path_of(name: str) -> Path:
        path = SHARED_DATA / name
        if not path.exists():
            pytest.skip(f"real data not here: shared/data/{name}")
        return path

    return path_of


@pytest.fixture(scope="session")
def region_file(shared_data: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return the path of a region's OSM file by its name: one of GENERATED_REGIONS, written once, or a real extract as in `shared_data`."""
    folder = tmp_path_factory.mktemp("regions")

    def path_of(name: str) -> Path:
        if name not in GENERATED_REGIONS:
            return shared_data(f"osm/{name}")
        path = folder / name
        if not path.exists():
            write_osm_file(path, GENERATED_REGIONS[name]())
        return path

    return path_of


@pytest.fixture(scope="session", autouse=True)
def default_organisation_comes_back() -> None:
    """Tests with real commits end with an emptied database, and what the migrations had put there is gone: Django then says "migrated"."""

    def make(sender: AppConfig, **_: object) -> None:
        if sender.label == "workspace":
            apps.get_model("workspace", "Organisation").objects.get_or_create(pk=1, defaults={"name": "Default"})

    post_migrate.connect(make, weak=False)


@pytest.fixture(scope="session")
def django_db_modify_db_settings(django_db_modify_db_settings_parallel_suffix: None, django_db_blocker: DjangoDbBlocker) -> None:
    """Each worker's database is a copy of one that is migrated once for all, and kept as long as the migrations stay the same."""
    with django_db_blocker.unblock():
        connection.settings_dict["TEST"] |= {"TEMPLATE": migrated_template(), "MIGRATE": False}


def migrated_template() -> str:
    """Return the name of the migrated database, made where it is missing; others that want it meanwhile wait."""
    digest = sha256((PROJECT_DIR / "requirements.txt").read_bytes())
    for path in sorted(PROJECT_DIR.glob("*/migrations/*.py")):
        digest.update(f"{path.relative_to(PROJECT_DIR)} ".encode() + path.read_bytes())
    name = f"{TEMPLATE_PREFIX}{digest.hexdigest()[:16]}"
    with connection.creation._nodb_cursor() as cursor:
        cursor.execute("SELECT pg_advisory_lock(%s)", [TEMPLATE_LOCK])  # until this connection closes
        cursor.execute("SELECT datname FROM pg_database WHERE starts_with(datname, %s)", [TEMPLATE_PREFIX])
        if name not in (found := [row[0] for row in cursor.fetchall()]):
            _make_template(cursor, name, outdated=found)
    return name


def _make_template(cursor: CursorWrapper, name: str, *, outdated: list[str]) -> None:
    draft = f"{TEMPLATE_PREFIX}draft"
    for other in {*outdated, draft}:
        cursor.execute(f'DROP DATABASE IF EXISTS "{other}"')
    cursor.execute(f'CREATE DATABASE "{draft}"')
    own_name = connection.settings_dict["NAME"]
    connection.close()
    connection.settings_dict["NAME"] = draft
    try:
        call_command("migrate", verbosity=0, interactive=False)
    finally:
        connection.close()
        connection.settings_dict["NAME"] = own_name
    cursor.execute(f'ALTER DATABASE "{draft}" RENAME TO "{name}"')
