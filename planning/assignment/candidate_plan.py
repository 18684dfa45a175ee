"""One answer to a request on one set of zones: what can be flown there, who does what, and how it is drawn."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from operation.reasons import Reason
from planning.airspace import Airspace, NamedZone, zone_at
from planning.assignment.assignment import LockCost, assignment, least_ready_s, solve_assignment
from planning.assignment.refusals import Grounding, deleted_target, groundings, refused_target, target_height_m
from planning.assignment.routing_input import costs_of_flying, needs_flight_costs, visits_of_targets
from planning.assignment.unassigned import explained_unassigned
from planning.connection_points import Terminal, paths_between
from planning.context import ResolvedTarget
from planning.energy.duration import target_s
from planning.plan import PlannedRoute, UnassignedTarget
from planning.problem import Problem, Solution
from planning.progress import OnPlanProgress, PlanProgress, Sketch
from planning.request import EndAction, InvalidRequest, PlanRequest
from planning.solver.search import OnProgress, Progress
from planning.solver.solver import Effort, Stop
from planning.trajectory.drawing import TrajectoryBuilder
from planning.trajectory.heights import inspection_agl_m


@dataclass(frozen=True, eq=False)
class CandidatePlan:
    """Who flies what, if the zones of the airspace are kept clear of; `uavs` are the numbers in the request of those that fly."""

    uavs: Sequence[int]
    grounded: Mapping[int, Grounding]
    left_out: Sequence[UnassignedTarget]
    solution: Solution
    lock_cost: LockCost | None
    drawing: TrajectoryBuilder
    problem: Problem

    @property
    def request(self) -> PlanRequest:
        return self.drawing.request

    @property
    def airspace(self) -> Airspace:
        return self.drawing.airspace

    @property
    def solver_calls(self) -> int:
        """With locked runs the plan without them is solved, too."""
        return 1 if self.lock_cost is None else 2

    def most_counted_wh(self, uav: int) -> float:
        """What the search thought that the UAV, by its number in the request, takes for the flight that takes most."""
        start = self.uavs.index(uav)
        return max((self.problem.route_wh(start, order) or 0.0 for order in self.solution.sorties[start]), default=0.0)

    def routes(self) -> list[PlannedRoute]:
        """Return the trajectories, one for each UAV of the request."""
        request, flown = self.request, self.drawing.routes(self.uavs, self.solution.sorties)
        return [flown.get(uav, PlannedRoute(end_action=request.end_action(uav))) for uav in range(len(request.uavs))]

    def drawn_alone(self, uav: int, order: Sequence[int]) -> PlannedRoute | None:
        """One flight of one UAV, by its number in the request, over these visits; None where the wind over the ground stops it."""
        alone = [(tuple(order),) if other == uav else () for other in self.uavs]
        try:
            return self.drawing.routes(self.uavs, alone)[uav]
        except InvalidRequest:
            return None

    def weights(self) -> list[float]:
        """What the ways of each UAV's route cost for each metre: 1 along infrastructure, more away from it."""
        weights = [1.0] * len(self.request.uavs)
        for start, (uav, orders) in enumerate(zip(self.uavs, self.solution.sorties, strict=True)):
            if orders:
                weights[uav] = self.drawing.weight(start, uav, orders)
        return weights


def candidate_plan(
    request: PlanRequest,
    airspace: Airspace,
    *,
    stop: Stop,
    on_progress: OnPlanProgress,
    effort: Effort,
    usable_share: Mapping[int, float],
    kept_from: Mapping[int, Collection[int]],
) -> CandidatePlan:
    """Return the assignment of the targets to the UAVs in one airspace. usable_share and kept_from as in `assignment`."""
    context = airspace.context
    refusals = {target.target: refused_target(target, airspace) for target in context.targets}
    left_out = [deleted_target(target) for target in context.deleted_targets]
    left_out += [refusal for refusal in refusals.values() if refusal is not None]
    targets = [target for target in context.targets if refusals[target.target] is None]
    grounded = groundings(request.uavs, airspace)
    uavs = [number for number in range(len(request.uavs)) if number not in grounded]
    bases = [base for base in request.bases if zone_at(base.position, airspace) is None]

    on_progress(PlanProgress(0.05, Reason("measuring_paths")))
    agl_m = [inspection_agl_m(target_height_m(target, airspace), airspace.flight) for target in targets]
    with_costs = needs_flight_costs(request)
    takes_s = None
    if not with_costs:
        slowest_mps = min((request.uavs[uav].cruise_speed_mps for uav in uavs), default=airspace.flight.cruise_speed_mps)
        takes_s = [
            target_s(height_m, _hovers_s(target, slowest_mps), slowest_mps, airspace.flight)
            for target, height_m in zip(targets, agl_m, strict=True)
        ]
    visits, courses = visits_of_targets(targets, takes_s)
    ways = paths_between(
        airspace.graph,
        airspace.leg_zones,
        starts=[Terminal(request.uavs[uav].position) for uav in uavs],
        entries=[Terminal(course[0], targets[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        exits=[Terminal(course[-1], targets[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        rules=airspace.access,
        bases=[Terminal(base.position) for base in bases],
        homes=[Terminal(request.uavs[uav].returns_to) for uav in uavs],
    )
    drawing = TrajectoryBuilder(request, airspace, targets, agl_m, visits, courses, ways, bases)
    costs = costs_of_flying(drawing, uavs) if with_costs else None
    ready = [
        0.0 if with_costs else least_ready_s(request.end_action(uav), request.uavs[uav].cruise_speed_mps, agl_m, airspace.flight)
        for uav in uavs
    ]
    no_landing = _no_landing(request, uavs, targets, airspace)
    asked = assignment(drawing, uavs, grounded, ready, costs, usable_share, no_landing, kept_from)
    sketch = Sketch(drawing, asked.problem, uavs)
    solution, lock_cost = solve_assignment(asked, stop=stop, on_progress=_passed_on(sketch, on_progress), effort=effort)
    left_out += explained_unassigned(solution.unassigned, drawing, uavs, asked, grounded, no_landing, kept_from)
    return CandidatePlan(uavs, grounded, left_out, solution, lock_cost, drawing, asked.problem)


def _hovers_s(target: ResolvedTarget, speed_mps: float) -> float:
    """How long a UAV stays beyond what its speed takes for the metres that are counted: those of a flight through photos."""
    return target.task.hold_s if target.photos is None else max(target.stays_s - target.photos.length_m / speed_mps, 0.0)


def _no_landing(request: PlanRequest, uavs: Sequence[int], targets: Sequence[ResolvedTarget], airspace: Airspace) -> dict[int, NamedZone]:
    """If a UAV is to land at its last target: targets, by their numbers, with a zone between the height of inspection and the ground."""
    if all(request.end_action(uav) is not EndAction.LAND for uav in uavs):
        return {}
    return {
        number: zone
        for number, target in enumerate(targets)
        for at in {target.course[0], target.course[-1]}
        if (zone := zone_at(at, airspace))
    }


def _passed_on(sketch: Sketch, on_progress: OnPlanProgress) -> OnProgress:
    """What the solver says of the search, in the words of the whole plan."""

    def hear(reported: Progress) -> None:
        draw = None if reported.best_routes is None else lambda: sketch.of(reported)
        on_progress(PlanProgress(0.1 + 0.85 * reported.share, reported.message, draw))

    return hear
