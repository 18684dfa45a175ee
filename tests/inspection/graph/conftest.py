"""The compiled core is loaded before any test is timed."""

import pytest

from inspection.graph.rehearsal import rehearse


@pytest.fixture(autouse=True, scope="session")
def _compiled() -> None:
    rehearse()
