"""Scenarios of the link: each flies on the scripted ArduCopter, and by `./check --sitl BINARY` on the real firmware that the user has."""

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from missions.models import Mission, Uav
from missions.services import TargetRequest
from planning.clearance.lost_link import LostLink
from planning.request import LostLinkRequest
from planning.task import Task, TaskKind
from tests.accounts.users import a_user
from tests.missions.flights import approved, ground
from tests.missions.worlds import world, zone_around
from tests.telemetry.gateway.station import unsigned_uav
from tests.telemetry.scenarios.emulated import Emulated
from tests.telemetry.scenarios.firmware import Firmware
from tests.telemetry.scenarios.lossy_link import LossyLink
from tests.telemetry.scenarios.vehicle import HOME_AMSL_M, RALLY_AT, ScenarioVehicle

BINARY = "SPANWISE_SITL"
MAX_FIRMWARES = 10  # of one process of pytest


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
    return approved(a_user(), [uav], tasks, lost_link=LostLinkRequest(LostLink.RETURN, rally_points=(RALLY_AT,)))[0]


@pytest.fixture(params=["firmware" if os.environ.get(BINARY) else "emulated"])
def new_vehicle(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Callable[..., ScenarioVehicle]]:
    """Starts a vehicle whose link leads to a port, by UDP or TCP."""
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    instances = count(worker * MAX_FIRMWARES)
    with ExitStack() as running:

        def start(port: int, transport: str = "udp", *, system: int = 7, **values: Any) -> ScenarioVehicle:
            if request.param == "emulated":
                return running.enter_context(Emulated(port, transport, system=system, **values))
            link = f"{transport}client:127.0.0.1:{port}"
            made = Firmware(
                Path(os.environ[BINARY]), tmp_path / f"firmware-{system}", link, system=system, instance=next(instances), **values
            )
            return running.enter_context(made)

        yield start


@pytest.fixture
def lossy() -> Iterator[Callable[..., LossyLink]]:
    """Puts a radio that loses a share of the frames before a gateway's port."""
    with ExitStack() as running:
        yield lambda port, loss, transport="udp": running.enter_context(LossyLink(port, loss, transport))
