"""Which airframe flies for a UAV."""

import pytest

from planning.energy.performance import Performance
from simulation.rehearsing.airframe_choice import CANDIDATES, nearest_airframe


@pytest.mark.parametrize(
    ("performance", "speed_mps", "airframe"),
    [
        (Performance(battery_wh=56.6), 8.0, "iris"),
        (Performance(battery_wh=56.6), 14.0, "iris"),  # another one would drain its battery in no time
        (Performance(battery_wh=263.2, mass_kg=3.77), 8.0, "inspector"),
        (Performance(), 8.0, "iris"),
        (Performance(), 12.0, "iris"),  # it does 10, and says that it comes late
        (Performance(), 14.0, "inspector"),  # the Iris would come late, and say little else
        (Performance(mass_kg=4.0), 8.0, "inspector"),
        (Performance(), 40.0, "inspector"),  # nobody flies that: the fastest
    ],
)
def test_the_nearest_flies_of_those_that_fly_as_fast(performance: Performance, speed_mps: float, airframe: str) -> None:
    assert nearest_airframe(performance, speed_mps, CANDIDATES) == airframe
