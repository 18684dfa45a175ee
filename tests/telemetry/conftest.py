"""Every test of telemetry has its own cache of graphs, and requests that nobody counted before."""

from pathlib import Path
from uuid import uuid4

import pytest

from telemetry.views import uav_authentication
from tests.workspace.counters import forget_counts


@pytest.fixture(autouse=True)
def own_graph_cache(settings, tmp_path: Path) -> None:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"


@pytest.fixture(autouse=True)
def nobody_has_asked_or_guessed(monkeypatch: pytest.MonkeyPatch) -> None:
    forget_counts()
    monkeypatch.setattr(uav_authentication, "GUESSING", f"guessing in test {uuid4()}")
