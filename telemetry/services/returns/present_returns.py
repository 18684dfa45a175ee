"""Checks the returns of several UAVs at once from their positions, at their own RTL heights, with all other UAVs in the air."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from uuid import UUID

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.selectors import ground_heights_m
from missions.models import CommandKind, Route, Uav
from missions.services.approval.fence import rally_points
from missions.services.commands.rtl_check import ReturnCheck, ReturnState, reported_return, return_checks, ways_now
from missions.services.commands.staggered_returns import stuck_returns
from missions.services.commands.start_slots import KEPT_SHARE
from missions.services.commands.steering import mission_in_hand
from planning.clearance.rtl_paths import Places
from planning.request import EndAction
from planning.rules import SeparationRules
from planning.separation.separation import TimedRoute, conflicts
from telemetry.alerting.modes import ModeKind, mode_kind
from telemetry.alerting.returns_in_time import StraightReturn, flying_on, staying
from telemetry.selectors.in_the_air import reported_in_the_air
from telemetry.selectors.present import LastReceived, PresentPosition, last_received
from telemetry.services.returns.along_route import FURTHER, AlongRoute, along_route, on_board
from telemetry.services.returns.safe_returns import (
    BatteryAtLanding,
    ReturningUav,
    SafeReturn,
    along_landing_percent,
    battery_at_landing,
    length_m,
    safest_returns,
)

MAX_UNCERTAINTY_M = 300.0  # of a position, up to which its RTL path is checked
MAX_ALONG_UNCERTAINTY_M = 15.0


@dataclass(frozen=True)
class MetOnReturn:
    """A conflicting UAV. `vertical_m` is None if heights are unknown; `in_s` is from now."""

    uav: int
    name: str
    metres: float
    vertical_m: float | None
    in_s: float
    is_returning: bool


@dataclass(frozen=True)
class PresentReturn:
    """The return of one UAV. check.warnings list all obstructions.

    `present` None: its position is unknown, and its whole route was checked. along: the return by the rest of its approved route; None if
    not clear or unknown. safest: the best parameters of a return; None if no path is clear. Its `is_straight` is True if an immediate
    straight return is as good.
    """

    check: ReturnCheck
    mission: UUID | None
    present: PresentPosition | None
    distance_m: float | None
    duration_s: float | None
    level_m: float | None
    battery: BatteryAtLanding
    met: tuple[MetOnReturn, ...] = ()
    along: AlongRoute | None = None
    along_percent: float | None = None  # of its battery, left after landing along the route
    safest: SafeReturn | None = None

    @property
    def is_clear(self) -> bool:
        return self.check.state == ReturnState.CLEAR and not self.met and not self.battery.is_short


@dataclass
class _AirTraffic:
    """Straight returns of the requested UAVs, in their order, and the routes of all others in the air."""

    returning: list[ReturningUav]
    others: list[tuple[ReturningUav, TimedRoute]] = field(default_factory=list)


def present_returns(*, uavs: Sequence[Uav], now: datetime) -> list[PresentReturn]:
    """Return the check of each of these UAVs of one organisation, as if all were ordered to return now. Raises NoGraph."""
    refused = {command.uav_id for command in stuck_returns() if command.kind == CommandKind.SET_RETURN_HEIGHT}
    flown = [_checked(replace(_flown(received), keeps_height=received.uav.pk in refused), now) for received in last_received(uavs, now)]
    air = _AirTraffic([one for one in flown if one.straight is not None])
    air.others = _others(uavs, now)
    met, safest = _met(air), safest_returns(air.returning, [way for _other, way in air.others])
    found = []
    for one in flown:
        battery, others = battery_at_landing(one.received), met.get(one.received.uav.pk, ())
        warnings = (*one.check.warnings, *(_met_words(other) for other in others), *_battery_words(battery))
        found.append(
            PresentReturn(
                check=replace(one.check, warnings=warnings),
                mission=None if one.mission is None else one.mission.pk,
                present=one.received.present if one.straight is not None else None,
                distance_m=None if one.straight is None else length_m(one.straight.position, one.straight.goal),
                duration_s=None if one.straight is None else one.straight.duration_s(),
                level_m=_level_m(one),
                battery=battery,
                met=tuple(others),
                along=one.along,
                along_percent=along_landing_percent(one, battery),
                safest=safest.get(one.received.uav.pk),
            )
        )
    return found


def _battery_words(battery: BatteryAtLanding) -> list[str]:
    if not battery.is_short:
        return []
    values = {
        "left": f"{battery.left_percent:.0f}", "home": f"{battery.home_percent:.0f}",
        "landing": f"{battery.landing_percent:.0f}", "reserve": f"{battery.reserve_percent:.0f}",
    }  # fmt: skip
    if battery.landing_percent is not None and battery.landing_percent <= 0.0:
        return [_("Battery %(left)s %% is not enough for the return, which needs about %(home)s %%.") % values]
    return [_("It would land with about %(landing)s %% of its battery, below the reserve of %(reserve)s %%.") % values]


def _met_words(met: MetOnReturn) -> str:
    values = {"other": met.name, "metres": f"{met.metres:.0f}", "seconds": f"{met.in_s:.0f}"}
    if met.vertical_m is None:
        return _("Returning now, it comes within %(metres)s m of %(other)s in %(seconds)s s; their heights are not known.") % values
    values["vertical"] = f"{met.vertical_m:.0f}"
    words = _("Returning now, it comes within %(metres)s m across and %(vertical)s m in height of %(other)s in %(seconds)s s.")
    return words % values


# one UAV


def _flown(received: LastReceived) -> ReturningUav:
    """Return its position and straight return; its RTL path is not checked yet."""
    uav, present = received.uav, received.present
    mission = mission_in_hand(uav)
    place = None if mission is None else mission.mission_uavs.filter(uav=uav).first()
    rally = [] if mission is None or place is None else rally_points(mission, place.sequence)
    reported = reported_return(uav, uav.name, has_rally=bool(rally))
    one = ReturningUav(
        received, mission, place, reported.check(None if place is None else place.sequence, uav.name, uav.pk), reported.own, rally
    )
    home = received.home or (None if place is None else LonLat(*(place.home or place.start).coords[:2]))
    if present is None or present.altitude_relative_m is None or present.uncertainty_m > MAX_UNCERTAINTY_M or home is None:
        return one
    own, height_m, base_m = reported.own, present.altitude_relative_m, _base_m(received, home)
    goal, goal_m = _goal(present.position, home, rally, shuns_home=own is not None and own.shuns_home)
    level_m = math.nan if own is None else own.level_m(height_m, length_m(present.position, goal), goal_m)
    speed_mps = place.cruise_speed_mps if place is not None else uav.cruise_speed_mps or settings.FLIGHT_RULES.cruise_speed_mps
    straight = StraightReturn(uav.name, present.position, base_m + height_m, goal, base_m + level_m, _ground_m(goal, base_m), speed_mps)
    return replace(one, home=home, straight=straight, base_m=base_m, goal_m=goal_m)


def _checked(one: ReturningUav, now: datetime) -> ReturningUav:
    """Check its RTL path. A UAV on the ground has none."""
    received, present, own = one.received, one.received.present, one.own
    if received.is_in_air is False:
        words = _("It is on the ground.")
        return replace(one, check=replace(one.check, state=ReturnState.NOT_CHECKED, warnings=(words,)), straight=None)
    if one.straight is None or present is None or one.home is None:
        return replace(one, check=_from_route(one))
    straight, home = one.straight, one.home
    one = replace(one, along=_along(one, present, now))
    if own is None:
        return one
    positions = present.places()
    height_m = np.full(len(positions), present.altitude_relative_m)
    places = Places(positions, height_m, np.zeros(len(positions), dtype=np.int64))
    until = now + timedelta(seconds=straight.duration_s()) + FURTHER
    ways = ways_now(own, places, home, one.rally, (now.timestamp(), until.timestamp()))
    return replace(one, check=ways.checked(one.check, own), ways=ways)


def _along(one: ReturningUav, present: PresentPosition, now: datetime) -> AlongRoute | None:
    """Return its path along the route, only from a measured position: the leg from an uncertain one cannot be checked."""
    held = on_board(one.received.uav) if present.is_measured and present.uncertainty_m <= MAX_ALONG_UNCERTAINTY_M else None
    if held is None or present.altitude_relative_m is None:
        return None
    waypoint = one.received.waypoint_sequence
    return along_route(held, position=present.position, height_m=present.altitude_relative_m, waypoint=waypoint, now=now)


def _from_route(one: ReturningUav) -> ReturnCheck:
    """Return the check from its whole route, for a UAV at an unknown position."""
    if one.check.state != ReturnState.CLEAR:
        return one.check
    words = _("Position of %(uav)s too uncertain: its return path is not checked from there.") % {"uav": one.received.uav.name}
    along = [] if one.mission is None else [check for check in return_checks(one.mission) if check.place == one.check.place]
    if not along:
        return replace(one.check, state=ReturnState.UNKNOWN, warnings=(words,))
    state = ReturnState.UNKNOWN if along[0].state == ReturnState.CLEAR else along[0].state
    return replace(along[0], state=state, warnings=(words, *along[0].warnings))


def _goal(
    position: LonLat, home: LonLat, rally: Sequence[tuple[LonLat, float]], *, shuns_home: bool
) -> tuple[LonLat, float]:  # fmt: skip
    """Return where it flies to, and its height above take-off on arrival."""
    goals = [*rally] if shuns_home and rally else [(home, 0.0), *rally]
    return min(goals, key=lambda goal: length_m(position, goal[0]))


def _base_m(received: LastReceived, home: LonLat) -> float:
    """Return the altitude AMSL of its take-off: of the ground, else as reported; NaN if unknown."""
    ground_m = float(ground_heights_m(np.array([home]))[0])
    if not math.isnan(ground_m):
        return ground_m
    return math.nan if received.home_amsl_m is None else received.home_amsl_m


def _ground_m(goal: LonLat, base_m: float) -> float:
    ground_m = float(ground_heights_m(np.array([goal]))[0])
    return base_m if math.isnan(ground_m) else ground_m


def _level_m(one: ReturningUav) -> float | None:
    """Return its RTL height above take-off."""
    if one.straight is None or one.received.present is None or math.isnan(one.straight.level_m):
        return None
    return one.straight.level_m - one.base_m


# others


def _others(uavs: Sequence[Uav], now: datetime) -> list[tuple[ReturningUav, TimedRoute]]:
    """Return other UAVs of the organisation in the air with their routes from now on; simulated and real ones are not mixed."""
    returning_ids = {uav.pk for uav in uavs}
    organisations = {uav.organisation_id for uav in uavs}
    candidates = Uav.objects.filter(organisation__in=organisations, is_simulated__in={uav.is_simulated for uav in uavs}).exclude(
        pk__in=returning_ids
    )
    in_the_air = reported_in_the_air(list(candidates.values_list("pk", flat=True)))
    found = []
    for received in last_received(candidates.filter(pk__in=in_the_air), now):
        if received.present is None or received.present.altitude_relative_m is None:
            continue
        one = _flown(received)
        found.append((one, _going_on(one)))
    return found


def _going_on(one: ReturningUav) -> TimedRoute:
    """Return its route by its present mode: returning, along its route, or holding."""
    received, present = one.received, one.received.present
    assert present is not None  # noqa: S101 - checked by the caller
    mode = mode_kind(received.mode)
    if mode is ModeKind.RETURN and one.straight is not None:
        return one.straight.after(0.0)
    height_m = one.base_m + (present.altitude_relative_m or 0.0)
    ahead = _ahead(one) if mode in (ModeKind.MISSION, ModeKind.TAKE_OFF) else []
    if not ahead or one.place is None:
        return staying(received.uav.name, present.position, height_m)
    lands = one.place.mission.return_to_start or one.place.end_action != EndAction.HOVER
    return flying_on(received.uav.name, [(present.position, height_m, 0.0), *ahead], one.place.cruise_speed_mps, lands=lands)


def _ahead(one: ReturningUav) -> list[tuple[LonLat, float, float]]:
    """Return the remaining points of its route: position, altitude AMSL, hold seconds."""
    route = Route.objects.filter(mission=one.mission, mission_uav=one.place, geometry__isnull=False).first()
    if route is None or one.received.waypoint_sequence is None:
        return []
    points = route.waypoints.filter(sequence__gte=one.received.waypoint_sequence).order_by("sequence")
    rows = points.values_list("position", "altitude_relative_m", "task")
    return [
        (LonLat(*position.coords[:2]), one.base_m + altitude_m, float((task or {}).get("hold_s", 0.0)))
        for position, altitude_m, task in rows
    ]


# all of them


def _rules(one: ReturningUav, other: ReturningUav) -> SeparationRules:
    planned = settings.SEPARATION_RULES
    lateral_m = planned.lateral_m + one.uncertainty_m + other.uncertainty_m
    return SeparationRules(lateral_m, planned.vertical_m, KEPT_SHARE * planned.time_s)


def _met(air: _AirTraffic) -> Mapping[int, list[MetOnReturn]]:
    """Return by UAV the conflicts if all requested UAVs return at once, the earliest first."""
    found: dict[int, list[MetOnReturn]] = {one.received.uav.pk: [] for one in air.returning}
    at_once = [(one, one.straight.after(0.0)) for one in air.returning if one.straight is not None]
    pairs = [(one, other, True) for number, one in enumerate(at_once) for other in at_once[number + 1 :]]
    pairs += [(one, other, mode_kind(other[0].received.mode) is ModeKind.RETURN) for one in at_once for other in air.others]
    for (one, way), (other, others_way), is_returning in pairs:
        if one.received.uav.is_simulated != other.received.uav.is_simulated:
            continue
        for encounter in conflicts([way], [others_way], rules=_rules(one, other)):
            apart = round(encounter.metres, 1), None if encounter.vertical_m is None else round(encounter.vertical_m, 1)
            found[one.received.uav.pk].append(
                MetOnReturn(other.received.uav.pk, other.received.uav.name, *apart, round(encounter.at_s[0], 1), is_returning)
            )
            if other.received.uav.pk in found:
                found[other.received.uav.pk].append(
                    MetOnReturn(one.received.uav.pk, one.received.uav.name, *apart, round(encounter.at_s[1], 1), is_returning)
                )
    return {uav: sorted(met, key=lambda other: other.in_s) for uav, met in found.items()}
