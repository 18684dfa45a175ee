"""The rest of a flying mission: where each UAV is, what it has still to do, and whether its route can change."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from typing import Any

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import WGS84
from missions.models import (
    Approval,
    CommandAxis,
    CommandKind,
    CommandState,
    InspectionTarget,
    LinkKind,
    Mission,
    Route,
    TargetState,
    Uav,
    UavCommand,
    Waypoint,
)
from missions.selectors.ahead import OFF_ROUTE_M, RECEIVED_WITHIN_S, first_ahead, passed_point
from missions.selectors.missions import approval_in_force
from missions.services.commands.flight_progress import FLIGHT_FAILED
from operation.reasons import Reason
from planning.trajectory.remaining_route import PassedPoint, PlaceOnRoute, place_on_route

AT_TARGET_M = 15.0  # within this distance a target in progress is still being done
LEFT = (TargetState.PENDING, TargetState.IN_PROGRESS)
HOLDING = (CommandKind.HOLD, CommandKind.PAUSE)
COMING_BACK = (CommandKind.RETURN, CommandKind.LAND, CommandKind.ABORT)


@dataclass(frozen=True)
class OfferCause:
    """Cause of an offer: `uav-out`, `zone-active`, `battery-short` or `asked-for`, with the UAV (by its key) or zone concerned."""

    code: str
    uav: int | None = None
    zone: int | None = None


@dataclass(frozen=True, eq=False)
class Rest:
    """The rest of one UAV. Targets are places in the mission, in the order in which it would do them.

    `trouble`: why it can only continue as it does, or not at all; None where it can get another route. `is_out`: it does not continue.
    `here` is None where its position is unknown. `ahead` are the targets whose point of the route is still before it.
    """

    route: Route
    uav: Uav | None
    rows: tuple[Waypoint, ...]
    points: tuple[PassedPoint, ...]
    here: PlaceOnRoute | None
    ahead: tuple[int, ...]
    is_out: bool
    is_held: bool
    trouble: Reason | None
    take_off: LonLat
    take_off_amsl_m: float | None
    battery_percent: float | None
    flown_m: float

    @property
    def place(self) -> int:
        return int(self.route.mission_uav.sequence)

    @property
    def name(self) -> str:
        return str(self.route.mission_uav.name)


def rests_of(mission: Mission, cause: OfferCause, now: datetime) -> list[Rest]:
    """Return the rests of UAVs that have targets left, or whose targets others must fly. The mission is as selectors load it."""
    approval = approval_in_force(mission)
    if approval is None:
        return []
    document = {route["uav"]: route for route in approval.document["routes"]}
    targets = {target.pk: target for target in mission.targets.all()}
    found = []
    for route in mission.routes.all():
        own = document.get(route.mission_uav.uav_id)
        if route.geometry is None or route.continued_by_id is not None or own is None:
            continue
        if route.flights_flown >= len(own["flights"]) and not route.has_failed:
            continue
        found.append(_rest(route, own, approval, targets, cause, now))
    return found


def _rest(
    route: Route, approved: Mapping[str, Any], approval: Approval, targets: Mapping[int, InspectionTarget], cause: OfferCause, now: datetime
) -> Rest:
    key = route.mission_uav.uav_id
    uav = None if key is None else Uav.objects.filter(pk=key).first()
    rows = tuple(route.waypoints.all())
    points = tuple(passed_point(row, targets) for row in rows)
    orders = _orders(uav, approval)
    trouble, is_out = _out(route, uav, orders, cause), True
    if not trouble:
        trouble, is_out = _bound(route, approved, uav, orders, now), False
    here = None
    first = first_ahead(rows, targets)
    if uav is not None and len(points) > 1:
        here = place_on_route(points, LonLat(*uav.location.coords[:2]), first=first)
        if here.away_m > OFF_ROUTE_M:
            trouble = trouble or Reason("off_route", {"uav": uav.name, "metres": round(here.away_m)})
            here = None
    take_off = approved["flights"][0]["take_off"]
    return Rest(
        route=route,
        uav=uav,
        rows=rows,
        points=points,
        here=here,
        ahead=_left(route, points, here, targets, is_whole=is_out),
        is_out=is_out,
        is_held=bool(orders) and orders[0].kind in HOLDING,
        trouble=trouble,
        take_off=LonLat(*take_off["position"]),
        take_off_amsl_m=take_off["altitude_amsl_m"],
        battery_percent=_percent(rows, here, uav),
        flown_m=_flown_m(route, here, points),
    )


def _orders(uav: Uav | None, approval: Approval) -> list[UavCommand]:
    """Return the flight commands that it got in this mission and has done, newest first; the oldest is its start."""
    if uav is None:
        return []
    done = UavCommand.objects.filter(uav=uav, axis=CommandAxis.FLIGHT, state=CommandState.APPLIED)
    start = done.filter(approval=approval, kind=CommandKind.START).order_by("-sequence").first()
    return [] if start is None else list(done.filter(sequence__gte=start.sequence).order_by("-sequence"))


def _out(route: Route, uav: Uav | None, orders: Sequence[UavCommand], cause: OfferCause) -> Reason | None:
    """Return why it does not continue; None where it does."""
    values = {"uav": route.mission_uav.name}
    if route.has_failed:
        return Reason("flight_failed", values)
    if uav is not None and cause.code == "uav-out" and cause.uav == uav.pk:
        return Reason("dropped_out", values)
    if orders and orders[0].kind in COMING_BACK:
        return Reason("coming_down", values)
    return None


def _bound(route: Route, approved: Mapping[str, Any], uav: Uav | None, orders: Sequence[UavCommand], now: datetime) -> Reason | None:
    """Return why it can only continue as it does; None where it can get another route in the air."""
    values = {"uav": route.mission_uav.name}
    if uav is None:
        return Reason("not_of_fleet", values)
    if uav.link != LinkKind.MAVLINK:
        return Reason("flown_by_companion", values)
    if not orders:
        return Reason("not_taken_off", values)
    if len(approved["flights"]) > 1:
        return Reason("several_flights", values)
    if uav.located_at is None or (now - uav.located_at).total_seconds() > RECEIVED_WITHIN_S:
        return Reason("place_unknown", values)
    return None


def _left(
    route: Route, points: Sequence[PassedPoint], here: PlaceOnRoute | None, targets: Mapping[int, InspectionTarget], *, is_whole: bool
) -> tuple[int, ...]:
    """Return the targets left. is_whole: all without a reported end, wherever the UAV is."""
    of_place = {target.sequence: target for target in targets.values()}
    order = list(dict.fromkeys(point.target for point in points if point.target is not None))
    left = []
    for place in order:
        state, reason = of_place[place].state, of_place[place].state_reason
        if state not in LEFT and not (route.has_failed and state == TargetState.FAILED and reason == FLIGHT_FAILED):
            continue
        last = max(number for number, point in enumerate(points) if point.target == place)
        is_done = here is not None and state == TargetState.IN_PROGRESS and last < here.ahead and not _is_at(points, last, here)
        if is_whole or not is_done:
            left.append(place)
    return tuple(left)


def _is_at(points: Sequence[PassedPoint], place: int, here: PlaceOnRoute) -> bool:
    """Whether it is still doing the task of a waypoint."""
    return here.ahead == place + 1 and distance_apart_m(points[place].position, here.position) <= AT_TARGET_M


def _percent(rows: Sequence[Waypoint], here: PlaceOnRoute | None, uav: Uav | None) -> float | None:
    """Return the remaining battery [%]: as reported, else as planned for this place; None where the battery is not computed."""
    if here is None or any(row.battery_left_percent is None for row in rows):
        return None
    if uav is not None and uav.battery_percent is not None:
        return uav.battery_percent
    before, after = (rows[place].battery_left_percent or 0.0 for place in (here.ahead - 1, here.ahead))
    return here.between(before, after)


def _flown_m(route: Route, here: PlaceOnRoute | None, points: Sequence[PassedPoint]) -> float:
    if here is None:
        return 0.0
    flown = sum(distance_apart_m(one.position, other.position) for one, other in pairwise(points[: here.ahead]))
    return flown + distance_apart_m(points[here.ahead - 1].position, here.position)


def distance_apart_m(one: LonLat, other: LonLat) -> float:
    return float(WGS84.inv(one.lon, one.lat, other.lon, other.lat)[2])
