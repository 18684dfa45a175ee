"""What wind, batteries and times add to small plans on a graph of 200,000 nodes.

    python -m benchmarks.planning.energy_speed [--write] [--near 200] [--anywhere 100]

The missions are those of `benchmarks.planning.plan_speed`: 2 UAVs, 4 targets. Plain is `plan_file`: positions to finished JSON by
metres. With
everything, the same plan has seconds and watt-hours of every way in both directions, in wind of two layers, and the assignment keeps
within the batteries. Where the routes are drawn, every waypoint gets its time and what is left of the battery, too. Like is compared with
like: plans not drawn, and plans drawn. With --write the table goes to docs/performance.md. Exits with 1 where a bar is missed.
"""

import argparse
import io
import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter, thread_time
from typing import Any

import numpy as np

from benchmarks.network.make_graph import make, missions
from benchmarks.report import machine, table, write_section
from inspection.geodesy import LonLat
from inspection.network.build.flyable import node_heights_m
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.legs import Attachments
from inspection.network.paths.along_paths import steps_of_graph
from inspection.network.paths.paths import PlaceLegs, travel_of_legs
from inspection.network.route_index import route_index
from planning.connection_points import TargetPaths
from planning.energy.assignment_costs import Finish, FlightCosts, FlownVisits, FlyingFleet, flight_costs
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import FlightClass, graph_taken
from planning.energy.performance import Performance
from planning.file_plans import FileGraph, plan_json, read_graph, read_mission
from planning.problem import End, Objective, Problem, Resources, Routes, UavStart, Visit
from planning.rules import FlightRules
from planning.solver.exact import best_routes
from planning.solver.problem_arrays import Arcs
from planning.task import Task, TaskKind
from planning.trajectory.heights import pass_agl_m, with_heights
from planning.trajectory.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs
from planning.trajectory.timing import timing
from planning.trajectory.warm_up import rehearse
from planning.trajectory.waypoints import Waypoints

UAVS, TARGETS = 2, 4
NEAR_M = 30_000.0
MAX_RATIO, MAX_SUMS_S = 3.0, 0.05
RULES = FlightRules()
AGL_M, HOLD_S = 60.0, 10.0
NO_LEGS = Attachments.of([])
# Far enough for any of the missions, so that plain and full plans answer the same question.
FLYING = FlightClass(Performance(battery_wh=90_000.0, max_airspeed_mps=20.0), 12.0)


def wind(number: int) -> Conditions:
    return Conditions((WindLayer(10.0, 4.0 + 0.1 * number, 270.0), WindLayer(100.0, 7.0 + 0.1 * number, 280.0)))


def inspection_graph(arrays: dict[str, Any]) -> InspectionGraph:
    nodes, edges = len(arrays["lat"]), len(arrays["u"])
    return InspectionGraph(
        version=1,
        ground_revision=1,
        position=np.column_stack([arrays["lon"], arrays["lat"]]),
        node_kind=np.full(nodes, NodeKind.SUPPORT, dtype=np.uint8),
        node_asset=np.arange(nodes, dtype=np.int64),
        node_height_m=np.full(nodes, np.nan),
        edge=np.column_stack([arrays["u"], arrays["v"]]).astype(np.int32),
        length_m=arrays["w"],
        cost=arrays["w"],
        edge_kind=np.full(edges, EdgeKind.LINE, dtype=np.uint8),
        edge_asset=np.full(edges, -1, dtype=np.int64),
        zone_wkb=(),
        zone_id=np.zeros(0, dtype=np.int64),
        zone_name=(),
    )


@dataclass(frozen=True)
class Parts:
    """Milliseconds of one mission's plan: plain; drawing its routes; what wind and batteries add to the first, and to the second."""

    plain: float
    drawing: float
    assigned: float
    timed: float

    @property
    def ratio(self) -> float:
        return (self.plain + self.assigned) / self.plain

    @property
    def drawn_ratio(self) -> float:
        return 1.0 + (self.assigned + self.timed) / (self.plain + self.drawing)


class Mission:
    """One mission in the steps of a plan, from what the plain plan has found by then."""

    def __init__(self, graph: InspectionGraph, plain: FileGraph, mission: dict[str, Any], conditions: Conditions) -> None:
        self.graph, self.plain, self.mission, self.conditions = graph, plain, mission, conditions
        asked = read_mission(plain, mission)
        joined, _ = plain.tree.nearest_of_each(asked.uavs)
        nodes = np.concatenate([joined, asked.targets]).astype(np.int32)
        places = np.arange(UAVS + TARGETS + 1)
        sinks = np.array([*range(UAVS, UAVS + TARGETS), *range(UAVS)], dtype=np.int64)
        travel = travel_of_legs(plain.index, PlaceLegs(places, nodes, np.zeros(len(nodes)), np.zeros(len(nodes))), places[:-1], sinks)
        self.ways = TargetPaths(travel, UAVS, TARGETS, (NO_LEGS,) * UAVS, (NO_LEGS,) * TARGETS, (NO_LEGS,) * TARGETS)
        self.starts = [LonLat(*place) for place in asked.uavs.tolist()]
        self.courses = [[LonLat(*graph.position[node].tolist())] for node in asked.targets]

    def parts(self) -> Parts:
        plain = milliseconds(lambda: plan_json(self.plain, self.mission, Objective.TOTAL, perf_counter))
        routes = best_routes(Arcs.of(problem_of(self.ways, self._costs())))
        assigned = milliseconds(lambda: best_routes(Arcs.of(problem_of(self.ways, self._costs()))))
        drawn = self._drawn(routes)
        return Parts(plain, milliseconds(lambda: self._drawn(routes)), assigned, milliseconds(lambda: self._timed(drawn)))

    def _costs(self) -> FlightCosts:
        return flight_costs(
            self.graph,
            self.ways,
            fleet=FlyingFleet([FLYING] * UAVS, [Finish(End.RETURN, lands=True)] * UAVS, self.starts),
            bases=[],
            visits=FlownVisits(self.courses, [AGL_M] * TARGETS, [HOLD_S] * TARGETS, [math.inf] * TARGETS),
            conditions=self.conditions,
            rules=RULES,
        )

    def _drawn(self, routes: Routes) -> list[Waypoints]:
        """As the planner draws routes over flat ground."""
        drawn = []
        for uav, route in enumerate(routes):
            if not route:
                continue
            nodes, first = self.ways.travel.paths(np.array(self.ways.of_route(uav, route, End.RETURN), dtype=np.int64))
            agl_m = pass_agl_m(node_heights_m(self.graph, nodes), RULES)
            points = route_points(
                start=self.starts[uav],
                transit_agl_m=RULES.transit_agl_m,
                targets=[TargetPoints(visit, tuple(self.courses[visit]), AGL_M, Task(TaskKind.HOLD, HOLD_S), None) for visit in route],
                ways=PassedNodes(self.graph.position[nodes], agl_m, self.graph.node_asset[nodes], first),
                home=self.starts[uav],
            )
            points, _ = with_short_legs(points, RULES.longest_leg_m)
            line_of(points)
            drawn.append(with_heights(points, None, RULES)[0])
        return drawn

    def _timed(self, drawn: list[Waypoints]) -> None:
        for waypoints in drawn:
            timing(
                waypoints,
                cruise_speed_mps=FLYING.cruise_speed_mps,
                performance=FLYING.performance,
                conditions=self.conditions,
                lands=True,
                rules=RULES,
            )


def problem_of(ways: TargetPaths, costs: FlightCosts) -> Problem:
    return Problem(
        uavs=(UavStart(None, End.RETURN, FLYING.cruise_speed_mps, usable_wh=FLYING.performance.usable_wh),) * UAVS,
        visits=tuple(Visit(target) for target in range(TARGETS)),
        target_count=TARGETS,
        from_start_m=ways.from_start_m,
        between_m=ways.between_m,
        to_start_m=ways.to_start_m,
        objective=Objective.TIME,
        seconds=Resources(**vars(costs.seconds)),
        wh=Resources(**vars(costs.wh)),
        class_of=costs.class_of,
    )


def milliseconds(run: Callable[[], Any]) -> float:
    """The least of five: what else the machine does only adds."""
    times = []
    for _ in range(5):
        began_s = perf_counter()
        run()
        times.append((perf_counter() - began_s) * 1e3)
    return min(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=200_000)
    parser.add_argument("--near", type=int, default=200, help="missions within 30 km")
    parser.add_argument("--anywhere", type=int, default=100, help="missions anywhere in a component")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    arrays = make(options.nodes)
    file = io.BytesIO()
    np.savez(file, **arrays)
    file.seek(0)
    plain, graph = read_graph(file), inspection_graph(arrays)
    route_index.remember(graph, plain.index)

    rehearse()  # so that nothing is compiled while it is measured

    def sums_s(number: int) -> float:
        began_s = thread_time()
        graph_taken(graph, FLYING, wind(number), RULES, None)
        return thread_time() - began_s

    began_s = thread_time()
    steps_of_graph(graph)
    steps_s = thread_time() - began_s
    sums = min(sums_s(number) for number in range(6, 0, -1))
    sums_s(0)
    rows, missed = [], []
    for name, radius_m, count in (("within 30 km", NEAR_M, options.near), ("anywhere", None, options.anywhere)):
        asked = missions(arrays, UAVS, TARGETS, count, radius_m=radius_m)
        parts = [Mission(graph, plain, mission, wind(0)).parts() for mission in asked]
        middle = [median(getattr(part, one) for part in parts) for one in ("plain", "assigned", "drawing", "timed")]
        ratios = [median(getattr(part, one) for part in parts) for one in ("ratio", "drawn_ratio")]
        rows.append([name, *(f"{one:.3f} ms" for one in middle), *(f"{one:.2f}" for one in ratios)])
        print(*rows[-1], sep="  ", flush=True)
        missed += [f"{name}: {one:.2f} times the plain plan" for one in ratios if one > MAX_RATIO]
    if sums > MAX_SUMS_S:
        missed.append(f"sums for a new wind: {sums * 1e3:.0f} ms")
    head = [f"2 UAVs, 4 targets, {options.nodes:,} nodes", "plain plan", "wind and batteries", "drawing it", "times at its waypoints"]
    head += ["times the plain plan", "times the plain plan, both drawn"]
    text = (
        "`python -m benchmarks.planning.energy_speed`, medians, each the least of five: the plain plan of `plan_file`; what seconds "
        "and watt-hours "
        "of every way there and back and an assignment within the batteries add; its routes drawn with heights; and time and battery at "
        f"each of their waypoints. A new wind on the graph takes {sums * 1e3:.0f} ms of a processor once, the first one "
        f"{steps_s * 1e3:.0f} ms more. {machine('numba', 'numpy')}\n\n{table(head, rows)}"
    )
    print(text)
    if options.write:
        write_section("Wind and batteries in small plans", text)
    if missed:
        raise SystemExit("missed: " + "; ".join(missed))


if __name__ == "__main__":
    main()
