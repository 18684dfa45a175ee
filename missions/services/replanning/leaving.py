"""Where a UAV leaves its route for another one, and with which battery."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from django.conf import settings

from inspection.geodesy import distance_m, path_length_m
from missions.services.replanning.rest import Rest
from operation.reasons import Reason, text_reason
from planning.energy.conditions import Conditions, air_density
from planning.energy.leg_cost import J_PER_WH, Air, hold_taken
from planning.energy.performance import InvalidPerformance, Performance, performance_from_json
from planning.request import EndAction, UavRequest
from planning.task import task_from_json
from planning.trajectory.remaining_route import HEIGHT_ROUNDING_M, where_to_leave
from planning.trajectory.waypoints import RoutePoint, WaypointKind

LEAD_S = 60.0  # from computing to flying: a user decides, the UAV is held and gets its route
WAIT_S = 90.0  # longest hover meanwhile, for the battery estimate
BESIDE_PHOTOS_M = 40.0  # of waypoints of a photo flight that is to be flown, or is being flown
MAX_RESERVE_PERCENT = 90.0  # that a plan can be asked to leave


class CannotLeave(Exception):
    """Raised when a UAV cannot leave its route, with the reason."""

    def __init__(self, reason: Reason) -> None:
        super().__init__(str(reason))
        self.reason = reason


@dataclass(frozen=True, eq=False)
class Leaving:
    """Plan to leave a route. `prefix` is flown first, on its approved route, from the UAV's position to where the new part begins.

    `amsl_m` are its heights above the sea, None where they are unknown; `targets` are done on it. `asked` is the UAV in the request for the
    rest, `stored` the UAV that the mission stores, with the values of the whole route.
    """

    rest: Rest
    prefix: tuple[RoutePoint, ...]
    amsl_m: tuple[float, ...] | None
    targets: tuple[int, ...]
    asked: UavRequest
    stored: UavRequest


def leaving_of(rest: Rest, conditions: Conditions, *, before: int | None = None) -> Leaving:
    """Return where the UAV leaves. before: the waypoint that it must not fly to any more. Raises CannotLeave."""
    if rest.here is None or rest.uav is None or rest.trouble:
        raise CannotLeave(rest.trouble or Reason("nobody_knows_where", {"uav": rest.name}))
    prefix, amsl_m = _prefix(rest, before)
    done = tuple(dict.fromkeys(point.target for point in prefix if point.target is not None))
    mission_uav = rest.route.mission_uav
    prefix_m = path_length_m(np.array([point.position for point in prefix])) if len(prefix) > 1 else 0.0
    performance = _performance(mission_uav.performance)
    waiting = _with_less(rest, performance, 100.0 - (rest.battery_percent or 0.0) + _waiting_percent(rest, performance, conditions, prefix))
    range_m = None if mission_uav.max_range_m is None else mission_uav.max_range_m - rest.flown_m
    if range_m is not None and range_m - prefix_m <= 0.0:
        raise CannotLeave(Reason("no_range_left", {"uav": rest.name}))
    stored = UavRequest(
        name=mission_uav.name,
        position=prefix[0].position,
        max_range_m=range_m,
        cruise_speed_mps=mission_uav.cruise_speed_mps,
        end_action=EndAction(mission_uav.end_action),
        uav=mission_uav.uav_id,
        sensors=tuple(mission_uav.sensors),
        performance=waiting,
        home=rest.take_off,
        own_figures=tuple(dict.fromkeys([*mission_uav.own_figures, "reserve_percent", "max_range_m"])),
    )
    asked = replace(
        stored,
        position=prefix[-1].position,
        max_range_m=None if range_m is None else range_m - prefix_m,
        performance=_with_less(rest, waiting, _planned_percent(rest, prefix)),
        most_targets=_most_targets(rest, len(done)),
    )
    return Leaving(rest, prefix, amsl_m, done, asked, stored)


def _prefix(rest: Rest, before: int | None) -> tuple[tuple[RoutePoint, ...], tuple[float, ...] | None]:
    """Return the prefix and its heights; the first point is the UAV's current position."""
    here, points, rows = rest.here, rest.points, rest.rows
    assert here is not None  # noqa: S101 - the caller has checked it
    last, ahead = rows[here.ahead - 1], rows[here.ahead]
    agl_m = here.between(last.altitude_agl_m, ahead.altitude_agl_m)
    begin = RoutePoint(here.position, WaypointKind.START, agl_m)
    transit_m = settings.FLIGHT_RULES.transit_agl_m
    in_stretch = last.target_id is not None and last.target_id == ahead.target_id
    photographed = {row.target_id for row in rows if (row.task or {}).get("view")}
    if (in_stretch and last.target_id in photographed) or _is_beside(rest, photographed):
        raise CannotLeave(Reason("takes_photos", {"uav": rest.name}))
    leave: int | None = here.ahead - 1
    if not rest.is_held or in_stretch or agl_m > transit_m + HEIGHT_ROUNDING_M:
        lead_s = 0.0 if rest.is_held else LEAD_S
        leave = where_to_leave(points, here, lead_s=lead_s, transit_agl_m=transit_m, before=before)
        if leave is None:
            raise CannotLeave(Reason("too_little_route_left", {"uav": rest.name}))
    first = here.ahead
    if not rest.is_held and last.kind == WaypointKind.TARGET and points[here.ahead - 1].target in rest.ahead:
        first -= 1  # it is still working there
    kept = range(first, (leave or 0) + 1) if leave is not None and leave >= first else range(0)
    entered: set[int | None] = set()
    prefix = [begin]
    for place in kept:
        target = points[place].target if points[place].target in rest.ahead else None
        is_entry = target is not None and target not in entered
        entered.add(target)
        kind = WaypointKind.TARGET if is_entry else WaypointKind.PASS
        row = rows[place]
        prefix.append(RoutePoint(points[place].position, kind, row.altitude_agl_m, row.asset_id, target, task_from_json(row.task)))
    heights = [row.altitude_amsl_m for row in (last, ahead, *(rows[place] for place in kept))]
    known = [height_m for height_m in heights if height_m is not None]
    if len(known) < len(heights) or rest.take_off_amsl_m is None:
        return tuple(prefix), None
    return tuple(prefix), (here.between(known[0], known[1]), *known[2:])


def _is_beside(rest: Rest, photographed: set[int | None]) -> bool:
    """Whether the UAV is beside photos that it takes or will take, whichever leg it is on: a new route would begin beside wires."""
    assert rest.here is not None  # noqa: S101 - the caller has checked it
    places = [
        point.position
        for point, row in zip(rest.points, rest.rows, strict=True)
        if row.target_id in photographed and point.target in rest.ahead
    ]
    away_m = distance_m(np.array(places).reshape(-1, 2), np.array([rest.here.position] * len(places)).reshape(-1, 2))
    return bool((away_m < BESIDE_PHOTOS_M).any())


def _performance(stored: dict[str, object]) -> Performance:
    try:
        return performance_from_json(stored)
    except InvalidPerformance as error:
        raise CannotLeave(text_reason(str(error))) from error


def _with_less(rest: Rest, performance: Performance, percent: float) -> Performance:
    """Return the performance with this share of the battery kept in addition to the reserve."""
    if performance.battery_wh is None:
        return performance
    reserve_percent = performance.reserve_percent + percent
    if reserve_percent > MAX_RESERVE_PERCENT:
        raise CannotLeave(Reason("too_little_battery_left", {"uav": rest.name}))
    return replace(performance, reserve_percent=max(reserve_percent, 0.0))


def _waiting_percent(rest: Rest, performance: Performance, conditions: Conditions, prefix: Sequence[RoutePoint]) -> float:
    if performance.battery_wh is None:
        return 0.0
    air = Air.of(performance, rest.route.mission_uav.cruise_speed_mps, conditions, settings.FLIGHT_RULES)
    density = air_density(0.0, float(conditions.temperature_c))
    taken = hold_taken(WAIT_S, prefix[0].agl_m, density, air)
    return 100.0 * float(taken[1]) / J_PER_WH / performance.battery_wh


def _planned_percent(rest: Rest, prefix: Sequence[RoutePoint]) -> float:
    """Return the battery share that was planned for the prefix."""
    here, left = rest.here, [row.battery_left_percent for row in rest.rows]
    if here is None or any(percent is None for percent in left):
        return 0.0
    places = [place for place in range(here.ahead, len(rest.rows)) if rest.points[place].position == prefix[-1].position]
    if not places or len(prefix) == 1:
        return 0.0
    return max(0.0, here.between(left[here.ahead - 1] or 0.0, left[here.ahead] or 0.0) - (left[places[0]] or 0.0))


def _most_targets(rest: Rest, more: int) -> int | None:
    """Return how many targets it may do after the prefix, if the mission limits them."""
    most = rest.route.mission_uav.most_targets
    if most is None:
        return None
    own = {point.target for point in rest.points if point.target is not None}
    left = most - (len(own) - len(rest.ahead)) - more
    if left <= 0:
        raise CannotLeave(Reason("does_as_many_as_it_may", {"uav": rest.name}))
    return left
