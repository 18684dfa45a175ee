"""Tests of the link on an ArduCopter that the user has: run by `./check --sitl BINARY` alone, and collected by nothing else."""

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from inspection.geodesy import LonLat
from missions.flight_plan.lost_link import LostLink
from missions.models import Mission, Uav
from missions.routing.problem import Task, TaskKind
from missions.services import TargetRequest
from missions.services.requests import LostLinkRequest
from tests.missions.flights import approved, ground
from tests.missions.worlds import UAV_AT, world, zone_around
from tests.sitl.firmware import HOME_AMSL_M, Firmware
from tests.sitl.lossy_link import LossyLink
from tests.telemetry.gateway.station import unsigned_uav
from tests.workspace.people import somebody

BINARY = "SPANWISE_SITL"
RALLY_AT = LonLat(UAV_AT.lon + 0.001, UAV_AT.lat)
MAX_FIRMWARES = 10  # of one process of pytest
collect_ignore_glob = [] if os.environ.get(BINARY) else ["test_*.py"]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("sitl")


@pytest.fixture
def uav() -> Uav:
    return unsigned_uav(7, is_simulated=True)


@pytest.fixture
def region(settings, tmp_path: Path) -> Any:
    """With a zone beside the routes, so that a fence is sent."""
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", HOME_AMSL_M)
    found = world()
    zone_around((10.010, 56.02), 0.001)
    return found


@pytest.fixture
def mission(uav: Uav, region: Any) -> Mission:
    """Every task, at a tower each, a fence and a rally point."""
    tasks = [TargetRequest(tower.pk, task=Task(kind, 5.0)) for tower, kind in zip(region.towers, TaskKind, strict=False)]
    return approved(somebody(), [uav], tasks, lost_link=LostLinkRequest(LostLink.RETURN, rally_points=(RALLY_AT,)))[0]


@pytest.fixture
def firmware(tmp_path: Path) -> Iterator[Callable[..., Firmware]]:
    """Starts a firmware whose first link leads to a port, by UDP or TCP."""
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    instances = count(worker * MAX_FIRMWARES)
    with ExitStack() as running:

        def start(port: int, transport: str = "udp", *, system: int = 7, **values: Any) -> Firmware:
            link = f"{transport}client:127.0.0.1:{port}"
            made = Firmware(
                Path(os.environ[BINARY]), tmp_path / f"firmware-{system}", link, system=system, instance=next(instances), **values
            )
            return running.enter_context(made)

        yield start


@pytest.fixture
def lossy() -> Iterator[Callable[[int, float], LossyLink]]:
    """Puts a link that loses a share of the frames before a gateway's port."""
    with ExitStack() as running:
        yield lambda port, loss: running.enter_context(LossyLink(port, loss))
