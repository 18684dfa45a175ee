"""Judges whether UAVs keep apart: no two samples of two routes, a second apart, are near in space and time.

The routes of a plan are compared with each other and with those of approved missions, read from the database row by row.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import timedelta
from itertools import combinations
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from missions.models import Mission, Route
from missions.services import PlanRequest
from tests.missions.oracles.clock_oracle import CLIMB_MPS, stays_s, tower_top_m
from tests.missions.plane import east_north

LATERAL_M, VERTICAL_M, TIME_S = 28.0, 13.5, 57.0  # of 30 m, 15 m and 60 s, less what lies between samples
OUTER_M, OUTER_HEIGHT_M, OUTER_S = 34.0, 16.5, 64.0  # and more
MAX_DURATION_S = 4 * 3_600.0  # who hovers without a battery of known energy does so for that long
FLYING = ("approved", "dispatched", "active")


def too_near(request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
    """UAVs that pass the same place at nearly the same time, though the plan does not say so, or of which it says so falsely."""
    own = [
        Flown(route, None, route["departs_s"] + stays_s(request, uav, route))
        for uav, route in zip(request.uavs, plan["routes"], strict=True)
        if route["waypoints"]
    ]
    others = list(_approved(request, max((one.until_s for one in own), default=0.0)))
    reported = {
        tuple(zip(item["uavs"], item["missions"], strict=True))
        for item in plan["separation"]["unresolved"]
        if item["code"] != "times_not_known"
    }
    for one, other in [*combinations(own, 2), *((one, other) for one in own for other in others)]:
        names = ((one.route["uav"], one.mission), (other.route["uav"], other.mission))
        is_reported = names in reported or names[::-1] in reported
        near = _nearest(
            one, other, (OUTER_M, OUTER_HEIGHT_M, OUTER_S) if is_reported else (LATERAL_M, VERTICAL_M, TIME_S), longest=is_reported
        )
        if near is not None and not is_reported:
            yield f"{names[0]} and {names[1]} pass one place {near[0]:.0f} s apart at {near[1]:.0f} s"
        if near is None and is_reported:
            yield f"{names[0]} and {names[1]} are said to be too near, and are not"


@dataclass(frozen=True)
class Flown:
    """A route, the mission that it belongs to where that is another one, and until when it is in the air for certain."""

    route: dict[str, Any]
    mission: str | None
    until_s: float

    def samples(self, origin: Any, other: "Flown", *, longest: bool) -> tuple[Any, Any]:
        """A UAV of the same plan that hovers is stayed clear of for as long as the other flies, whatever its battery does."""
        until_s = max(self.until_s, other.until_s) if other.mission == self.mission or longest else self.until_s
        return _samples(self.route, origin, until_s)


def _nearest(one: Flown, other: Flown, limits: tuple[float, float, float], *, longest: bool) -> tuple[float, float] | None:
    """The least seconds between the two where they are within the limits, and when that is."""
    lateral_m, vertical_m, time_s = limits
    origin = one.route["waypoints"][0]["position"]
    boxes = [np.array([point["position"] for point in flown.route["waypoints"]]) for flown in (one, other)]
    if (boxes[0].min(axis=0) > boxes[1].max(axis=0) + 0.001).any() or (boxes[1].min(axis=0) > boxes[0].max(axis=0) + 0.001).any():
        return None
    first, first_s = one.samples(origin, other, longest=longest)
    second, second_s = other.samples(origin, one, longest=longest)
    if first_s[0] > second_s[-1] + time_s or second_s[0] > first_s[-1] + time_s:
        return None
    near = cKDTree(first[:, :2]).sparse_distance_matrix(cKDTree(second[:, :2]), lateral_m, output_type="coo_matrix")
    heights_m = np.abs(first[near.row, 2] - second[near.col, 2])
    apart_s = np.abs(first_s[near.row] - second_s[near.col])
    bad = (heights_m < vertical_m) & (apart_s < time_s)
    if not bad.any():
        return None
    place = int(np.flatnonzero(bad)[apart_s[bad].argmin()])
    return float(apart_s[place]), float(first_s[near.row[place]])


def _approved(request: PlanRequest, ends_s: float) -> Iterator[Flown]:
    """Routes of the organisation's missions that are to be flown, in seconds after the departure of this one."""
    if request.departs_at is None or request.organisation is None:
        return
    near = {"departs_at__gt": request.departs_at - timedelta(hours=12), "departs_at__lt": request.departs_at + timedelta(seconds=ends_s)}
    for mission in Mission.objects.filter(organisation=request.organisation, state__in=FLYING, deleted_at=None, **near):
        if str(mission.pk) == request.mission:
            continue
        later_s = (mission.departs_at - request.departs_at).total_seconds()
        for row in mission.routes.filter(geometry__isnull=False):
            route = stored_route(row)
            route["departs_s"] += later_s
            route["arrival_s"] = [arrival_s + later_s for arrival_s in route["arrival_s"]]
            stays_s = MAX_DURATION_S if route["end_action"] == "hover" and route["energy_wh"] is None else route["duration_s"]
            yield Flown(route, str(mission.pk), route["departs_s"] + max(stays_s, route["duration_s"]))


def stored_route(row: Route) -> dict[str, Any]:
    """A row and its waypoints in the shape of a plan's route."""
    points = list(row.waypoints.order_by("sequence").values())
    targets = dict(row.mission.targets.values_list("pk", "sequence"))
    end_action = "return" if row.mission.return_to_start else row.mission_uav.end_action
    return {
        "uav": row.mission_uav.name, "end_action": end_action, "base": row.base_name or None, "departs_s": row.departs_s,
        "length_m": row.length_m, "duration_s": row.duration_s, "charging": row.charging, "energy_wh": row.energy_wh,
        "battery_percent": row.battery_percent,
        "arrival_s": [point["arrival_s"] for point in points],
        "used_wh": [point["used_wh"] for point in points],
        "battery_left_percent": [point["battery_left_percent"] for point in points],
        "targets": [targets[point["target_id"]] for point in points if point["kind"] == "target"],
        "waypoints": [
            {
                "position": list(point["position"].coords), "kind": point["kind"], "asset": point["asset_id"], "task": point["task"],
                "target": None if point["target_id"] is None else targets[point["target_id"]],
                "altitude_agl_m": point["altitude_agl_m"], "altitude_amsl_m": point["altitude_amsl_m"],
                "altitude_relative_m": point["altitude_relative_m"], "speed_mps": point["speed_mps"],
            }
            for point in points
        ],
    }  # fmt: skip


def _samples(route: dict[str, Any], origin: Any, until_s: float) -> tuple[Any, Any]:
    """East, north, height [m] each second in the air, and the seconds; a UAV that hovers at its end stays. Unknown ground is flat."""
    points = route["waypoints"]
    is_known = all(point["altitude_amsl_m"] is not None for point in points)
    heights = [point["altitude_amsl_m"] if is_known else 0.0 for point in points]
    grounds = [heights[end] - points[end]["altitude_agl_m"] if is_known else 0.0 for end in (0, -1)]
    places = [east_north(origin, point["position"]) for point in points]
    charging = {stop["waypoint"]: stop for stop in route["charging"]}
    ends_s = route["departs_s"] + route["duration_s"]
    knots = [(route["departs_s"], *places[0], grounds[0])]
    on_ground = []
    for number, (point, place, height, arrival_s) in enumerate(zip(points, places, heights, route["arrival_s"], strict=True)):
        knots.append((arrival_s, *place, height))
        leaves_s = arrival_s
        if number in charging:
            down_m = point["altitude_agl_m"] - tower_top_m(point)
            low_m, leaves_s = height - (down_m if is_known else 0.0), arrival_s + charging[number]["stopped_s"]
            knots += [(arrival_s + down_m / CLIMB_MPS, *place, low_m), (leaves_s - down_m / CLIMB_MPS, *place, low_m)]
            knots.append((leaves_s, *place, height))
        leaves_s += (point["task"] or {}).get("hold_s", 0.0)
        knots.append((leaves_s, *place, height))
        if point["kind"] == "base":
            on_ground.append((arrival_s, leaves_s))
    lands = route["end_action"] != "hover"
    knots.append((ends_s, *places[-1], grounds[1] if lands else heights[-1]))
    if not lands:
        knots.append((max(until_s, ends_s), *places[-1], heights[-1]))
    table = np.array(knots)
    moments = np.arange(table[0, 0], table[-1, 0] + 1.0)
    for landed_s, leaves_s in on_ground:
        moments = moments[(moments <= landed_s) | (moments >= leaves_s)]
    return np.column_stack([np.interp(moments, table[:, 0], table[:, column]) for column in (1, 2, 3)]), moments
