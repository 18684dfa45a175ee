"""What the tests of the solvers share."""

import pytest

from planning.solver import search


@pytest.fixture(autouse=True)
def short_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    """A quarter of the rounds of a search without a time: enough for problems of a dozen targets, and the tests make hundreds."""
    monkeypatch.setattr(search, "FIXED_STEPS", search.FIXED_STEPS // 4)
