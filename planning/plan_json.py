"""A plan in the shape of the API."""

from collections.abc import Callable, Iterable, Sequence
from itertools import repeat
from typing import Any

import numpy as np
import orjson

from inspection.geodesy import path_length_m
from operation.reasons import Reason
from planning.energy.charging import ChargingStop
from planning.energy.conditions import conditions_to_json
from planning.plan import ALL_PLANS, Plan, PlannedRoute, PlanWarning, Shortfall
from planning.request import lock_to_json, moment_to_json
from planning.separation.report import separation_json
from planning.task import task_to_json
from planning.trajectory.heights import FloatArray
from planning.trajectory.waypoints import KINDS, NONE, PASS, IntArray, Waypoints

_OPENING, _NEXT, _CLOSING = b'[{"position":[', b'},{"position":[', b"}]"
_KIND = [f'],"kind":"{kind.value}","asset":'.encode() for kind in KINDS]
_NO_TARGET = b',"target":null,"task":null'
_PIECES = 4  # position, kind, asset, the rest
FLAT_GROUND = "flat ground assumed"
TERRAIN_MODEL = "terrain model"
_KIND_NAMES = [kind.value for kind in KINDS]
NO_QUALITY: dict[str, Any] = {
    "lower_bound_m": None, "lower_bound_s": None, "lower_bound_wh": None, "gap": None, "is_proven": False,
    "gap_of": ALL_PLANS, "method": "", "wish": None,
}  # fmt: skip
NO_SHORTFALL: dict[str, float | None] = {"missing_m": None, "missing_wh": None, "missing_s": None}


def waypoints_text(waypoints: Waypoints) -> orjson.Fragment:
    """What orjson writes of `waypoints_to_json`."""
    points = waypoints.points
    count = len(points)
    if not count:
        return orjson.Fragment(b"[]")
    pieces = [b""] * (_PIECES * count)
    pieces[0::_PIECES] = _text(points.position)[2:-2].split(b"],[")
    pieces[1::_PIECES] = [_KIND[PASS]] * count
    pieces[2::_PIECES] = _items(points.asset)
    pieces[3::_PIECES] = _heights(waypoints)
    is_plain = (points.kind == PASS) & (points.asset != NONE) & (points.target == NONE)
    for place in {*np.flatnonzero(~is_plain).tolist(), *points.task}:
        asset, target, task = points.asset[place], points.target[place], points.task.get(place)
        piece = _PIECES * place
        pieces[piece + 1] = _KIND[points.kind[place]]
        if asset == NONE:
            pieces[piece + 2] = b"null"
        if target != NONE or task is not None:
            words = orjson.dumps(None if target == NONE else int(target)), orjson.dumps(task and task_to_json(task))
            pieces[piece + 3] = b',"target":%b,"task":%b' % words + pieces[piece + 3].removeprefix(_NO_TARGET)
    text = b"".join(pieces)
    return orjson.Fragment(_OPENING + text[: -len(_NEXT)] + _CLOSING)


def line_text(line: FloatArray) -> orjson.Fragment:
    return orjson.Fragment(_text(line))


def column_text(values: FloatArray, digits: int) -> orjson.Fragment:
    """A column of numbers, so many digits behind the point."""
    return orjson.Fragment(_text(np.round(values, digits)))


def _heights(waypoints: Waypoints) -> list[bytes]:
    """The rest of each waypoint that does no target, and the beginning of the next one."""
    points = waypoints.points
    if waypoints.amsl_m is None and waypoints.relative_m is points.agl_m:  # over flat ground there are a few heights alone
        agl_m = points.agl_m.tolist()
        shown = {height_m: orjson.dumps(round(height_m, 2)) for height_m in set(agl_m)}
        ready = {height_m: _rest(text, b"null", text) for height_m, text in shown.items()}
        return [*ready.values()] * len(agl_m) if len(ready) == 1 else [ready[height_m] for height_m in agl_m]
    amsl_m = [b"null"] * len(points) if waypoints.amsl_m is None else _rounded(waypoints.amsl_m)
    return [_rest(*texts) for texts in zip(_rounded(points.agl_m), amsl_m, _rounded(waypoints.relative_m), strict=True)]


def _rest(agl_m: bytes, amsl_m: bytes, relative_m: bytes) -> bytes:
    heights = b',"altitude_agl_m":%b,"altitude_amsl_m":%b,"altitude_relative_m":%b' % (agl_m, amsl_m, relative_m)
    return _NO_TARGET + heights + _NEXT


def _rounded(heights_m: FloatArray) -> list[bytes]:
    return orjson.dumps([round(height_m, 2) for height_m in heights_m.tolist()])[1:-1].split(b",")


def _items(values: IntArray) -> list[bytes]:
    return _text(values)[1:-1].split(b",")


def _text(values: FloatArray | IntArray) -> bytes:
    return orjson.dumps(np.ascontiguousarray(values), option=orjson.OPT_SERIALIZE_NUMPY)


def plan_to_json(plan: Plan, *, as_text: bool = False) -> dict[str, Any]:
    """as_text: lines and waypoints are ready JSON, which orjson alone takes; it writes the same bytes as of plain lists."""
    coordinates: Callable[[FloatArray], Any]
    waypoints: Callable[[Waypoints], Any]
    coordinates, waypoints = (line_text, waypoints_text) if as_text else (line_to_json, waypoints_to_json)
    column = column_text if as_text else column_to_json
    request, routes = plan.request, plan.routes
    lengths_m = [round(route.length_m, 3) for route in routes]
    flat_ground_assumed = not plan.has_terrain or any(route.is_flat for route in routes)
    return {
        "objective": request.objective.value,
        "return_to_start": request.return_to_start,
        "total_length_m": round(sum(lengths_m), 3),
        "longest_route_m": max(lengths_m, default=0.0),
        "total_duration_s": round(sum(route.duration_s for route in routes), 1),
        "total_energy_wh": total_energy_wh(routes),
        "departs_at": moment_to_json(request.departs_at),
        "conditions": conditions_to_json(request.conditions),
        "separation": separation_json(plan.separation, plan.untimed_flights),
        "lost_link": plan.lost_link,
        "graph_version": plan.graph_version,
        "ground_revision": plan.map_version,
        "flat_ground_assumed": flat_ground_assumed,
        "terrain": FLAT_GROUND if flat_ground_assumed else TERRAIN_MODEL,
        **plan.quality,
        "locks": [lock_to_json(lock) for lock in request.locks],
        "warnings": [warning_to_json(warning) for warning in plan.warnings],
        "routes": [
            {
                "uav": uav.name,
                "uav_id": uav.uav,
                "end_action": route.end_action.value,
                "base": route.base,
                "length_m": length_m,
                "duration_s": round(route.duration_s, 1),
                **timing_to_json(route, column),
                "by_hand": [],
                "speeds_by_hand": [],
                "hand_steps": 0,
                "charging": [charging_to_json(stop) for stop in route.charging],
                "targets": list(route.targets),
                "locked": locked_targets(route.targets, (lock.targets for lock in request.locks if lock.uav == uav.name)),
                "explanation": explanation_json(route),
                "geometry": None if route.line is None else {"type": "LineString", "coordinates": coordinates(route.line)},
                "waypoints": [] if route.waypoints is None else waypoints(route.waypoints),
            }
            for uav, route, length_m in zip(request.uavs, routes, lengths_m, strict=True)
        ],
        "unassigned": [
            {"target": item.target, "reason": item.reason, **why_to_json(item.why), **shortfall_to_json(item.shortfall)}
            for item in sorted(plan.unassigned, key=lambda item: item.target)
        ],
    }


def explanation_json(route: PlannedRoute) -> dict[str, float] | None:
    if route.waypoints is None:
        return None
    points = route.waypoints.points
    return straight_json(points.position, points.kind, points.target, route.length_m)


def straight_json(position: FloatArray, kind: IntArray, target: IntArray, length_m: float) -> dict[str, float]:
    """As the crow flies from start over its targets to the end, stretches along their lines; and what is flown beyond that.

    position (n, 2), columns lon, lat [deg]; kind and target (n,) as in RoutePoints.
    """
    stops = position[(kind != PASS) | (target != NONE)]
    straight_m = path_length_m(np.ascontiguousarray(stops))
    return {"straight_m": round(straight_m, 1), "more_m": round(max(0.0, length_m - straight_m), 1)}


def why_to_json(why: Sequence[Reason]) -> dict[str, Any]:
    """The reasons, and their English text."""
    return {"message": " ".join(map(str, why)), "why": [reason.to_json() for reason in why]}


def warning_to_json(warning: PlanWarning) -> dict[str, Any]:
    return {"code": warning.code, "uav": warning.uav, **why_to_json([warning.why])}


def shortfall_to_json(shortfall: Shortfall | None) -> dict[str, float | None]:
    if shortfall is None:
        return dict(NO_SHORTFALL)
    return {
        "missing_m": None if shortfall.metres is None else round(shortfall.metres, 3),
        "missing_wh": None if shortfall.wh is None else round(shortfall.wh, 2),
        "missing_s": round(shortfall.seconds, 1),
    }


def total_energy_wh(routes: Sequence[PlannedRoute]) -> float | None:
    """Of the routes whose energy is counted; None if that is none of them."""
    counted = [route.timing.total_wh for route in routes if route.timing is not None and route.timing.total_wh is not None]
    return round(sum(counted), 2) if counted else None


def timing_to_json(route: PlannedRoute, column: Callable[[FloatArray, int], Any]) -> dict[str, Any]:
    """Arrival, energy and battery at each waypoint, column by column: they are as many as the waypoints."""
    timing = route.timing
    if timing is None:
        return {
            "departs_s": round(route.departs_s, 1), "energy_wh": None, "battery_percent": None, "arrival_s": [], "used_wh": None,
            "battery_left_percent": None,
        }  # fmt: skip
    return {
        "departs_s": round(route.departs_s, 1),
        "energy_wh": None if timing.total_wh is None else round(timing.total_wh, 2),
        "battery_percent": None if timing.end_percent is None else round(timing.end_percent, 1),
        "arrival_s": column(timing.arrival_s + route.departs_s, 1),
        "used_wh": None if timing.used_wh is None else column(timing.used_wh, 2),
        "battery_left_percent": None if timing.battery_left_percent is None else column(timing.battery_left_percent, 1),
    }


def charging_to_json(stop: ChargingStop) -> dict[str, Any]:
    return {
        "waypoint": stop.place,
        "charging_s": round(stop.charging_s, 1),
        "charged_wh": round(stop.charged_wh, 2),
        "stopped_s": round(stop.stopped_s, 1),
    }


def column_to_json(values: FloatArray, digits: int) -> list[float]:
    shown: list[float] = np.round(values, digits).tolist()
    return shown


def locked_targets(flown: Sequence[int], runs: Iterable[Sequence[int]]) -> list[int]:
    """Of the targets that a UAV flies those that are locked to it; runs are its locks."""
    locked = {target for run in runs for target in run}
    return [target for target in flown if target in locked] if locked else []


def line_to_json(line: FloatArray) -> list[Any]:
    coordinates: list[Any] = line.tolist()
    return coordinates


def waypoints_to_json(waypoints: Waypoints) -> list[dict[str, Any]]:
    points = waypoints.points
    agl_m = _shown(points.agl_m)
    tasks: list[dict[str, Any] | None] = [None] * len(points)
    for place, task in points.task.items():
        tasks[place] = task_to_json(task)
    return [
        {
            "position": position,
            "kind": _KIND_NAMES[kind],
            "asset": asset,
            "target": target,
            "task": task,
            "altitude_agl_m": shown_agl_m,
            "altitude_amsl_m": amsl_m,
            "altitude_relative_m": relative_m,
        }
        for position, kind, asset, target, task, shown_agl_m, amsl_m, relative_m in zip(
            points.position.tolist(),
            points.kind.tolist(),
            _numbers(points.asset),
            _numbers(points.target),
            tasks,
            agl_m,
            repeat(None, len(points)) if waypoints.amsl_m is None else _shown(waypoints.amsl_m),
            agl_m if waypoints.relative_m is points.agl_m else _shown(waypoints.relative_m),
            strict=True,
        )
    ]


def _numbers(column: IntArray) -> list[int | None]:
    numbers: list[int | None] = column.tolist()
    for place in np.flatnonzero(column == NONE).tolist():
        numbers[place] = None
    return numbers


def _shown(heights_m: FloatArray) -> list[float]:
    """In centimetres. Most points of a route are passed at one of a few heights."""
    values = heights_m.tolist()
    shown = {height_m: round(height_m, 2) for height_m in set(values)}
    return [shown[height_m] for height_m in values]
