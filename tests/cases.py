"""Cases of parametrized tests."""

from typing import Any

import pytest


def long(*values: Any) -> list[Any]:
    """Cases that `./check --long` runs alone, such as large extracts of real data."""
    return [pytest.param(value, marks=pytest.mark.long) for value in values]
