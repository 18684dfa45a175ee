"""Photos of towers as they are flown: clear of swinging wires in strong wind, at their planned poses, and showing what the plan shows."""

from dataclasses import replace

import pytest

from planning.views.camera import Gimbal
from planning.views.detail_views import DetailSpeeds, detail_plan
from planning.views.limits import DetailRules
from simulation.rehearsing.weather_scenario import Named
from tests.planning.views.flown_photos import flown
from tests.planning.views.towers import TOWERS, ZOOM, standing

TOWER = "lattice, 110 kV, triangle"
HALF_A_TURN = Gimbal(-120.0, 45.0, -90.0, 90.0)


@pytest.mark.parametrize("gimbal", [ZOOM.gimbal, HALF_A_TURN], ids=["no pan", "pan to both sides"])
@pytest.mark.parametrize("turns_to_target", [True, False], ids=["PX4", "ArduPilot"])
@pytest.mark.parametrize("weather", [Named.CALM, Named.STRONG_WIND])
def test_photos_are_taken_where_and_as_they_were_planned(gimbal: Gimbal, turns_to_target: bool, weather: Named) -> None:
    camera, stands = replace(ZOOM, gimbal=gimbal), standing(TOWERS[TOWER])
    plan = detail_plan(stands.site, camera, DetailRules(0.004), DetailSpeeds())
    own = flown(stands, plan, camera, weather, turns_to_target=turns_to_target)
    assert own.taken == own.photos > 3
    assert own.spare_m >= 0.0
    assert own.away_m < 0.5
    assert own.off_deg < 1.0
    assert own.flown_share == pytest.approx(own.planned_share, abs=0.02)
