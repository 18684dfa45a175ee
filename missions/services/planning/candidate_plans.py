"""One answer to a request on one set of zones: what can be flown there, who does what, and how it is drawn."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from missions.models import EndAction
from missions.services.planning.best_so_far import OnPlanProgress, PlanProgress, Sketch
from missions.services.planning.drawing import Drawing
from missions.services.planning.path_costs import counted, needs_counting
from missions.services.planning.plan_json import PlannedRoute
from missions.services.planning.requests import InvalidRequest, PlanRequest
from missions.services.targets.assignment import LockCost, assignment, least_ready_s, solve_assignment
from missions.services.targets.places import Place
from missions.services.targets.refusals import Grounding, LeftOut, Scene, asset_gone, groundings, place_height_m, refused_place, zone_at
from missions.services.targets.unassigned import unreached_places
from missions.services.targets.visits import visits_of_places
from planning.connection_points import Terminal, ways_between
from planning.energy.duration import target_s
from planning.problem import Problem, Solution
from planning.solver.search import OnProgress, Progress
from planning.solver.solver import Stop
from planning.trajectory.heights import GroundHeights, inspection_agl_m


@dataclass(frozen=True, eq=False)
class Attempt:
    """Who flies what, if the zones of the scene are kept clear of; `uavs` are the numbers in the request of those that fly."""

    scene: Scene
    uavs: Sequence[int]
    grounded: Mapping[int, Grounding]
    left_out: Sequence[LeftOut]
    solution: Solution
    lock_cost: LockCost | None
    drawing: Drawing
    problem: Problem

    def most_counted_wh(self, uav: int) -> float:
        """What the search thought that the UAV, by its number in the request, takes for the flight that takes most."""
        start = self.uavs.index(uav)
        return max((self.problem.route_wh(start, order) or 0.0 for order in self.solution.sorties[start]), default=0.0)

    def routes(self, request: PlanRequest, ground: GroundHeights | None) -> list[PlannedRoute]:
        """Drawn over this ground, one for each UAV of the request."""
        flown = self.drawing.routes(self.uavs, self.solution.sorties, ground)
        return [flown.get(uav, PlannedRoute(end_action=request.end_action(uav))) for uav in range(len(request.uavs))]

    def drawn_alone(self, uav: int, order: Sequence[int], ground: GroundHeights | None) -> PlannedRoute | None:
        """One flight of one UAV, by its number in the request, over these visits; None where the wind over the ground stops it."""
        alone = [(tuple(order),) if other == uav else () for other in self.uavs]
        try:
            return self.drawing.routes(self.uavs, alone, ground)[uav]
        except InvalidRequest:
            return None

    def weights(self, request: PlanRequest) -> list[float]:
        """What the ways of each UAV's route cost for each metre: 1 along infrastructure, more away from it."""
        weights = [1.0] * len(request.uavs)
        for start, (uav, orders) in enumerate(zip(self.uavs, self.solution.sorties, strict=True)):
            if orders:
                weights[uav] = self.drawing.weight(start, uav, orders)
        return weights


def attempt(
    request: PlanRequest,
    every_place: Sequence[Place],
    gone: Sequence[int],
    scene: Scene,
    *,
    stop: Stop,
    on_progress: OnPlanProgress,
    seed: int,
    search_s: float,
    usable_share: Mapping[int, float],
    kept_from: Mapping[int, Collection[int]],
) -> Attempt:
    """every_place: the request's targets on the ground, `gone` those that are no longer there.

    usable_share and kept_from as in `assignment`.
    """
    refusals = {place.target: refused_place(place, scene) for place in every_place}
    left_out = [asset_gone(target) for target in gone] + [refusal for refusal in refusals.values() if refusal is not None]
    places = [place for place in every_place if refusals[place.target] is None]
    grounded = groundings(request.uavs, scene)
    uavs = [number for number in range(len(request.uavs)) if number not in grounded]
    bases = [base for base in request.bases if zone_at(base.position, scene) is None]

    on_progress(PlanProgress(0.05, "Measuring the ways between the targets"))
    agl_m = [inspection_agl_m(place_height_m(place, scene), scene.flight) for place in places]
    counts = needs_counting(request)
    takes_s = None
    if not counts:
        slowest_mps = min((request.uavs[uav].cruise_speed_mps for uav in uavs), default=scene.flight.cruise_speed_mps)
        takes_s = [target_s(height_m, place.task.hold_s, slowest_mps, scene.flight) for place, height_m in zip(places, agl_m, strict=True)]
    visits, courses = visits_of_places(places, takes_s)
    ways = ways_between(
        scene.graph,
        scene.leg_zones,
        starts=[Terminal(request.uavs[uav].position) for uav in uavs],
        entries=[Terminal(course[0], places[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        exits=[Terminal(course[-1], places[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        rules=scene.access,
        bases=[Terminal(base.position) for base in bases],
        homes=[Terminal(request.uavs[uav].returns_to) for uav in uavs],
    )
    drawing = Drawing(request, scene, places, agl_m, visits, courses, ways, bases)
    costs = counted(drawing, uavs) if counts else None
    ready = [
        0.0 if counts else least_ready_s(request.end_action(uav), request.uavs[uav].cruise_speed_mps, agl_m, scene.flight) for uav in uavs
    ]
    no_landing = _no_landing(request, uavs, places, scene)
    asked = assignment(
        request, uavs, places, visits, ways, grounded, ready, costs, usable_share, no_landing, scene.flight.turnaround_s, kept_from
    )
    sketch = Sketch(
        asked.problem,
        ways,
        scene.graph,
        [request.uavs[uav].position for uav in uavs],
        [request.uavs[uav].returns_to for uav in uavs],
        [base.position for base in bases],
        uavs,
        courses,
    )
    solution, lock_cost = solve_assignment(asked, stop=stop, on_progress=_passed_on(sketch, on_progress), seed=seed, search_s=search_s)
    left_out += unreached_places(solution.unassigned, request, uavs, asked, places, ways, scene, grounded, no_landing, kept_from)
    return Attempt(scene, uavs, grounded, left_out, solution, lock_cost, drawing, asked.problem)


def _no_landing(request: PlanRequest, uavs: Sequence[int], places: Sequence[Place], scene: Scene) -> dict[int, str]:
    """If a UAV is to land at its last target: places, by their numbers, with a zone between the height of inspection and the ground."""
    if all(request.end_action(uav) is not EndAction.LAND for uav in uavs):
        return {}
    return {
        number: zone for number, place in enumerate(places) for at in {place.course[0], place.course[-1]} if (zone := zone_at(at, scene))
    }


def _passed_on(sketch: Sketch, on_progress: OnPlanProgress) -> OnProgress:
    """What the solver says of the search, in the words of the whole plan."""

    def hear(told: Progress) -> None:
        draw = None if told.best_routes is None else lambda: sketch.of(told)
        on_progress(PlanProgress(0.1 + 0.85 * told.share, told.message, draw))

    return hear
