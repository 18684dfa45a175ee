"""Every test of simulation has its own cache of graphs."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cases import RowsForAModule
from tests.simulation.rehearsals.random_rehearsals import bring_in_demo_region


@pytest.fixture(autouse=True)
def own_graph_cache(settings, tmp_path: Path) -> None:
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"


@pytest.fixture(scope="module")
def demo_region(rows_for_a_module: RowsForAModule, tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Brought in once for a module, whose tests do not commit."""
    with rows_for_a_module(lambda: bring_in_demo_region(tmp_path_factory.mktemp("demo"))):
        yield
