"""Fixtures for every test: generated regions, real data beside the checkout, and a database that is copied from a migrated one."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
from hashlib import sha256
from pathlib import Path

import pytest
from django.core.management import call_command
from django.db import connection, transaction
from django.db.backends.utils import CursorWrapper
from django.test import TransactionTestCase
from hypothesis import settings
from pytest_django import DjangoDbBlocker

from inspection.demo_region import make_quillmoor, make_region, write_osm_file
from tests.cases import RowsForAModule
from tests.missions.worlds import World, world
from workspace.models import Organisation

settings.register_profile("spanwise", deadline=None)  # tests do not time
settings.register_profile("check", deadline=None, derandomize=True)
settings.load_profile("spanwise")

GENERATED_REGIONS = {"elme-valley.osm.pbf": lambda: make_region().osm, "quillmoor.osm.pbf": make_quillmoor}
PROJECT_DIR = Path(__file__).resolve().parents[1]
SHARED_DATA = PROJECT_DIR.parent / "shared" / "data"
MADE_BY_MIGRATIONS = {"django_migrations", "django_content_type", "auth_permission"}
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
def rows_are_deleted_after_commits() -> Iterator[None]:
    """After a test with real commits, delete the rows that it has left.

    Django's `flush` truncates each table, which makes new files of all tables and indexes, and then makes all permissions again. The
    content types and the permissions stay as the migrations have made them.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TransactionTestCase, "_fixture_teardown", lambda test_case: delete_rows())
        yield


def delete_rows() -> None:
    """Delete all rows but those of MADE_BY_MIGRATIONS, and make the default organisation again."""
    tables = sorted(set(connection.introspection.django_table_names(only_existing=True, include_views=False)) - MADE_BY_MIGRATIONS)
    names = {table: connection.ops.quote_name(table) for table in tables}
    with transaction.atomic(), connection.cursor() as cursor:
        holding = (f"SELECT '{table}' WHERE EXISTS (SELECT FROM {name})" for table, name in names.items())  # noqa: S608 - own names
        cursor.execute(" UNION ALL ".join(holding))
        for (table,) in cursor.fetchall():
            cursor.execute(f"DELETE FROM {names[table]}")  # noqa: S608 - foreign keys are checked at the end of the transaction
        Organisation.objects.create(pk=1, name="Default")


@pytest.fixture(scope="session")
def rows_for_a_module(django_db_setup: None, django_db_blocker: DjangoDbBlocker) -> RowsForAModule:
    """Make rows once that all tests of a module see, in a transaction around theirs: for a fixture of scope `module`.

    For modules whose tests do not commit.
    """

    @contextmanager
    def made_by(make: Callable[[], None]) -> Iterator[None]:
        block = transaction.atomic()
        with django_db_blocker.unblock():
            block.__enter__()
            make()
        yield
        with django_db_blocker.unblock():
            transaction.set_rollback(True)
            block.__exit__(None, None, None)

    return made_by


@pytest.fixture(scope="module")
def world_of_the_module(rows_for_a_module: RowsForAModule) -> Iterator[World]:
    made: list[World] = []
    with rows_for_a_module(lambda: made.append(world())):
        yield made[0]


@pytest.fixture
def here(world_of_the_module: World, db: None) -> World:
    """The world of tests/missions/worlds.py with its graph, made once for all tests of a module, which do not commit."""
    return deepcopy(world_of_the_module)


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
