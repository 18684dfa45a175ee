"""Fixtures for every test: generated regions, and real data beside the checkout."""

from collections.abc import Callable
from pathlib import Path

import pytest
from django.apps import AppConfig, apps
from django.db.models.signals import post_migrate
from hypothesis import settings

from inspection.demo_region import make_quillmoor, make_region, write_osm_file

settings.register_profile("spanwise", deadline=None)  # tests do not time
settings.register_profile("check", deadline=None, derandomize=True)
settings.load_profile("spanwise")

GENERATED_REGIONS = {"elme-valley.osm.pbf": lambda: make_region().osm, "quillmoor.osm.pbf": make_quillmoor}
SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


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
