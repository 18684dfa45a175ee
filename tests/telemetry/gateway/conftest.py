"""What the tests of the gateway share: folders of their own, and a simulated UAV that need not sign."""

from pathlib import Path
from typing import Any

import pytest

from missions.models import Uav
from tests.telemetry.gateway.station import unsigned_uav


@pytest.fixture(autouse=True)
def own_folders(settings: Any, tmp_path: Path) -> None:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    settings.FLIGHT_LOG_DIR = tmp_path


@pytest.fixture
def uav() -> Uav:
    return unsigned_uav(7, is_simulated=True)
