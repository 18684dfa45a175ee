"""Which return is offered first, by what its battery allows."""

from typing import Any

import pytest

from inspection.geodesy import LonLat
from missions.models import MissionUav, Uav
from missions.services.commands.rtl_check import ReturnCheck, ReturnState
from telemetry.alerting.return_path import ReturnPath
from telemetry.alerting.returns_in_time import StraightReturn, flying_on
from telemetry.selectors.present import LastReceived
from telemetry.services.returns.along_route import AlongRoute
from telemetry.services.returns.safe_returns import ReturningUav, SafeReturn, safest_returns

HERE, NORTH, HOME = LonLat(10.01, 56.0), LonLat(10.01, 56.01), LonLat(10.0, 56.0)


def in_the_air(left_percent: float | None, state: ReturnState = ReturnState.IN_THE_WAY) -> ReturningUav:
    """Straight home takes 5 % of the battery, and along the route about four times as much; the reserve is 20 %."""
    battery: dict[str, Any] = {"left_percent": left_percent, "home_percent": 5.0, "reserve_percent": 20.0, "hold_s": 60.0}
    received = LastReceived(Uav(pk=1, name="Tern"), is_in_air=True, battery_percent=left_percent, battery=battery, battery_age_s=1.0)
    straight = StraightReturn("Tern", HERE, 60.0, HOME, 60.0, 0.0, 10.0)
    path = ReturnPath(1, 1, 10.0, 4_000.0, 4.0 * straight.duration_s(), ())
    along = AlongRoute(path, 1, ((HERE, 60.0, 0.0), (NORTH, 60.0, 0.0), (HOME, 60.0, 0.0)))
    check = ReturnCheck(place=0, name="Tern", uav=1, state=state)
    return ReturningUav(received, None, MissionUav(), check, None, straight=straight, along=along, base_m=0.0)


@pytest.mark.parametrize("left_percent", [None, 60.0, 30.0])
def test_along_the_route_where_straight_is_not_clear_and_the_battery_lasts_for_it(left_percent: float | None) -> None:
    assert safest_returns([in_the_air(left_percent)], []) == {1: SafeReturn(along_route=True)}


def test_along_the_route_is_not_offered_where_the_battery_does_not_last_for_it() -> None:
    assert safest_returns([in_the_air(18.0)], []) == {1: None}


def test_a_hold_comes_before_a_return_along_the_route_that_lands_below_the_reserve() -> None:
    crosses = flying_on("Kite", [(LonLat(10.005, 55.997), 60.0, 0.0), (LonLat(10.005, 56.003), 60.0, 0.0)], 10.0, lands=False)
    for left_percent, is_along in ((60.0, True), (30.0, False)):
        found = safest_returns([in_the_air(left_percent, ReturnState.CLEAR)], [crosses])[1]
        assert found is not None
        assert (found.along_route, found.wait_s > 0.0) == (is_along, not is_along)
