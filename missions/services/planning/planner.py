"""One plan from request to answer: on which zones it stands, the attempts on them, and the last look before it leaves."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import wraps
from time import perf_counter
from typing import Any, ParamSpec

import numpy as np
from django.conf import settings

from inspection.geodesy import LonLat
from inspection.network.build.obstacles import at_all_heights, with_walls
from inspection.network.zones.zone_index import ZoneIndex
from inspection.selectors.planning import PlanningGround, edition_now, heights_at, planning_read, terrain_at
from missions.hooks.in_air import uavs_in_the_air
from missions.selectors.flights import OtherFlights, flights_at_the_same_time
from missions.services.approval.lost_link import lost_link_check
from missions.services.planning.best_so_far import OnPlanProgress, PlanProgress, unheard
from missions.services.planning.candidate_plans import Attempt, attempt
from missions.services.planning.feedback import DrawnAttempts, Shown
from missions.services.planning.final_check import in_the_air_s, keys_of_zones_met
from missions.services.planning.map_data import scene_on
from missions.services.planning.plan_json import PlannedRoute, plan_to_json
from missions.services.planning.requests import PlanRequest
from missions.services.planning.separation import routes_apart
from missions.services.planning.zone_choice import BoolArray, ZoneChoice, zone_choice
from missions.services.targets.assignment import quality_of
from missions.services.targets.energy_shortfall import OUT_OF_REACH, least_missing, with_lacks
from missions.services.targets.other_limits import with_other_limits
from missions.services.targets.places import Place, places_of, whole_assets
from missions.services.targets.refusals import Grounding, Scene
from missions.services.targets.unassigned import WIND
from operation.metrics import PLAN_SECONDS, PLANS, PLANS_REFUSED
from planning.problem import Objective, Priority
from planning.separation.report import separation_json
from planning.separation.separation import Separation
from planning.solver.solver import Stop, never
from workspace.jobs.planning_lock import end_turn, in_turn

SHORTEST_WAYS = "The routes take shorter ways than preferred, farther from the lines: along the lines, not all targets are in reach."
SIZES = ((3, "1-3"), (12, "4-12"), (50, "13-50"), (200, "51-200"))  # targets at most, and what that is called
ABOVE_ALL_SIZES = "201-"
P = ParamSpec("P")
MAX_GROUNDS = 5  # that may follow one another while one plan is made
MAX_WINDOWS = 6  # of other missions' flights, each at least twice as long as the one before
MAX_TRIES = 6  # with more zones each time


@dataclass(frozen=True, order=True)
class Worth:
    """Less is better: targets left out, the high priorities first; then ways near infrastructure before the shortest; then the value.

    That is what the objective counts, in its own unit.

    Ways away from infrastructure count as they do in the choice of ways: a short cut across country is not the better plan.
    """

    left_out: tuple[int, ...]
    is_by_length: bool
    value: float


def worth_of(request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute]) -> Worth:
    left_out = [request.targets[item.target].priority for item in found.left_out]
    by_priority = tuple(sum(priority is level for priority in left_out) for level in sorted(Priority, reverse=True))
    return Worth(by_priority, found.scene.is_by_length, value_of(request.objective, routes, found.weights(request)))


def value_of(objective: Objective, routes: Sequence[PlannedRoute], weights: Sequence[float] | None = None) -> float:
    """Metres, seconds or Wh of finished routes, each times its weight; to finish soonest, what a route is put off by counts as well."""
    values = [_value(objective, route) for route in routes]
    if weights is not None:
        values = [value * weight for value, weight in zip(values, weights, strict=True)]
    return max(values, default=0.0) if objective is Objective.MAKESPAN else sum(values)


def _value(objective: Objective, route: PlannedRoute) -> float:
    if objective is Objective.TOTAL:
        return route.length_m
    if objective is Objective.MAKESPAN and route.waypoints is not None:
        return route.departs_s + route.duration_s
    if objective is Objective.ENERGY:
        return 0.0 if route.timing is None or route.timing.total_wh is None else route.timing.total_wh
    return route.duration_s


def warnings_of(request: PlanRequest, grounded: Mapping[int, Grounding], *, is_by_length: bool) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = [{"code": why.code, "uav": number, "message": why.message} for number, why in grounded.items()]
    flying = uavs_in_the_air([uav.uav for uav in request.uavs if uav.uav is not None])
    in_air = "%s is reported to be in the air: the plan begins with a take-off from the ground at the place where it was last seen."
    found += [
        {"code": "uav_in_air", "uav": number, "message": in_air % uav.name}
        for number, uav in enumerate(request.uavs)
        if uav.uav in flying and number not in grounded
    ]
    if is_by_length:
        found.append({"code": "shortest_ways", "uav": None, "message": SHORTEST_WAYS})
    if request.conditions.is_calm:
        return found
    unknown = "%s states no top airspeed: it is taken to fly no faster than its speed, through the air."
    return found + [
        {"code": "airspeed_not_stated", "uav": number, "message": unknown % uav.name}
        for number, uav in enumerate(request.uavs)
        if number not in grounded and uav.performance.max_airspeed_mps is None
    ]


def size_of(targets: int) -> str:
    return next((name for most, name in SIZES if targets <= most), ABOVE_ALL_SIZES)


def counted(make: Callable[P, dict[str, Any]]) -> Callable[P, dict[str, Any]]:
    """Of a function that makes a plan of its keyword argument `request`, or raises why it cannot."""

    @wraps(make)
    def make_and_count(*args: P.args, **kwargs: P.kwargs) -> dict[str, Any]:
        began_s = perf_counter()
        try:
            plan = make(*args, **kwargs)
        except Exception as error:
            PLANS_REFUSED.labels(type(error).__name__).inc()
            raise
        request: Any = kwargs["request"]
        size, method = size_of(len(request.targets)), _method_of(plan)
        PLANS.labels(size, method).inc()
        PLAN_SECONDS.labels(size, method).observe(perf_counter() - began_s)
        return plan

    return make_and_count


def _method_of(plan: Mapping[str, Any]) -> str:
    quality = plan.get("quality")
    return str(quality["method"]) if isinstance(quality, Mapping) and "method" in quality else "unknown"


class GraphOutdated(Exception):
    """The zones change faster than a plan can be made."""

    def __init__(self) -> None:
        super().__init__("The no-fly zones are being changed just now. Plan again in a moment.")


class ZoneNotAvoided(RuntimeError):
    """A finished route meets zones that the planner has kept clear of: a fault of the planner. The plan does not leave."""


@dataclass(frozen=True, eq=False)
class Finished:
    """An attempt with its routes drawn. `met`: primary keys of the zones that they meet at their time and height."""

    found: Attempt
    routes: Sequence[PlannedRoute]
    separation: Separation
    others: OtherFlights
    has_terrain: bool
    met: frozenset[int]
    worth: Worth
    is_whole: bool  # the search could count on all of what the batteries hold, and on all ways

    def beside(self, other: "Finished", request: PlanRequest) -> "Finished":
        """The same, with less missing for what is out of reach where the other plan shows that."""
        routes = [] if other.met else zip(request.uavs, other.routes, strict=True)
        flown = {target: uav for uav, route in routes for target in route.targets}
        return replace(self, found=replace(self.found, left_out=least_missing(self.found.left_out, other.found.left_out, flown)))


@dataclass(frozen=True, eq=False)
class _Planner:
    """What stays the same from attempt to attempt."""

    request: PlanRequest
    places: Sequence[Place]
    gone: Sequence[int]
    stop: Stop
    on_progress: OnPlanProgress
    seed: int
    search_s: float

    def best_on(self, ground: PlanningGround) -> tuple[Finished, Finished]:
        """The best plan that meets no zone of this ground, and the plan on the fewest zones, which might; often the same.

        First all zones that can be in force at some time of the flight are kept clear of. If some of them are so for a part of it only,
        plans that keep clear of fewer are tried: whatever such a plan really meets is added, until it meets nothing or is no better.
        """
        choice = zone_choice(ground.table, self.request.departs_at, settings.FLIGHT_RULES, self._positions())
        share = 0.5 if choice.changes else 1.0
        best = self._clean(ground, choice, choice.widest, share)
        if not choice.changes:
            return best, best
        chosen, freest = choice.narrowest, None
        for _ in range(MAX_TRIES):
            tried = self._finished(ground, choice, chosen, share / MAX_TRIES)
            freest = freest or tried
            if not tried.worth < best.worth:
                best = best.beside(tried, self.request)
                break
            if not tried.met:
                best = tried.beside(best, self.request)
                break
            best = best.beside(tried, self.request)
            chosen = choice.with_zones(chosen, tried.met)
        return best, freest or best

    def _positions(self) -> list[LonLat]:
        request = self.request
        ends = [*(uav.position for uav in request.uavs), *(base.position for base in request.bases)]
        return [*ends, *(at for place in self.places for at in place.course)]

    def _clean(self, ground: PlanningGround, choice: ZoneChoice, chosen: BoolArray, share: float) -> Finished:
        """Raises GraphOutdated where that cannot be had: zones come into force after the longest flight that is reckoned with.

        What rises over wires in a valley may come into a zone under which its way was to lead: that is kept clear of at all heights then.
        """
        closed = np.zeros_like(chosen)
        for _ in range(MAX_TRIES):
            tried = self._finished(ground, choice, chosen, share, closed)
            if not tried.met:
                return tried
            more = choice.with_zones(chosen, tried.met)
            if (more == chosen).all():
                more_closed = choice.with_zones(closed, tried.met)
                if (more_closed == closed).all():
                    raise ZoneNotAvoided(sorted(tried.met))
                closed = more_closed
            chosen = more
        raise GraphOutdated

    def _finished(
        self, ground: PlanningGround, choice: ZoneChoice, chosen: BoolArray, share: float, closed: BoolArray | None = None
    ) -> Finished:
        """An attempt, drawn. Ways near infrastructure are preferred; what is out of reach on them may not be so on the shortest ones.

        closed: zones to be kept clear of at all heights.
        """
        walls = None if closed is None or not closed.any() else at_all_heights(ground.zones(closed))
        preferred = self._drawn(ground, choice, chosen, share, walls, is_by_length=False)
        if settings.GRAPH_RULES.off_network_factor == 1.0 or not self._is_out_of_reach(preferred):
            return preferred
        shortest = self._drawn(ground, choice, chosen, share / 2, walls, is_by_length=True)
        best, other = (shortest, preferred) if shortest.worth.left_out < preferred.worth.left_out else (preferred, shortest)
        return best.beside(other, self.request)

    def _is_out_of_reach(self, plan: Finished) -> bool:
        """Whether a target is left out for which another way might do."""
        return any(item.reason in OUT_OF_REACH | {WIND} or item.missing == 0.0 for item in plan.found.left_out)

    def _drawn(
        self, ground: PlanningGround, choice: ZoneChoice, chosen: BoolArray, share: float, walls: ZoneIndex | None, *, is_by_length: bool
    ) -> Finished:
        """Attempts on preferred or on shortest ways, until one can be flown as it is drawn."""
        terrain = heights_at(ground.edition)

        def scene_with(more: ZoneIndex | None) -> Scene:
            both = walls if more is None else more if walls is None else with_walls(walls, more)
            return scene_on(ground, chosen, both, is_by_length=is_by_length)

        def attempt_on(scene: Scene, shown: Shown, part: float) -> Attempt:
            found = attempt(
                self.request, self.places, self.gone, scene,
                stop=self.stop, on_progress=self.on_progress, seed=self.seed,
                search_s=self.search_s * share * part, usable_share=shown.usable_share, kept_from=shown.kept_from,
            )  # fmt: skip
            self.on_progress(PlanProgress(0.95, "Working out heights and checking every leg"))
            return found

        drawn = DrawnAttempts(self.request, terrain, self._positions(), scene_with, attempt_on).last()
        on_all = (chosen == choice.widest).all()
        is_clear = None if on_all else lambda route: not keys_of_zones_met([route], self.request.departs_at, choice.table)
        found = replace(drawn.found, left_out=with_lacks(self.request, drawn.found, terrain, is_clear))
        routes, separation, others, met = self._kept_apart(drawn.routes, choice)
        return Finished(found, routes, separation, others, terrain is not None, met, worth_of(self.request, found, routes), drawn.is_first)

    def _kept_apart(
        self, alone: Sequence[PlannedRoute], choice: ZoneChoice
    ) -> tuple[list[PlannedRoute], Separation, OtherFlights, frozenset[int]]:
        """The routes put off or higher where others are too near, and the zones, by their keys, that they meet so."""
        routes, separation, others = self._apart(alone, choice)
        met = keys_of_zones_met(routes, self.request.departs_at, choice.table)
        if met and any(separation.layers_m):  # higher and put off, a route may meet what higher alone it does not
            routes, separation, others = self._apart(alone, choice, may_raise=False)
            met = keys_of_zones_met(routes, self.request.departs_at, choice.table)
        return routes, separation, others, met

    def _apart(
        self, alone: Sequence[PlannedRoute], choice: ZoneChoice, *, may_raise: bool = True
    ) -> tuple[list[PlannedRoute], Separation, OtherFlights]:
        """A route that is put off until after the flights that were looked up may meet those that come later: these are looked up, too."""
        window_s = settings.FLIGHT_RULES.longest_flight_s
        for _ in range(MAX_WINDOWS):
            others = _others_in_the_air(self.request, window_s)
            routes, separation = routes_apart(self.request, alone, choice.table, others.routes, may_raise=may_raise)
            ends_s = max((route.departs_s + in_the_air_s(route) for route in routes), default=0.0)
            if ends_s <= window_s:
                break
            window_s = 2.0 * ends_s
        return routes, separation, others


@counted
def make_plan(
    *,
    request: PlanRequest,
    stop: Stop = never,
    on_progress: OnPlanProgress = unheard,
    seed: int = 7,
    search_s: float = 0.0,
    as_text: bool = False,
) -> dict[str, Any]:
    """The plan in the shape of the API, on demand with parts of it `as_text` (see plan_to_json).

    Raises InvalidRequest, NoGraph or GraphOutdated.
    """
    on_progress(PlanProgress(0.0, "Looking up the targets"))
    read = planning_read(whole_assets(request.targets))
    places, gone = places_of(request.targets, read.points)
    planner = _Planner(request, places, gone, stop, on_progress, seed, search_s)
    ground = read.ground()
    for _ in range(MAX_GROUNDS):
        terrain = terrain_at(ground.edition)  # before any height is read
        with in_turn():
            plan, freest = planner.best_on(ground)
            answer = _answer(request, ground, plan, freest, as_text=as_text)
        end_turn()  # which is the caller's, if it had one already: nobody waits for another turn after the last look
        if edition_now() == ground.edition:
            return answer
        # Only what was checked against the zones of this moment, over the ground that its heights belong to, leaves.
        ground = planning_read().ground()
        if terrain_at(ground.edition) == terrain and not keys_of_zones_met(plan.routes, request.departs_at, ground.table):
            return _answer(request, ground, plan, freest, as_text=as_text)
    raise GraphOutdated


def _answer(request: PlanRequest, ground: PlanningGround, plan: Finished, freest: Finished, *, as_text: bool) -> dict[str, Any]:
    return plan_to_json(
        request,
        plan.routes,
        with_other_limits(request, plan.found, heights_at(ground.edition)),
        warnings_of(request, plan.found.grounded, is_by_length=plan.found.scene.is_by_length),
        graph_version=plan.found.scene.graph.version,
        ground_revision=ground.edition[0],
        has_terrain=plan.has_terrain,
        separation=separation_json(plan.separation, plan.others.untimed),
        lost_link=lost_link_check(request, plan.routes, ground.table, plan.found.scene.network, heights_at(ground.edition)),
        quality=_quality(request, plan, freest),
        as_text=as_text,
    )


def _others_in_the_air(request: PlanRequest, window_s: float) -> OtherFlights:
    """A plan for any time cannot be kept apart from flights of a certain one; it gets a departure before it is flown."""
    if request.departs_at is None or request.organisation is None:
        return OtherFlights()
    from_s = request.departs_at.timestamp()
    return flights_at_the_same_time(request.organisation, from_s, from_s + window_s, but=request.mission)


def _quality(request: PlanRequest, plan: Finished, freest: Finished) -> dict[str, object]:
    """How good the plan is beside all others, those that fly through a zone while it is not in force included."""
    alike = (freest.worth.left_out, freest.worth.is_by_length) == (plan.worth.left_out, plan.worth.is_by_length)
    share = freest.worth.value / plan.worth.value if plan.worth.value and alike else None
    return quality_of(
        freest.found.solution,
        plan.found.lock_cost,
        request.objective,
        value=value_of(request.objective, plan.routes),
        share_of_freest=None if not (plan.is_whole and freest.is_whole) else 1.0 if plan is freest else share,
    )
