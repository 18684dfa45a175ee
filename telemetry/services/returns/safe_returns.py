"""Safe returns of several UAVs, without obstructions and conflicts: by height, delay, or along the route."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat, distance_m
from mavlink.rtl import RtlBehaviour
from missions.models import Mission, MissionUav
from missions.services.commands.rtl_check import ReturnCheck, ReturnState, WaysNow
from missions.services.commands.start_slots import KEPT_SHARE
from planning.rules import SeparationRules
from planning.separation.separation import TimedRoute
from telemetry.alerting.returns_in_time import WAITS_S, StraightReturn, chosen_apart, flying_on
from telemetry.selectors.present import LastReceived
from telemetry.services.returns.along_route import AlongRoute

MAX_WIDENING_M = 100.0  # maximum by which uncertain positions widen the separation
MAX_WAIT_S = 600.0
MAX_WAIT_UNKNOWN_S = 120.0  # for a UAV with an unknown hold time
MAX_BATTERY_AGE_S = 30.0


@dataclass(frozen=True)
class BatteryAtLanding:
    """Percentages of the full battery. `unknown` is the reason if the rest at landing is unknown, else empty."""

    left_percent: float | None = None
    home_percent: float | None = None
    landing_percent: float | None = None
    reserve_percent: float | None = None
    hold_s: float | None = None
    unknown: str = ""

    @property
    def is_short(self) -> bool:
        known = self.landing_percent is not None and self.reserve_percent is not None
        return known and self.landing_percent < self.reserve_percent  # type: ignore[operator]


@dataclass(frozen=True)
class SafeReturn:
    """Parameters of a return without obstructions and conflicts: after a hold, at another height, or along the route."""

    height_m: float | None = None
    wait_s: float = 0.0
    along_route: bool = False

    @property
    def is_straight(self) -> bool:
        return self == SafeReturn()


@dataclass(frozen=True)
class ReturningUav:
    """A UAV in the air with its straight return; None if its position or destination is unknown."""

    received: LastReceived
    mission: Mission | None
    place: MissionUav | None
    check: ReturnCheck
    own: RtlBehaviour | None
    rally: Sequence[tuple[LonLat, float]] = ()
    home: LonLat | None = None
    straight: StraightReturn | None = None
    ways: WaysNow | None = None
    keeps_height: bool = False  # a change of its return height has just failed
    along: AlongRoute | None = None
    base_m: float = math.nan  # take-off altitude AMSL, the origin of its heights
    goal_m: float = 0.0  # its height above take-off on arrival at its landing place

    @property
    def uncertainty_m(self) -> float:
        return 0.0 if self.received.present is None else min(self.received.present.uncertainty_m, MAX_WIDENING_M)


def battery_at_landing(received: LastReceived) -> BatteryAtLanding:
    """Return the battery at landing by the estimator's forecast, or the reason why it is unknown."""
    values, forecast = {"uav": received.uav.name}, received.battery
    if received.is_in_air is False:
        return BatteryAtLanding(left_percent=received.battery_percent)
    if received.battery_percent is None:
        return BatteryAtLanding(unknown=_("%(uav)s reports no battery percentage.") % values)
    if forecast is None or received.battery_age_s is None or received.battery_age_s > MAX_BATTERY_AGE_S:
        words = _("The return energy of %(uav)s is calculated during a mission with telemetry only.")
        return BatteryAtLanding(left_percent=received.battery_percent, unknown=words % values)
    left, home, reserve = forecast["left_percent"], forecast["home_percent"], forecast["reserve_percent"]
    if home is None:
        words = _("Return energy of %(uav)s unknown: no position, or no headway against the wind.")
        return BatteryAtLanding(left, reserve_percent=reserve, unknown=words % values)
    return BatteryAtLanding(left, home, round(left - home, 1), reserve, forecast.get("hold_s"))


def along_landing_percent(one: ReturningUav, battery: BatteryAtLanding) -> float | None:
    """Return what is left after a return along the route, by the straight return's consumption per second."""
    if one.along is None or one.straight is None or battery.left_percent is None or battery.home_percent is None:
        return None
    per_s = battery.home_percent / max(one.straight.duration_s(), 1.0)
    return round(battery.left_percent - per_s * one.along.path.duration_s, 1)


def safest_returns(returning: Sequence[ReturningUav], others: Sequence[TimedRoute]) -> Mapping[int, SafeReturn | None]:
    """Return by UAV a return without conflicts; UAVs with the least spare battery choose first.

    others: routes of all others in the air. Preferred is straight at once if clear, then another height, then along the route, then a
    delay. A return along the route that lands below the reserve comes last, and is excluded if the battery does not last.
    """
    if not returning:
        return {}
    batteries = {one.received.uav.pk: battery_at_landing(one.received) for one in returning}

    def spare(one: ReturningUav) -> float:
        battery = batteries[one.received.uav.pk]
        return math.inf if battery.landing_percent is None else battery.landing_percent - (battery.reserve_percent or 0.0)

    in_order = sorted(returning, key=spare)
    choices = [_choices(one, batteries[one.received.uav.pk]) for one in in_order]
    planned = settings.SEPARATION_RULES
    widest_m = max(one.uncertainty_m for one in in_order)
    rules = SeparationRules(planned.lateral_m + 2.0 * widest_m, planned.vertical_m, KEPT_SHARE * planned.time_s)
    first = [one.straight.after(0.0) for one in in_order if one.straight is not None]
    flown = [[route for _way, route in of_uav] for of_uav in choices]
    chosen = chosen_apart(flown, others, rules, first)
    return {
        one.received.uav.pk: None if place is None else of_uav[place][0]
        for one, of_uav, place in zip(in_order, choices, chosen, strict=True)
    }


def _choices(one: ReturningUav, battery: BatteryAtLanding) -> list[tuple[SafeReturn, TimedRoute]]:
    """Return its unobstructed returns within its battery, the best first."""
    if one.straight is None:
        return []
    straight, uav = one.straight, one.received.uav.name
    is_clear, found = one.check.state == ReturnState.CLEAR, []
    heights = _heights(one)
    if is_clear:
        found.append((SafeReturn(), straight.after(0.0)))
    found += [(SafeReturn(height_m), raised.after(0.0)) for height_m, raised in heights]
    along, last = _along(one, straight, uav), []
    left_percent = along_landing_percent(one, battery)
    if left_percent is None or left_percent >= (battery.reserve_percent or 0.0):
        found += along
    elif left_percent > 0.0:
        last = along
    longest_s = MAX_WAIT_UNKNOWN_S if battery.hold_s is None else min(battery.hold_s, MAX_WAIT_S)
    waits = [wait_s for wait_s in WAITS_S if 0.0 < wait_s <= longest_s]
    if is_clear:
        found += [(SafeReturn(wait_s=wait_s), straight.after(wait_s)) for wait_s in waits]
    elif heights:
        found += [(SafeReturn(heights[0][0], wait_s), heights[0][1].after(wait_s)) for wait_s in waits]
    return [*found, *last]


def _along(one: ReturningUav, straight: StraightReturn, uav: str) -> list[tuple[SafeReturn, TimedRoute]]:
    if one.along is None or one.place is None:
        return []
    points = [(place, one.base_m + height_m, hold_s) for place, height_m, hold_s in one.along.points]
    return [(SafeReturn(along_route=True), flying_on(uav, points, straight.speed_mps, lands=True))]


def _heights(one: ReturningUav) -> list[tuple[float, StraightReturn]]:
    """Return settable return heights without obstructions, with their returns; at least the vertical separation apart."""
    own, present, straight = one.own, one.received.present, one.straight
    if one.keeps_height or own is None or one.ways is None or straight is None or present is None or present.altitude_relative_m is None:
        return []
    step_m = float(math.ceil(settings.SEPARATION_RULES.vertical_m)) + 1.0
    lowest_m = own.height_m + step_m if one.check.state == ReturnState.CLEAR else one.check.safe_height_m
    if lowest_m is None:
        return []
    away_m, goal_m = length_m(present.position, straight.goal), one.goal_m
    found = []
    for height_m in one.ways.clear_heights_m(own, lowest_m, step_m):
        level_m = own.at_height(height_m).level_m(present.altitude_relative_m, away_m, goal_m)
        found.append((height_m, replace(straight, level_m=one.base_m + level_m)))
    return found


def length_m(start: LonLat, end: LonLat) -> float:
    return float(distance_m(np.array([start]), np.array([end]))[0])
