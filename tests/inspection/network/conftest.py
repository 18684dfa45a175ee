"""The compiled core is loaded before any test is timed."""

import pytest

from inspection.network.warm_up import rehearse


@pytest.fixture(autouse=True, scope="session")
def _compiled() -> None:
    rehearse()
