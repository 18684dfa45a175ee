"""Ways to reassign the remaining targets, from the least disruptive to one in which any UAV may do anything."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from missions.models import Mission
from missions.selectors.planning_context import with_bases
from missions.services.missions import request_of_mission
from missions.services.planning.planner import make_plan
from missions.services.replanning.composing import Continued, continued_route
from missions.services.replanning.leaving import LEAD_S, CannotLeave, Leaving, leaving_of
from missions.services.replanning.rest import OfferCause, Rest
from missions.services.replanning.zones_ahead import zone_ahead
from operation.reasons import Reason, english
from planning.energy.conditions import conditions_from_json
from planning.problem import Objective, Priority
from planning.request import LockRequest, PlanRequest, TargetRequest, lost_link_from_json
from planning.solver.solver import Stop, never

MAX_ALONE = 4  # UAVs that are tried as the one that takes all


@dataclass(frozen=True, eq=False)
class Field:
    """Common inputs of a mission's proposals, UAVs by their places in it.

    UAVs in `forced` cannot continue as they do; those in `recalled` cannot do anything else either. `zones`: names of zones across routes.
    `troubles`: why other UAVs cannot change their route.
    """

    mission: Mission
    rests: Sequence[Rest]
    leavings: Mapping[int, Leaving]
    forced: frozenset[int]
    recalled: frozenset[int]
    zones: Mapping[int, str]
    troubles: Mapping[int, Reason]
    targets: Mapping[int, TargetRequest]
    departs_at: datetime
    search_s: float = 0.0
    stop: Stop = never

    def rest(self, place: int) -> Rest:
        return next(rest for rest in self.rests if rest.place == place)

    def why(self, place: int) -> list[Reason]:
        """Return why a UAV cannot continue, or cannot change its route; empty where neither is so."""
        zone = self.zones.get(place)
        forced = Reason("zone_across_route", {"zone": zone}) if zone else Reason("battery_short_for_route")
        return [*([forced] if zone or place in self.forced else []), *([self.troubles[place]] if place in self.troubles else [])]


@dataclass(frozen=True, eq=False)
class Proposal:
    """A reassignment. `continued`: by place the UAVs whose route changes. `recalled` return. `unreached`: targets with the reason."""

    field: Field
    continued: Mapping[int, Continued]
    recalled: frozenset[int]
    unreached: Mapping[int, tuple[str, str, list[dict[str, Any]]]]
    plan: dict[str, Any] = dataclasses.field(default_factory=dict)

    @property
    def merit(self) -> tuple[tuple[int, ...], int, float]:
        """Return a sort key, smallest best: targets left undone by priority, number of disturbed UAVs, objective value."""
        wanted = [self.field.targets[target].priority for target in self.unreached]
        undone = tuple(sum(priority == level for priority in wanted) for level in sorted(Priority, reverse=True))
        value = sum(
            one.route.length_m if self.field.mission.objective == Objective.TOTAL else one.route.duration_s
            for one in self.continued.values()
        )
        return undone, len(self.continued) + len(self.recalled), value


@dataclass(frozen=True)
class _Assignable:
    """UAVs that may be given something: all of these; those in `free` may change their remaining order."""

    able: tuple[int, ...]
    free: frozenset[int]


def field_of(mission: Mission, rests: Sequence[Rest], cause: OfferCause, now: datetime) -> Field:
    conditions = conditions_from_json(mission.conditions)
    asked = request_of_mission(mission=mission)
    leavings: dict[int, Leaving] = {}
    troubles = {rest.place: rest.trouble for rest in rests if rest.trouble}
    zones: dict[int, str] = {}
    short: set[int] = set()
    for rest in rests:
        if rest.is_out:
            continue
        zone = zone_ahead(rest, now)
        if zone is not None:
            zones[rest.place] = zone.name
        elif cause.code == "battery-short" and rest.uav is not None and rest.uav.pk == cause.uav:
            short.add(rest.place)
        try:
            leavings[rest.place] = leaving_of(rest, conditions, before=None if zone is None else zone.breach.leg + 1)
        except CannotLeave as error:
            troubles.setdefault(rest.place, error.reason)
    return Field(
        mission,
        rests,
        leavings,
        forced=frozenset(short | set(zones)),
        recalled=frozenset(short - set(leavings)),
        zones=zones,
        troubles=troubles,
        targets=dict(enumerate(asked.targets)),
        departs_at=now + timedelta(seconds=LEAD_S),
    )


def proposals(field: Field) -> Iterator[Proposal]:
    """Yield proposals, the least disruptive first. Raises what make_plan raises."""
    seen: set[_Assignable] = set()
    for way in _ways(field):
        if way not in seen:
            seen.add(way)
            yield _proposal(field, way, field.recalled)


def _ways(field: Field) -> Iterator[_Assignable]:
    able = tuple(sorted(field.leavings))
    forced = frozenset(place for place in able if place in field.forced)
    yield _Assignable(able, forced)
    others = [place for place in able if place not in forced]
    if len(others) > 1:
        for place in others[:MAX_ALONE]:
            yield _Assignable(tuple(sorted({place, *forced})), forced)
    yield _Assignable(able, frozenset(able))


def _proposal(field: Field, way: _Assignable, recalled: frozenset[int]) -> Proposal:
    """Return the proposal for one choice of UAVs. recalled: UAVs that get nothing more and return."""
    flying = [place for place in way.able if place not in recalled]
    loose = [target for rest in field.rests if rest.is_out or rest.place in recalled for target in rest.ahead]
    wanted = sorted(
        {
            *loose,
            *(target for place in flying for target in field.rest(place).ahead if target not in field.leavings[place].targets),
        }
    )
    if not flying:
        reasons = [field.troubles[rest.place] for rest in field.rests if not rest.is_out and rest.place in field.troubles]
        why = reasons or [Reason("nobody_else_in_air")]
        return Proposal(field, {}, recalled, dict.fromkeys(wanted, _unreached("nobody_left", why)))
    if not wanted:
        return Proposal(field, {}, recalled, {})
    plan = make_plan(request=_request(field, way, flying, wanted), stop=field.stop, search_s=field.search_s)
    orders = [tuple(wanted[target] for target in route["targets"]) for route in plan["routes"]]
    more = {place for place, order in zip(flying, orders, strict=True) if not order and _comes_home(field, place)}
    if any(field.leavings[place].targets for place in more):
        return _proposal(field, way, recalled | more)
    unreached = {wanted[item["target"]]: (item["reason"], item["message"], item["why"]) for item in plan["unassigned"]}
    continued: dict[int, Continued] = {}
    for place, order, route in zip(flying, orders, plan["routes"], strict=True):
        leaving = field.leavings[place]
        whole = (*leaving.targets, *order)
        if place in more or not order or (whole == field.rest(place).ahead and place not in field.forced):
            continue
        try:
            continued[place] = continued_route(leaving, _with_places(route, wanted), whole, conditions_from_json(field.mission.conditions))
        except CannotLeave as error:  # others may have got what it would keep, so the whole proposal fails
            return Proposal(field, {}, recalled, dict.fromkeys(wanted, _unreached("beyond_energy", [error.reason])))
    return Proposal(field, continued, recalled | more, unreached, plan)


def _unreached(code: str, why: Sequence[Reason]) -> tuple[str, str, list[dict[str, Any]]]:
    return code, english(why, "\n"), [reason.to_json() for reason in why]


def _comes_home(field: Field, place: int) -> bool:
    """Whether a UAV that gets nothing more has lost its targets, or cannot continue with them."""
    ahead = field.rest(place).ahead
    return bool(ahead) and (place in field.forced or set(field.leavings[place].targets) != set(ahead))


def _request(field: Field, way: _Assignable, flying: Sequence[int], wanted: Sequence[int]) -> PlanRequest:
    mission = field.mission
    number = {target: place for place, target in enumerate(wanted)}
    locks = []
    for place in flying:
        run = tuple(number[target] for target in field.rest(place).ahead if target in number)
        if place not in way.free and run:
            locks.append(LockRequest(field.rest(place).name, run, at_start=True))
    request = PlanRequest(
        uavs=tuple(field.leavings[place].asked for place in flying),
        targets=tuple(field.targets[target] for target in wanted),
        objective=Objective(mission.objective),
        return_to_start=mission.return_to_start,
        locks=tuple(locks),
        departs_at=field.departs_at,
        conditions=conditions_from_json(mission.conditions),
        lost_link=lost_link_from_json(mission.lost_link),
        organisation=mission.organisation_id,
        mission=str(mission.pk),
    )
    return with_bases(request, mission.organisation)


def _with_places(route: Mapping[str, Any], wanted: Sequence[int]) -> dict[str, Any]:
    """Return a route with its targets by their places in the flying mission."""
    rows = [replaced | {"target": None if replaced["target"] is None else wanted[replaced["target"]]} for replaced in route["waypoints"]]
    return {**route, "waypoints": rows}
