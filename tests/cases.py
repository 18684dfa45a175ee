"""Cases of parametrized tests, and rows that the tests of a module share."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import pytest

RowsForAModule = Callable[[Callable[[], None]], AbstractContextManager[None]]  # the fixture rows_for_a_module


def long(*values: Any) -> list[Any]:
    """Cases that `./check --long` runs alone, such as large extracts of real data."""
    return [pytest.param(value, marks=pytest.mark.long) for value in values]
