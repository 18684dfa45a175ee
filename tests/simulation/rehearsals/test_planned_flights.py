"""What plans say of time and battery, against the same routes flown by JSBSim: within the bars of docs/performance.md."""

from collections.abc import Callable

import numpy as np
import pytest

from mavlink.approved_route import FrozenRoute
from tests.simulation.rehearsals.planned_flights import CALM, ROUGH, WINDY, air_of, climbs, compared, holds, mission, square, zigzag
from tests.telemetry.estimation.routes import lines_of

MAX_TIME_ERROR, MAX_ENERGY_ERROR = 0.15, 0.15  # of a flight, either way
MAX_MEAN_ERROR = 0.10
MIN_BY_TURNS, MAX_BY_TURNS = 0.95, 1.10
SPEEDS_MPS = {"iris": 5.0, "inspector": 10.0}


@pytest.mark.parametrize("code", ["iris", "inspector"])
@pytest.mark.parametrize(
    ("route", "air"),
    [(lambda mps: square(250.0, mps), CALM), (lambda mps: square(250.0, mps), WINDY), (lambda mps: holds(6, mps), CALM)],
    ids=["square", "square in wind", "holds"],
)
def test_a_flight_takes_what_was_planned(route: Callable[[float], FrozenRoute], air: str, code: str) -> None:
    found = compared(route(SPEEDS_MPS[code]), code, air_of(1, code, air), 1, physics_hz=100)
    assert abs(found.time_ratio - 1.0) <= MAX_TIME_ERROR
    assert abs(found.energy_ratio - 1.0) <= MAX_ENERGY_ERROR


@pytest.mark.long
@pytest.mark.parametrize(("code", "speed_mps", "leg_m"), [("inspector", 14.0, 150.0), ("inspector", 14.0, 30.0), ("iris", 6.0, 60.0)])
def test_sharp_turns_take_what_was_planned(code: str, speed_mps: float, leg_m: float) -> None:
    """Right angle after right angle: no more than 5 % too little, by the Iris, and 10 % too much, by the Inspector, which turns faster."""
    found = compared(zigzag(12, leg_m, speed_mps), code, air_of(1, code, CALM), 1, physics_hz=100)
    for ratio in (found.time_ratio, found.energy_ratio):
        assert MIN_BY_TURNS <= ratio <= MAX_BY_TURNS


def test_climbs_take_what_was_planned() -> None:
    found = compared(climbs(3, 5.0), "iris", air_of(1, "iris", CALM), 1, physics_hz=100)
    assert abs(found.time_ratio - 1.0) <= MAX_TIME_ERROR
    assert abs(found.energy_ratio - 1.0) <= MAX_ENERGY_ERROR


@pytest.mark.long
@pytest.mark.parametrize("air", [CALM, WINDY, ROUGH])
@pytest.mark.parametrize(
    "names",
    [
        pytest.param(["elme-valley.osm.pbf", "quillmoor.osm.pbf"], id="generated"),
        pytest.param(["columbus-ohio.osm.pbf", "nepal-power-2025.osm.pbf", "liechtenstein-2021-infra.osm.pbf"], id="real"),
    ],
)
def test_20_missions_along_lines_of_a_region_take_what_was_planned(names: list[str], region_file, air: str) -> None:
    lines = [line for name in names for line in lines_of(region_file(name))]
    found = []
    for seed in range(20):
        route, code = mission(seed, lines)
        found.append(compared(route, code, air_of(seed, code, air), seed))
    for ratios in ([one.time_ratio for one in found], [one.energy_ratio for one in found]):
        assert abs(float(np.mean(ratios)) - 1.0) <= MAX_MEAN_ERROR, ratios
        assert float(np.quantile(ratios, 0.05)) >= 0.90, ratios  # too little is what a battery cannot do with
