"""A route's points one after another, as plainly as the rules are said: what the compiled drawing is held against."""

from collections.abc import Sequence

from inspection.geodesy import LonLat
from planning.trajectory.route_points import SAME_PLACE_DEG, TargetPoints
from planning.trajectory.waypoints import RoutePoint, WaypointKind


def plain_route(
    start: LonLat, transit_agl_m: float, targets: Sequence[TargetPoints], ways: Sequence[Sequence[RoutePoint]], home: LonLat | None
) -> list[RoutePoint]:
    """As route_points; with a home the last of the ways leads there."""
    points = [RoutePoint(start, WaypointKind.START, transit_agl_m)]

    def add(point: RoutePoint) -> None:
        before = points[-1]
        here = _is_same_place(point.position, before.position)
        if before.agl_m < transit_agl_m and not here:
            points.append(RoutePoint(before.position, WaypointKind.PASS, transit_agl_m, before.asset))
        elif here and point.kind is WaypointKind.PASS and point.agl_m == before.agl_m:
            return
        points.append(point)

    for target, way in zip(targets, ways, strict=False):
        for node in way:
            add(node)
        entry = target.positions[0]
        add(RoutePoint(entry, WaypointKind.PASS, max(target.agl_m, transit_agl_m), target.asset))
        before = points[-1]
        if before.kind is WaypointKind.PASS and before.target is None and before.agl_m == target.agl_m:
            points.pop()
        points.append(RoutePoint(entry, WaypointKind.TARGET, target.agl_m, target.asset, target.target, target.task))
        for position in target.positions[1:]:
            if not _is_same_place(position, points[-1].position):
                points.append(RoutePoint(position, WaypointKind.PASS, target.agl_m, target.asset, target.target))
    if home is None:
        points.append(RoutePoint(points[-1].position, WaypointKind.END, points[-1].agl_m))
    else:
        for node in ways[-1]:
            add(node)
        add(RoutePoint(home, WaypointKind.END, transit_agl_m))
    return points


def _is_same_place(left: LonLat, right: LonLat) -> bool:
    return abs(left.lon - right.lon) <= SAME_PLACE_DEG and abs(left.lat - right.lat) <= SAME_PLACE_DEG
