"""Whether the flight has changed since an offer was computed, so that it can no longer be accepted."""

from collections.abc import Iterable, Mapping
from datetime import datetime, timedelta
from typing import Any

from django.utils.dateparse import parse_datetime

from inspection.geodesy import LonLat
from missions.models import CommandAxis, CommandState, Mission, MissionState, ReplanOffer, Route, TargetState, UavCommand, Waypoint
from missions.selectors.ahead import RECEIVED_WITHIN_S
from missions.services.replanning.rest import HOLDING, LEFT, distance_apart_m
from operation.reasons import Reason
from planning.trajectory.remaining_route import NEAR_M, PassedPoint, place_on_route

VALID_FOR = timedelta(seconds=120)
MIN_LEFT_S = 15.0  # before a UAV reaches the point where it leaves its route: it must be held earlier


def basis_of(uavs: Iterable[int]) -> dict[str, Any]:
    """Return what an offer depends on besides its routes: each UAV's last flight command, by the UAV's key."""
    return {"orders": {str(key): last_order(key) for key in uavs}}


def last_order(uav_id: int) -> int:
    last = UavCommand.objects.filter(uav=uav_id, axis=CommandAxis.FLIGHT).order_by("-sequence").values_list("sequence", flat=True).first()
    return last or 0


def is_held(uav_id: int) -> bool:
    """Whether its last completed flight command is one that holds it in place."""
    done = UavCommand.objects.filter(uav=uav_id, axis=CommandAxis.FLIGHT, state=CommandState.APPLIED)
    return done.order_by("-sequence").values_list("kind", flat=True).first() in HOLDING


def valid_until(continuation: Mission, now: datetime) -> datetime:
    """Return when the first UAV comes too near to where it leaves its route, if all fly on; at most VALID_FOR from now."""
    left_s = [left for route in _routes(continuation) if (left := _left_s(route, now)) is not None]
    return min([now + VALID_FOR, *(now + timedelta(seconds=left) for left in left_s)])


def why_outdated(offer: ReplanOffer, now: datetime) -> Reason | None:
    """Return why the offer is outdated; None where it can still be accepted."""
    mission, continuation, difference = offer.mission, offer.continuation, offer.difference
    if mission.state != MissionState.ACTIVE:
        return Reason("mission_not_flying")
    valid_until = parse_datetime(difference.get("valid_until") or "")
    if continuation is None or valid_until is None or valid_until < now:
        return Reason("worked_out_too_long_ago")
    return (
        _other_orders(difference)
        or _targets_reached(mission, continuation, difference)
        or next(filter(None, (_elsewhere(route, now) for route in _routes(continuation))), None)
    )


def _other_orders(difference: Mapping[str, Any]) -> Reason | None:
    orders = (difference.get("basis") or {}).get("orders") or {}
    for uav in difference["uavs"]:
        key = str(uav["uav"])
        if key in orders and last_order(uav["uav"]) != orders[key]:
            return Reason("other_command_since", {"uav": uav["name"]})
    return None


def _targets_reached(mission: Mission, continuation: Mission, difference: Mapping[str, Any]) -> Reason | None:
    """Return a reason if a target that changes UAVs is done by now; targets before a UAV leaves its route are its own and do not count."""
    states = {target.sequence: target for target in mission.targets.all()}
    on_the_way = _done_on_the_way(continuation)
    for uav in difference["uavs"]:
        if uav["change"] != "changed":
            continue
        for target in uav["order"]:
            row = states[target]
            if target in uav["kept"] and row.label in on_the_way:
                continue
            if row.state not in LEFT and row.state != TargetState.FAILED:
                return Reason("target_done_meanwhile", {"target": row.label})
    return None


def _done_on_the_way(continuation: Mission) -> set[str]:
    return {
        waypoint.target.label
        for route in _routes(continuation)
        for waypoint in route.waypoints.all()
        if waypoint.target is not None and waypoint.sequence <= (route.begun_by or 0)
    }


def _routes(continuation: Mission) -> list[Route]:
    routes = continuation.routes.select_related("mission_uav__uav").prefetch_related("waypoints__target").filter(geometry__isnull=False)
    return list(routes)


def _elsewhere(route: Route, now: datetime) -> Reason | None:
    """Return a reason if the UAV has left the path that the offer keeps, or is too near to its end."""
    uav, values = route.mission_uav.uav, {"uav": route.mission_uav.name}
    if uav is None or uav.located_at is None or (now - uav.located_at).total_seconds() > RECEIVED_WITHIN_S:
        return Reason("place_unknown", values)
    at, points = LonLat(*uav.location.coords[:2]), _kept_points(route)
    away_m = distance_apart_m(points[0].position, at) if len(points) == 1 else place_on_route(points, at).away_m
    if away_m > NEAR_M:
        return Reason("not_as_reckoned", values)
    left_s = _left_s(route, uav.located_at)
    if left_s is not None and left_s < 0:
        return Reason("passed_diversion", values)
    return None


def _kept_points(route: Route) -> list[PassedPoint]:
    """Return the part of the route that the UAV already flies, up to where it leaves it."""
    return [_point(row) for row in route.waypoints.all() if row.sequence <= (route.begun_by or 0)]


def _left_s(route: Route, now: datetime) -> float | None:
    """Return the seconds until MIN_LEFT_S before the UAV leaves its route; None where it does not move or its position is unknown."""
    uav, points = route.mission_uav.uav, _kept_points(route)
    if uav is None or uav.location is None or uav.located_at is None or len(points) == 1 or is_held(uav.pk):
        return None
    here = place_on_route(points, LonLat(*uav.location.coords[:2]))
    return points[-1].arrival_s - here.at_s(points) - MIN_LEFT_S - (now - uav.located_at).total_seconds()


def _point(row: Waypoint) -> PassedPoint:
    return PassedPoint(LonLat(*row.position.coords[:2]), row.altitude_agl_m, row.arrival_s or 0.0, (row.task or {}).get("hold_s", 0.0))
