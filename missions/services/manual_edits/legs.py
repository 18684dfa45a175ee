"""Manually edited legs, remembered when the plan is dropped: their fixed endpoints and the points between."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from inspection.geodesy import LonLat
from inspection.models import Asset
from missions.models import Mission, Route, Waypoint
from planning.task import task_from_json
from planning.trajectory.waypoints import RoutePoint, WaypointKind

SAME_PLACE_DIGITS = 7  # of a degree: a centimetre

Step = dict[str, Any]


def step_row(waypoint: Waypoint) -> Step:
    """Return a waypoint as stored for an undo; its target by its place in the mission, which a copy shares."""
    return {
        "position": list(waypoint.position.coords),
        "agl_m": waypoint.altitude_agl_m,
        "kind": waypoint.kind,
        "asset": waypoint.asset_id,
        "target": None if waypoint.target is None else waypoint.target.sequence,
        "task": waypoint.task,
        "speed_mps": waypoint.speed_mps,
        "is_by_hand": waypoint.is_by_hand,
    }


def step_points(rows: Sequence[Step]) -> list[RoutePoint]:
    there = set(Asset.objects.filter(pk__in={row["asset"] for row in rows} - {None}).values_list("pk", flat=True))
    return [
        RoutePoint(
            LonLat(*row["position"]),
            WaypointKind(row["kind"]),
            row["agl_m"],
            row["asset"] if row["asset"] in there else None,
            row["target"],
            task_from_json(row["task"]),
            row["speed_mps"],
        )
        for row in rows
    ]


@dataclass(frozen=True)
class EditedLeg:
    """A leg from one fixed point of a route to the next, identified by what they are: start, target, end.

    points: between them, as from step_row; None: as planned. end_agl_m and end_speed_mps: of an edited end.
    """

    start: str
    end: str
    points: list[Step] | None
    is_end_by_hand: bool = False
    end_agl_m: float = 0.0
    end_speed_mps: float | None = None


def hand_legs_json(mission: Mission) -> list[dict[str, Any]]:
    """Return the edited legs of all routes, by the names of their UAVs; routes without any are left out."""
    targets = target_keys(mission)
    found = []
    for route in mission.routes.select_related("mission_uav"):
        legs = [vars(leg) for leg in _hand_legs(route, targets)]
        if legs:
            found.append({"uav": route.mission_uav.name, "legs": legs})
    return found


def hand_legs_from_json(value: Sequence[Mapping[str, Any]]) -> dict[str, list[EditedLeg]]:
    return {own["uav"]: [EditedLeg(**leg) for leg in own["legs"]] for own in value}


def target_keys(mission: Mission) -> dict[int, Any]:
    """Return what identifies each target, by its place in the mission, independent of the places."""
    return {
        target.sequence: [
            target.asset_id,
            None if target.position is None else list(target.position.coords),
            None if target.stretch is None else [list(end) for end in target.stretch.coords],
        ]
        for target in mission.targets.all()
    }


def legs_between(rows: Sequence[Step], targets: Mapping[int, Any]) -> Iterator[tuple[str, str, int, int]]:
    """Yield the fixed points at the ends of each leg, and their places in the route."""
    fixed = [place for place, row in enumerate(rows) if row["kind"] != WaypointKind.PASS or row["target"] is not None]
    for first, last in pairwise(fixed):
        yield _key(rows[first], targets), _key(rows[last], targets), first, last


def _key(row: Step, targets: Mapping[int, Any]) -> str:
    at = [round(degrees, SAME_PLACE_DIGITS) for degrees in row["position"][:2]]
    return json.dumps([row["kind"], None if row["target"] is None else targets.get(row["target"]), at])


def _hand_legs(route: Route, targets: Mapping[int, Any]) -> Iterator[EditedLeg]:
    rows = [step_row(row) for row in route.waypoints.select_related("target")]
    if not route.before_hand and not any(row["is_by_hand"] for row in rows):
        return
    planned = route.before_hand[0] if route.before_hand else rows
    before = {(start, end): planned[first + 1 : last] for start, end, first, last in legs_between(planned, targets)}
    for start, end, first, last in legs_between(rows, targets):
        points, own = rows[first + 1 : last], rows[last]
        is_other = any(row["is_by_hand"] for row in points) or _places(points) != _places(before.get((start, end), points))
        if is_other or own["is_by_hand"]:
            yield EditedLeg(start, end, points if is_other else None, own["is_by_hand"], own["agl_m"], own["speed_mps"])


def _places(rows: Sequence[Step]) -> list[tuple[float, ...]]:
    return [(*row["position"][:2], row["agl_m"]) for row in rows]
