"""The best plan that a search has found until now, as lines on the map: drawn while the search goes on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from inspection.network.paths.along_paths import passed_on
from operation.reasons import Reason
from planning.assignment.routing_input import RoutingInput
from planning.problem import End, Objective, Problem, Routes
from planning.solver.search import Progress
from planning.trajectory.heights import FloatArray

UNITS = {Objective.TOTAL: "m", Objective.MAKESPAN: "s", Objective.TIME: "s", Objective.ENERGY: "Wh"}
MAX_POINTS = 6_000  # of all lines together: some 150 kB, once a second


@dataclass(frozen=True)
class PlanProgress:
    """How far the making of a plan is; `draw` gives the best so far in the shape of `Job.best`."""

    share: float
    message: Reason
    draw: Callable[[], dict[str, Any] | None] | None = None


OnPlanProgress = Callable[[PlanProgress], None]


def no_progress(progress: PlanProgress) -> None:
    """For callers that do not watch."""


@dataclass(frozen=True, eq=False)
class Sketch:
    """Draws routes of visits along the network, without heights. `uavs`: the numbers in the request of those that fly."""

    routing: RoutingInput
    problem: Problem
    uavs: Sequence[int]

    def of(self, progress: Progress) -> dict[str, Any] | None:
        """None where there is nothing to draw."""
        return None if progress.best_routes is None else self._drawn(progress.best_routes, progress.bound)

    def _drawn(self, routes: Routes, bound: float | None) -> dict[str, Any]:
        problem = self.problem
        lines = {uav: self._line(uav, route) for uav, route in enumerate(routes) if route}
        step = max(1, -(-sum(map(len, lines.values())) // MAX_POINTS))
        return {
            "unit": UNITS[problem.objective],
            "value": round(problem.value(routes), 3),
            "bound": None if bound is None else round(bound, 3),
            "left_out": problem.target_count - len({problem.visits[visit].target for route in routes for visit in route}),
            "routes": {
                "type": "FeatureCollection",
                "features": [
                    {
                        "type": "Feature",
                        "properties": {"uav": self.uavs[uav], "targets": len(routes[uav])},
                        "geometry": {"type": "LineString", "coordinates": np.round(_thinned(line, step), 6).tolist()},
                    }
                    for uav, line in lines.items()
                ],
            },
        }

    def _line(self, uav: int, route: Sequence[int]) -> FloatArray:
        end = self.problem.uavs[uav].end
        routing, asked = self.routing, self.routing.request.uavs[self.uavs[uav]]
        taken = np.array(routing.ways.of_route(uav, route, end), dtype=np.int64)
        ways = passed_on(routing.ways.travel, taken, routing.airspace.graph.position)
        legs = np.split(ways.position, ways.first[1:-1])
        parts = [np.array([asked.position])]
        for leg, visit in zip(legs, route, strict=False):
            parts += [leg, np.array(routing.courses[visit])]
        if end is End.RETURN:
            parts += [legs[-1], np.array([asked.returns_to])]
        elif end is End.ANY_BASE:
            parts += [legs[-1], np.array([routing.bases[routing.ways.nearest_base[route[-1]]].position])]
        return np.concatenate(parts)


def _thinned(line: FloatArray, step: int) -> FloatArray:
    """Every so many points, and the last one."""
    kept: FloatArray = line[np.unique(np.append(np.arange(0, len(line), step), len(line) - 1))]
    return kept
