"""Manual edits of a route: waypoints moved, added, removed, set higher or to another speed; checked like any other route, and undoable."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from django.contrib.gis.geos import LineString, Point
from django.db import transaction
from django.db.models import Q
from django.utils.translation import gettext as _
from numpy.typing import NDArray

from missions.models import Mission, Route, Waypoint
from missions.services.manual_edits.checks import (
    ManualEditContext,
    faults_as_flown,
    flown_manual_edit,
    manual_edit_context,
    obstacle_faults,
    point_faults,
)
from missions.services.manual_edits.legs import step_points, step_row
from missions.services.manual_edits.points import EditedPoint, are_by_hand, list_faults, route_points
from missions.services.manual_edits.still_separated import separation_of_stored
from missions.services.manual_edits.stored_route import kept_waypoints
from missions.services.missions import check_lost_link, lock_mission, note, request_of_mission
from planning.plan import PlannedRoute
from planning.request import InvalidRequest
from planning.task import task_to_json
from planning.trajectory.waypoints import RoutePoints
from workspace.models import User

BY_HAND = "by hand"  # the method of a plan with a route that was edited
MAX_STEPS = 5  # that can be undone


def change_route(
    *, mission: Mission, actor: User, uav: int, points: Sequence[EditedPoint], expected_revision: int | None = None
) -> Mission:
    """Route one UAV, by its place in the mission, over these points. Its targets and their order stay.

    Raises InvalidRequest with the faults by place (a point too low or too high, a leg that meets a zone, a speed impossible in the wind, an
    insufficient battery), MissionChanged or MissionFrozen. Nothing is stored then.
    """
    with transaction.atomic():
        locked, route = _locked_route(mission, uav, expected_revision)
        rows, ground = list(route.waypoints.select_related("asset", "target")), manual_edit_context()
        until_now = kept_waypoints(rows)
        _refuse(list_faults(points, until_now) or point_faults(points, until_now, ground))
        if len(route.before_hand) == MAX_STEPS:  # the planned route is dropped, and what was proven of it
            locked.plan_quality = {name: value for name, value in (locked.plan_quality or {}).items() if name != "planned"}
        route.before_hand = [*route.before_hand, [step_row(row) for row in rows]][-MAX_STEPS:]
        wished = route_points(points, until_now)
        by_hand = np.array(are_by_hand(points, until_now), dtype=np.bool_)
        _fly(locked, route, wished, by_hand, ground)
        note(locked, actor, "by-hand", before=None, after={"revision": locked.revision, "uav": route.mission_uav.name})
    return locked


def take_back_change(*, mission: Mission, actor: User, uav: int, expected_revision: int | None = None) -> Mission:
    """Undo the last manual edit of a route and check the result against current data. Raises as change_route."""
    with transaction.atomic():
        locked, route = _locked_route(mission, uav, expected_revision)
        if not route.before_hand:
            raise InvalidRequest({"uav": _("No change by hand of this route can be taken back.")})
        *route.before_hand, rows = route.before_hand
        points = step_points(rows)
        by_hand = np.array([row["is_by_hand"] for row in rows], dtype=np.bool_)
        _fly(locked, route, RoutePoints.of(points), by_hand, manual_edit_context())
        note(locked, actor, "by-hand-undone", before=None, after={"revision": locked.revision, "uav": route.mission_uav.name})
    return locked


def _locked_route(mission: Mission, uav: int, expected_revision: int | None) -> tuple[Mission, Route]:
    locked = lock_mission(mission_id=mission.pk, expected_revision=expected_revision)
    route = locked.routes.select_related("mission_uav").filter(mission_uav__sequence=uav, geometry__isnull=False).first()
    if route is None:
        raise InvalidRequest({"uav": _("This UAV flies no route.")})
    if route.charging:
        raise InvalidRequest({"uav": _("A route with stops to charge cannot be changed by hand.")})
    return locked, route


def checked_manual_edit(
    locked: Mission, route: Route, wished: RoutePoints, by_hand: NDArray[np.bool_], ground: ManualEditContext
) -> PlannedRoute:
    """Return the route over these points as it is flown. by_hand (n,): points that a user edited.

    Raises InvalidRequest with the faults of the first check that fails.
    """
    _refuse(obstacle_faults(wished, ground))
    request, uav = request_of_mission(mission=locked), route.mission_uav.sequence
    flown = flown_manual_edit(request, uav, wished, by_hand, route.departs_s, ground)
    for faults in faults_as_flown(flown, wished, locked, request, uav, ground):
        _refuse(faults)
    return flown


def _fly(locked: Mission, route: Route, wished: RoutePoints, by_hand: NDArray[np.bool_], ground: ManualEditContext) -> None:
    """Check the points, store them as the route, and update the mission. by_hand (n,): the points that a user edited."""
    store_manual_edit(locked, route, checked_manual_edit(locked, route, wished, by_hand, ground), places_of(wished, by_hand))
    settle_manual_edits(locked)
    locked.revision += 1
    locked.save()


def settle_manual_edits(locked: Mission) -> None:
    """Update the mission after edited routes; the caller saves it."""
    locked.total_length_m = round(sum(own.length_m for own in locked.routes.all()), 3)
    locked.longest_route_m = max(own.length_m for own in locked.routes.all())
    counted = [own.energy_wh for own in locked.routes.all() if own.energy_wh is not None]
    locked.total_energy_wh = round(sum(counted), 2) if counted else None
    locked.separation = separation_of_stored(locked)
    check_lost_link(mission=locked)
    locked.plan_quality = _quality(locked)


def _quality(mission: Mission) -> dict[str, Any]:
    """Return the plan's quality: unproven while any route is edited; once every edit is undone, the planned quality returns."""
    quality = mission.plan_quality or {}
    planned = quality.get("planned", quality)
    by_hand = Q(waypoints__is_by_hand=True) | ~Q(before_hand=[])  # a removed waypoint leaves no other trace
    if not mission.routes.filter(by_hand).exists():
        return dict(planned)
    return planned | {"is_proven": False, "gap": None, "method": BY_HAND, "planned": planned}


def _refuse(faults: dict[str, str]) -> None:
    if faults:
        raise InvalidRequest(faults)


def store_manual_edit(mission: Mission, route: Route, flown: PlannedRoute, by_hand: set[tuple[float, float, float]]) -> None:
    """Store an edited route. by_hand: places of the waypoints that a user edited, as `place_of` returns them."""
    assert flown.waypoints is not None and flown.timing is not None and flown.line is not None  # noqa: S101 - drawn before
    targets: dict[int, int] = dict(mission.targets.values_list("sequence", "pk"))
    clock = flown.timing
    route.geometry = LineString(flown.line.tolist(), srid=4326)
    route.length_m, route.duration_s = round(flown.length_m, 3), round(flown.duration_s, 1)
    route.energy_wh = None if clock.total_wh is None else round(clock.total_wh, 2)
    route.battery_percent = None if clock.end_percent is None else round(clock.end_percent, 1)
    route.save()
    route.waypoints.all().delete()
    Waypoint.objects.bulk_create(
        (
            Waypoint(
                route=route,
                sequence=number,
                kind=waypoint.point.kind,
                position=Point(*waypoint.point.position, srid=4326),
                asset_id=waypoint.point.asset,
                target_id=None if waypoint.point.target is None else targets[waypoint.point.target],
                task=None if waypoint.point.task is None else task_to_json(waypoint.point.task),
                altitude_agl_m=round(waypoint.point.agl_m, 2),
                altitude_amsl_m=None if waypoint.amsl_m is None else round(waypoint.amsl_m, 2),
                altitude_relative_m=round(waypoint.relative_m, 2),
                arrival_s=round(float(clock.arrival_s[number]) + route.departs_s, 1),
                used_wh=None if clock.used_wh is None else round(float(clock.used_wh[number]), 2),
                battery_left_percent=None if clock.battery_left_percent is None else round(float(clock.battery_left_percent[number]), 1),
                speed_mps=waypoint.point.speed_mps,
                is_by_hand=waypoint.point.speed_mps is not None or place_of(waypoint.point.position, waypoint.point.agl_m) in by_hand,
            )
            for number, waypoint in enumerate(flown.waypoints)
        ),
        batch_size=1_000,
    )


def places_of(points: RoutePoints, by_hand: NDArray[np.bool_]) -> set[tuple[float, float, float]]:
    """Return the places of the chosen points."""
    return {place_of(points.position[place].tolist(), float(points.agl_m[place])) for place in np.flatnonzero(by_hand)}


def place_of(position: Sequence[float], agl_m: float) -> tuple[float, float, float]:
    return round(position[0], 9), round(position[1], 9), round(agl_m, 2)
