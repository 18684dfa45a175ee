"""Zones beside a line, for a flight that goes round them."""

import numpy as np
import pytest

from inspection.selectors.zones_along import zones_along
from tests.inspection import ground

pytestmark = pytest.mark.django_db

LINE = np.array([[10.0, 56.0], [10.02, 56.0]])  # 1.25 km to the east


def test_a_zone_beside_the_line_is_named_only_when_what_is_near_is_asked_for() -> None:
    zone = ground.zone((10.010, 56.002), 0.001)  # its border lies 111 m north of the line
    assert zones_along(LINE) == []
    assert zones_along(LINE, near_m=100.0) == []
    (stretch,) = zones_along(LINE, near_m=200.0)
    assert stretch.zone.pk == zone.pk
    around_m = 62.4 + (200.0**2 - 111.3**2) ** 0.5  # half the zone's width, and what a circle of 200 m adds at its corners
    assert (stretch.from_m, stretch.to_m) == pytest.approx((623.5 - around_m, 623.5 + around_m), abs=10)


def test_what_the_line_crosses_is_told_from_what_it_passes_near() -> None:
    beside, crossed = ground.zone((10.005, 56.002), 0.001), ground.zone((10.015, 56.0), 0.001)
    found = {stretch.zone.pk: stretch.is_crossed for stretch in zones_along(LINE, near_m=200.0)}
    assert found == {beside.pk: False, crossed.pk: True}
    assert [(stretch.zone.pk, stretch.is_crossed) for stretch in zones_along(LINE)] == [(crossed.pk, True)]
