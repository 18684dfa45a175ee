"""Whether a later departure gives a better plan, when zones that block a path or a target are no longer in force."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from django.conf import settings

from inspection.geodesy import LonLat
from missions.selectors.planning_context import read_targets
from missions.services.planning.planner import make_plan
from planning.airspace import near_positions
from planning.problem import Objective, Priority
from planning.request import PlanRequest, moment_to_json

AHEAD_S = 48 * 3_600.0
MAX_TRIES = 12
BETTER = 0.99  # of a value: a smaller improvement does not justify the wait
STEP_S = 60.0


def better_departure(*, request: PlanRequest, now: datetime) -> dict[str, Any]:
    """Return the first end of a nearby zone at which a plan has fewer unassigned targets or a lower objective value.

    Tries the first MAX_TRIES of them within AHEAD_S after the departure; without a departure, after now, and now itself. Each try is a
    complete plan. Raises InvalidRequest, NoGraph or GraphOutdated.
    """
    before = make_plan(request=request)
    looked_until: datetime | None = None
    for moment in _moments(request, now):
        looked_until = moment
        plan = make_plan(request=replace(request, departs_at=moment))
        if _is_better(request, plan, before):
            return _answer(before, plan, moment, looked_until)
    return _answer(before, None, None, looked_until)


def _moments(request: PlanRequest, now: datetime) -> Iterator[datetime]:
    """Yield candidate departures in order, on full minutes, after the margin of a zone's times."""
    from_s = (request.departs_at or now).timestamp()
    ground, targets, _deleted = read_targets(request)
    ends = [*(uav.position for uav in request.uavs), *(base.position for base in request.bases)]
    near = near_positions(ground.table, [*ends, *(LonLat(*at) for target in targets for at in target.course)])
    table = ground.table.only(near & ground.table.reaching(0.0, settings.FLIGHT_RULES.max_agl_m))
    spans = (span for own in table.spans(from_s, from_s + AHEAD_S) for span in own)
    moments_s = {STEP_S * math.ceil(span.to_s / STEP_S) for span in spans if span.to_s < from_s + AHEAD_S}
    if request.departs_at is None:
        moments_s.add(STEP_S * math.ceil(from_s / STEP_S))
    return (datetime.fromtimestamp(moment_s, UTC) for moment_s in sorted(moments_s)[:MAX_TRIES])


def _is_better(request: PlanRequest, plan: Mapping[str, Any], before: Mapping[str, Any]) -> bool:
    missed, missed_before = _missed(request, plan), _missed(request, before)
    return missed < missed_before or (missed == missed_before and value_of_plan(plan) < BETTER * value_of_plan(before))


def _missed(request: PlanRequest, plan: Mapping[str, Any]) -> tuple[int, ...]:
    left_out = [request.targets[item["target"]].priority for item in plan["unassigned"]]
    return tuple(sum(priority is level for priority in left_out) for level in sorted(Priority, reverse=True))


def value_of_plan(plan: Mapping[str, Any]) -> float:
    """Return what the objective counts of a plan in the shape of the API: metres, seconds or Wh."""
    reported = _reported(plan)
    names = {
        Objective.TOTAL: "total_length_m", Objective.MAKESPAN: "done_s", Objective.TIME: "total_duration_s",
        Objective.ENERGY: "total_energy_wh",
    }  # fmt: skip
    return float(reported[names[Objective(plan["objective"])]] or 0.0)


def _reported(plan: Mapping[str, Any]) -> dict[str, Any]:
    flown = [route["departs_s"] + route["duration_s"] for route in plan["routes"] if route["geometry"] is not None]
    return {
        "left_out": len(plan["unassigned"]),
        "total_length_m": plan["total_length_m"],
        "done_s": max(flown, default=0.0),
        "total_duration_s": plan["total_duration_s"],
        "total_energy_wh": plan["total_energy_wh"],
    }


def _answer(
    before: Mapping[str, Any], plan: Mapping[str, Any] | None, moment: datetime | None, looked_until: datetime | None
) -> dict[str, Any]:
    return {
        "departs_at": moment_to_json(moment),
        "looked_until": moment_to_json(looked_until),
        "before": _reported(before),
        "then": None if plan is None else _reported(plan),
    }
