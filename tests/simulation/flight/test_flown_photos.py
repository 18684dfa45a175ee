"""Photos of towers as they are flown: clear of swinging wires in strong wind, at their planned poses, and showing what the plan shows."""

from dataclasses import replace
from functools import cache

import pytest

from planning.views.camera import Camera, Gimbal
from planning.views.limits import DetailRules
from planning.views.view_plan import ViewPlan, ViewSpeeds, detail_plan
from simulation.rehearsing.weather_scenario import Named
from tests.planning.views.flown_photos import flown
from tests.planning.views.towers import TOWERS, ZOOM, standing

TOWER = "lattice, 110 kV, triangle"
HALF_A_TURN = Gimbal(-120.0, 45.0, -90.0, 90.0)


@cache
def planned(camera: Camera) -> ViewPlan:
    return detail_plan(standing(TOWERS[TOWER]).site, camera, DetailRules(0.004), ViewSpeeds())


@pytest.mark.long
@pytest.mark.parametrize(
    ("gimbal", "turns_to_target", "weather"),
    [
        (ZOOM.gimbal, True, Named.STRONG_WIND),
        (HALF_A_TURN, False, Named.STRONG_WIND),
        (HALF_A_TURN, True, Named.CALM),
        (ZOOM.gimbal, False, Named.CALM),
        pytest.param(ZOOM.gimbal, True, Named.CALM, marks=pytest.mark.long),
        pytest.param(HALF_A_TURN, False, Named.CALM, marks=pytest.mark.long),
        pytest.param(HALF_A_TURN, True, Named.STRONG_WIND, marks=pytest.mark.long),
        pytest.param(ZOOM.gimbal, False, Named.STRONG_WIND, marks=pytest.mark.long),
    ],
)
def test_photos_are_taken_where_and_as_they_were_planned(gimbal: Gimbal, turns_to_target: bool, weather: Named) -> None:
    """Each pair of gimbal, autopilot (PX4 turns its nose to a target) and weather; all triples with the long tests."""
    camera = replace(ZOOM, gimbal=gimbal)
    own = flown(standing(TOWERS[TOWER]), planned(camera), camera, weather, turns_to_target=turns_to_target)
    assert own.taken == own.photos > 3
    assert own.spare_m >= 0.0
    assert own.away_m < 0.5
    assert own.off_deg < 1.0
    assert own.flown_share == pytest.approx(own.planned_share, abs=0.02)
