"""Tests of the link on an ArduCopter that the user has: run by `./check --sitl BINARY` alone, and collected by nothing else."""

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.sitl.firmware import Firmware

BINARY = "SPANWISE_SITL"
collect_ignore_glob = [] if os.environ.get(BINARY) else ["test_*.py"]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("sitl")


@pytest.fixture
def firmware(tmp_path: Path) -> Iterator[Callable[..., Firmware]]:
    """Starts a firmware whose first link leads to a port, by UDP or TCP."""
    with ExitStack() as running:

        def start(port: int, transport: str = "udp", *, system: int = 7, **values: object) -> Firmware:
            folder = tmp_path / f"firmware-{system}"
            link = f"{transport}client:127.0.0.1:{port}"
            return running.enter_context(Firmware(Path(os.environ[BINARY]), folder, link, system=system, **values))

        yield start
