"""Judges finished plans by the rows of the database and arithmetic of its own: it shares no code with the planner or its last look.

Geometry is done in metres of a plane around the region, heights and times waypoint by waypoint, schedules instant by instant, the sun by
the short sunrise equation.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from missions.services import PlanRequest
from tests.missions.oracles.clock_oracle import stays_s, tower_top_m, wrong_clocks
from tests.missions.oracles.refusal_oracle import RefusalJudge, course_of
from tests.missions.oracles.return_oracle import ReturnJudge
from tests.missions.oracles.separation_oracle import too_near
from tests.missions.oracles.terrain_oracle import Hills, TallThings, wrong_heights
from tests.missions.oracles.wire_oracle import WireJudge
from tests.missions.oracles.zone_oracle import ZoneJudge, legs_of
from tests.missions.plane import apart_m


class Judge:
    """Of all plans on the zones and the ground that are in the database now."""

    def __init__(self, hills: Hills | None = None) -> None:
        self.hills = hills
        self.zones, self.tall = ZoneJudge(), TallThings()
        self.wires = WireJudge(None if hills is None else hills.metres)
        self.refusals = RefusalJudge(self.zones, self.tall, 0.0 if hills is None else hills.steepest)
        self.returns = ReturnJudge(self.zones, hills, self.wires)

    def faults(self, request: PlanRequest, plan: dict[str, Any]) -> list[str]:
        """All that is wrong with a plan."""
        return [*self.faults_of_routes(request, plan), *self.refusals.untrue(request, plan), *self.returns.faults(request, plan)]

    def faults_of_routes(self, request: PlanRequest, plan: dict[str, Any]) -> list[str]:
        """What is wrong with what is flown."""
        return [
            *self._crossings(request, plan),
            *_wrong_routes(request, plan),
            *wrong_clocks(request, plan),
            *wrong_heights(plan, self.hills),
            *too_near(request, plan),
        ]

    def _crossings(self, request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
        for uav, route in zip(request.uavs, plan["routes"], strict=True):
            if not route["waypoints"]:
                continue
            tops_m = {stop["waypoint"]: tower_top_m(route["waypoints"][stop["waypoint"]]) for stop in route["charging"]}
            legs = legs_of(route, request.departs_at, route["departs_s"] + stays_s(request, uav, route), tops_m)
            for number, zone in self.zones.met(legs):
                leg = legs[number]
                yield f"{route['uav']} meets {zone.name} on the leg from {leg.start}, {leg.agl_m, leg.amsl_m}, {leg.times}"


def _wrong_routes(request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
    """Each target once; targets where they are; lengths and ranges kept, flight by flight; ends where they should be."""
    visited = [target for route in plan["routes"] for target in route["targets"]]
    if sorted(visited + [item["target"] for item in plan["unassigned"]]) != list(range(len(request.targets))):
        yield "a target is visited twice or forgotten"
    for number, (uav, route) in enumerate(zip(request.uavs, plan["routes"], strict=True)):
        points = route["waypoints"]
        places = [waypoint["position"] for waypoint in points]
        flown_m = sum(apart_m(start, end) for start, end in pairwise(places))
        if abs(flown_m - route["length_m"]) > 0.006 * flown_m + 0.01:
            yield f"{uav.name} flies {flown_m:.0f} m, not {route['length_m']:.0f} m"
        if route["end_action"] != request.end_action(number):
            yield f"{uav.name} does not end as it should"
        if route["charging"] and uav.sorties > 1:
            yield f"{uav.name} charges at towers, though it may take a full battery at its base"
        if not places:
            continue
        is_one = all(point["kind"] != "base" for point in points)
        if uav.max_range_m is not None and (route["length_m"] if is_one else max(flights_m(points)) / 1.006) > uav.max_range_m:
            yield f"{uav.name} flies farther than it can"
        if apart_m(places[0], uav.position) > 1.0:
            yield f"{uav.name} does not start where it stands"
        if route["end_action"] == "return" and apart_m(places[-1], uav.position) > 1.0:
            yield f"{uav.name} does not return"
        if route["end_action"] == "base":
            bases = [base.position for base in request.bases if base.name == route["base"]]
            if not any(apart_m(places[-1], base) < 1.0 for base in bases):
                yield f"{uav.name} does not land at its base"
        at = {waypoint["target"]: waypoint["position"] for waypoint in points if waypoint["kind"] == "target"}
        if set(at) != set(route["targets"]):
            yield f"{uav.name} does not fly to its targets"
        last = next(point for point in reversed(points) if point["target"] is not None)
        ends = [last["position"], course_of(request, last["target"]).coords[-1], course_of(request, last["target"]).coords[0]]
        if route["end_action"] in {"land", "hover"} and min(apart_m(places[-1], end) for end in ends) > 0.2:
            yield f"{uav.name} does not end at its last target"
        for target, place in at.items():
            course = course_of(request, target)
            if course.geom_type == "Point" and apart_m(place, course.coords[0]) > 120.0:  # a place is taken to the line that it is on
                yield f"target {target} is elsewhere"


def flights_m(points: list[dict[str, Any]]) -> list[float]:
    """Metres of each flight of a route."""
    found = [0.0]
    for before, after in pairwise(points):
        if before["kind"] == "base":
            found.append(0.0)
        found[-1] += apart_m(before["position"], after["position"])
    return found
