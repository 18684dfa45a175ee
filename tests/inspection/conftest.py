"""Zone files of each dialect for tests: those that the project wrote, and real ones beside the checkout."""

from collections.abc import Callable
from pathlib import Path

import pytest

OWN_ZONE_FILES = Path(__file__).with_name("importers") / "zones" / "files"


@pytest.fixture(scope="session")
def zone_file(shared_data: Callable[[str], Path]) -> Callable[[str], Path]:
    """Return the path of a zone file by its name: one of tests/inspection/importers/zones/files, or a real one as in `shared_data`."""

    def path_of(name: str) -> Path:
        own = OWN_ZONE_FILES / name
        return own if own.exists() else shared_data(f"zones/{name}")

    return path_of
