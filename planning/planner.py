"""One plan from request to answer: propose a candidate, draw its routes, check them, add constraints, until nothing is met."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from inspection.geodesy import LonLat
from operation.reasons import Reason
from planning.airspace import Airspace, ZoneChoice, airspace_on, zone_choice
from planning.assignment.assignment import quality_of
from planning.assignment.candidate_plan import CandidatePlan, candidate_plan
from planning.assignment.refusals import Grounding
from planning.assignment.unassigned import WIND
from planning.checks.constraints import MAX_ROUND, Constraints, conflicts_of, without_conflicts
from planning.checks.lost_link import lost_link_check
from planning.checks.separation import SeparatedRoutes, separated
from planning.checks.zones import keys_of_zones_met
from planning.context import PlanningContext
from planning.explain.barriers import with_barriers
from planning.explain.energy_shortfall import OUT_OF_REACH, least_missing, with_shortfalls
from planning.explain.other_limits import with_other_limits
from planning.plan import Plan, PlannedRoute, PlanWarning
from planning.problem import Objective, Priority
from planning.progress import OnPlanProgress, PlanProgress, no_progress
from planning.request import PlanRequest
from planning.solver.solver import Effort, Prover, Stop, never

MAX_SOLVER_CALLS = 40  # of one plan
MAX_ROUNDS = 6  # of more zones each, for the widest choice of zones and for the narrowest


class ZonesNotSettled(Exception):
    """No candidate plan met no zone within the solver calls of a plan."""

    def __init__(self) -> None:
        super().__init__("No plan clear of every no-fly zone was found. Plan again, or split the mission.")


@dataclass(frozen=True, order=True)
class PlanValue:
    """Less is better: unassigned targets, the high priorities first; then paths near infrastructure before the shortest; then the value.

    That is what the objective counts, in its own unit. Paths away from infrastructure count as they do in the choice of paths: a short
    cut across country is not the better plan.
    """

    unassigned: tuple[int, ...]
    is_by_length: bool
    value: float


@dataclass(frozen=True, eq=False)
class CheckedPlan:
    """A candidate with its trajectories, separated. is_relaxed: the search could count on all of what batteries hold, and on all paths."""

    found: CandidatePlan
    flown: SeparatedRoutes
    value: PlanValue
    is_relaxed: bool

    def beside(self, other: "CheckedPlan") -> "CheckedPlan":
        """The same, with less missing for what is out of reach where the other plan shows that."""
        request = self.found.request
        routes = [] if other.flown.met else zip(request.uavs, other.flown.routes, strict=True)
        flown = {target: uav for uav, route in routes for target in route.targets}
        return replace(self, found=replace(self.found, left_out=least_missing(self.found.left_out, other.found.left_out, flown)))

    @property
    def is_out_of_reach(self) -> bool:
        """Whether a target is left out for which another path might do."""
        return any(item.reason in OUT_OF_REACH | {WIND} or item.missing == 0.0 for item in self.found.left_out)


@dataclass
class _PlanSearch:
    """The candidates for one request. share: of the effort's time, for each airspace; solver_calls: of all candidates so far."""

    context: PlanningContext
    request: PlanRequest
    terminals: Sequence[LonLat]
    choice: ZoneChoice
    stop: Stop
    on_progress: OnPlanProgress
    effort: Effort
    share: float
    solver_calls: int = 0
    may_go_on: bool = True  # whether another candidate stays within MAX_SOLVER_CALLS
    _airspace: tuple[Constraints, Airspace] | None = None  # of the newest candidate

    def checked_plan(self, constraints: Constraints) -> CheckedPlan:
        """Return the plan in the airspace of the constraints; where it leaves a target out of reach, also tried on the shortest paths."""
        preferred = self._on_paths(constraints)
        prefers_lines = self.context.rules.linking.off_network_factor != 1.0
        if not (prefers_lines and self.may_go_on and preferred.is_out_of_reach):
            return preferred
        return _better_in_reach(preferred, self._on_paths(constraints.on_shortest_paths()))

    def _on_paths(self, constraints: Constraints) -> CheckedPlan:
        """Constrain candidates until their routes can be flown as drawn; what cannot in the last one stays on the ground."""
        while True:
            found = self._candidate(constraints)
            conflicts = conflicts_of(found, found.routes())
            if not (conflicts and self.may_go_on and constraints.number < MAX_ROUND - 1):
                return _checked(*without_conflicts(found, conflicts, constraints), constraints, self.choice)
            constraints = constraints.after(found, conflicts)

    def _candidate(self, constraints: Constraints) -> CandidatePlan:
        found = candidate_plan(
            self.request,
            self._airspace_of(constraints),
            stop=self.stop,
            on_progress=self.on_progress,
            effort=self.effort.times(self.share * 0.5**constraints.number * (0.5 if constraints.is_by_length else 1.0)),
            usable_share=constraints.usable_share,
            kept_from=constraints.kept_from,
        )
        self.on_progress(PlanProgress(0.95, Reason("working_out_heights")))
        self.solver_calls += found.solver_calls
        self.may_go_on = self.solver_calls + found.solver_calls <= MAX_SOLVER_CALLS
        return found

    def _airspace_of(self, constraints: Constraints) -> Airspace:
        if self._airspace is None or not _same_airspace(self._airspace[0], constraints):
            obstacles = constraints.obstacles(self.context, self.terminals)
            airspace = airspace_on(self.context, constraints.zones, obstacles, is_by_length=constraints.is_by_length)
            self._airspace = constraints, airspace
        return self._airspace[1]


def plan(
    context: PlanningContext,
    request: PlanRequest,
    *,
    stop: Stop = never,
    on_progress: OnPlanProgress = no_progress,
    seed: int = 7,
    search_s: float = 0.0,
    prover: Prover | None = None,
) -> Plan:
    """Return the best plan found that meets no zone of the context.

    First all zones that can be in force at some time of the flight are kept clear of. If some of them are so for a part of it only,
    plans that keep clear of fewer are tried: whatever such a plan really meets is added, until it meets nothing or is no better. In each
    airspace paths near infrastructure are preferred; where these leave a target out of reach, the shortest ones are tried, too. Each
    assignment that is not proven is handed to the prover, if there is one. Raises InvalidRequest, ZonesNotSettled or ZoneNotAvoided.
    """
    terminals = _terminals(context, request)
    choice = zone_choice(context.zones, request.departs_at, context.rules.flight, terminals)
    share = 0.5 if choice.changes else 1.0
    search = _PlanSearch(context, request, terminals, choice, stop, on_progress, Effort(seed, search_s, prover), share)
    best = freest = _clear_of_most_zones(search)
    if choice.changes and search.may_go_on:
        search.share = share / MAX_ROUNDS
        best, freest = _clear_of_fewer_zones(search, best)
    return _plan(context, best, freest, search.solver_calls)


def _clear_of_most_zones(search: _PlanSearch) -> CheckedPlan:
    """Return a plan clear of all zones that can be in force at some time of the flight. Raises ZonesNotSettled or ZoneNotAvoided."""
    widest = search.choice.widest
    constraints = Constraints(widest, np.zeros_like(widest))
    for number in range(1, MAX_ROUNDS + 1):
        checked = search.checked_plan(constraints)
        if not checked.flown.met:
            return checked
        if number == MAX_ROUNDS or not search.may_go_on:
            break
        constraints = constraints.clear_of(checked.flown.met, search.choice)
    raise ZonesNotSettled


def _clear_of_fewer_zones(search: _PlanSearch, best: CheckedPlan) -> tuple[CheckedPlan, CheckedPlan]:
    """Return the better of the best plan and one on fewer zones that meets none, and the first plan, which is on the fewest zones."""
    narrowest = search.choice.narrowest
    constraints = Constraints(narrowest, np.zeros_like(narrowest))
    freest: CheckedPlan | None = None
    for _ in range(MAX_ROUNDS):
        checked = search.checked_plan(constraints)
        freest = freest or checked
        is_better = checked.value < best.value
        if is_better and not checked.flown.met:
            return checked.beside(best), freest
        best = best.beside(checked)
        if not (is_better and search.may_go_on):
            break
        constraints = Constraints(search.choice.with_zones(constraints.zones, checked.flown.met), constraints.closed_zones)
    return best, freest or best


def plan_on_map(found: Plan, context: PlanningContext) -> Plan | None:
    """Return the plan as it is on a map that has changed since it was made; None where it meets a zone there."""
    if keys_of_zones_met(found.routes, found.request.departs_at, context):
        return None
    return replace(found, map_version=context.map_version, lost_link=lost_link_check(found.request, found.routes, context))


def _terminals(context: PlanningContext, request: PlanRequest) -> list[LonLat]:
    """Where UAVs start, land and inspect."""
    ends = [*(uav.position for uav in request.uavs), *(base.position for base in request.bases)]
    return [*ends, *(at for target in context.targets for at in target.course)]


def _same_airspace(one: Constraints, other: Constraints) -> bool:
    return (
        one.zones is other.zones
        and one.closed_zones is other.closed_zones
        and (one.spans, one.closed_spans, one.is_by_length) == (other.spans, other.closed_spans, other.is_by_length)
    )


def _checked(found: CandidatePlan, alone: Sequence[PlannedRoute], constraints: Constraints, choice: ZoneChoice) -> CheckedPlan:
    request, context = found.request, found.airspace.context
    on_all = (constraints.zones == choice.widest).all()
    is_clear = None if on_all else lambda route: not keys_of_zones_met([route], request.departs_at, context)
    found = replace(found, left_out=with_shortfalls(found, is_clear))
    flown = separated(request, alone, context)
    return CheckedPlan(found, flown, _value_of(found, flown.routes), constraints.is_relaxed)


def _better_in_reach(preferred: CheckedPlan, shortest: CheckedPlan) -> CheckedPlan:
    if shortest.value.unassigned < preferred.value.unassigned:
        return shortest.beside(preferred)
    return preferred.beside(shortest)


def _value_of(found: CandidatePlan, routes: Sequence[PlannedRoute]) -> PlanValue:
    request = found.request
    left_out = [request.targets[item.target].priority for item in found.left_out]
    by_priority = tuple(sum(priority is level for priority in left_out) for level in sorted(Priority, reverse=True))
    return PlanValue(by_priority, found.airspace.is_by_length, objective_value(request.objective, routes, found.weights()))


def objective_value(objective: Objective, routes: Sequence[PlannedRoute], weights: Sequence[float] | None = None) -> float:
    """Metres, seconds or Wh of finished routes, each times its weight; to finish soonest, what a route is put off by counts as well."""
    values = [_route_value(objective, route) for route in routes]
    if weights is not None:
        values = [value * weight for value, weight in zip(values, weights, strict=True)]
    return max(values, default=0.0) if objective is Objective.MAKESPAN else sum(values)


def _route_value(objective: Objective, route: PlannedRoute) -> float:
    if objective is Objective.TOTAL:
        return route.length_m
    if objective is Objective.MAKESPAN and route.waypoints is not None:
        return route.departs_s + route.duration_s
    if objective is Objective.ENERGY:
        return 0.0 if route.timing is None or route.timing.total_wh is None else route.timing.total_wh
    return route.duration_s


def _plan(context: PlanningContext, best: CheckedPlan, freest: CheckedPlan, calls: int) -> Plan:
    found, flown = best.found, best.flown
    request = found.request
    return Plan(
        request=request,
        routes=flown.routes,
        unassigned=with_barriers(found, with_other_limits(found)),
        warnings=_warnings(context, request, found.grounded, is_by_length=found.airspace.is_by_length),
        separation=flown.separation,
        untimed_flights=flown.others.untimed,
        lost_link=lost_link_check(request, flown.routes, context),
        quality=_quality(best, freest),
        graph_version=context.graph_version,
        map_version=context.map_version,
        has_terrain=context.terrain is not None,
        solver_calls=calls,
    )


def _warnings(
    context: PlanningContext, request: PlanRequest, grounded: Mapping[int, Grounding], *, is_by_length: bool
) -> list[PlanWarning]:
    found = [PlanWarning(grounding.code, number, grounding.why) for number, grounding in grounded.items()]
    found += [
        PlanWarning("uav_in_air", number, Reason("uav_in_air", {"uav": uav.name}))
        for number, uav in enumerate(request.uavs)
        if uav.uav in context.in_air and number not in grounded
    ]
    if is_by_length:
        found.append(PlanWarning("shortest_ways", None, Reason("shortest_paths")))
    if request.conditions.is_calm:
        return found
    return found + [
        PlanWarning("airspeed_not_stated", number, Reason("airspeed_not_stated", {"uav": uav.name}))
        for number, uav in enumerate(request.uavs)
        if number not in grounded and uav.performance.max_airspeed_mps is None
    ]


def _quality(best: CheckedPlan, freest: CheckedPlan) -> dict[str, object]:
    """How good the plan is beside all others, those that fly through a zone while it is not in force included."""
    alike = (freest.value.unassigned, freest.value.is_by_length) == (best.value.unassigned, best.value.is_by_length)
    share = freest.value.value / best.value.value if best.value.value and alike else None
    objective = best.found.request.objective
    return quality_of(
        freest.found.solution,
        best.found.lock_cost,
        objective,
        value=objective_value(objective, best.flown.routes),
        share_of_freest=None if not (best.is_relaxed and freest.is_relaxed) else 1.0 if best is freest else share,
    )
