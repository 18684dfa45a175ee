"""Every test of simulation has its own cache of graphs."""

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def own_graph_cache(settings, tmp_path: Path) -> None:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
