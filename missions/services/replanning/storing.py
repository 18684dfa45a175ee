"""Store a proposal as a planned mission of its own, which continues the flying one."""

from collections.abc import Collection
from datetime import datetime
from typing import Any

from django.db import transaction

from missions.models import Mission, MissionUav, Route
from missions.models.missions import MAX_NAME_LENGTH
from missions.selectors.missions import mission_of_organisation
from missions.services.approval.checks import reasons_against
from missions.services.commands.refused import RefusalReason
from missions.services.manual_edits.still_separated import separation_of_stored
from missions.services.mission_plans import store_plan
from missions.services.missions import check_lost_link, create_mission
from missions.services.replanning.composing import Continued
from missions.services.replanning.proposals import Proposal
from planning.energy.conditions import conditions_from_json
from planning.plan_json import NO_QUALITY, column_to_json, timing_to_json, total_energy_wh, waypoints_to_json
from planning.problem import Objective
from planning.request import PlanRequest, lost_link_from_json


def stored(proposal: Proposal, *, now: datetime) -> tuple[Mission | None, list[RefusalReason]]:
    """Return the planned mission, or the reasons against flying it, in which case nothing is stored."""
    with transaction.atomic():
        continuation = _store(proposal)
        reasons = _reasons_against(proposal, continuation, now)
        if reasons:
            transaction.set_rollback(True)
            return None, reasons
    return continuation, []


def given_up_routes(proposal: Proposal) -> list[int]:
    """Return the keys of the flying mission's routes that end when this proposal is flown."""
    changed = {*proposal.continued, *proposal.recalled, *(rest.place for rest in proposal.field.rests if rest.is_out)}
    return [rest.route.pk for rest in proposal.field.rests if rest.place in changed]


def _reasons_against(proposal: Proposal, continuation: Mission, now: datetime) -> list[RefusalReason]:
    """Return reasons as if the proposal had been accepted, so that the replaced parts of routes do not obstruct it."""
    with transaction.atomic():
        Route.objects.filter(pk__in=given_up_routes(proposal)).update(continued_by=continuation)
        separation = separation_of_stored(continuation)
        loaded = mission_of_organisation(continuation.organisation, continuation.pk)
        reasons = reasons_against(loaded, now=now)
        transaction.set_rollback(True)
    Mission.objects.filter(pk=continuation.pk).update(separation=separation)
    return reasons


def _store(proposal: Proposal) -> Mission:
    field, flying = proposal.field, proposal.field.mission
    continued = [proposal.continued[place] for place in sorted(proposal.continued)]
    targets = sorted(target for one in continued for target in one.order)
    request = PlanRequest(
        uavs=tuple(one.leaving.stored for one in continued),
        targets=tuple(field.targets[target] for target in targets),
        objective=Objective(flying.objective),
        return_to_start=flying.return_to_start,
        departs_at=field.departs_at,
        conditions=conditions_from_json(flying.conditions),
        lost_link=lost_link_from_json(flying.lost_link),
    )
    name = f"{flying.name[: MAX_NAME_LENGTH - 20]}, continued"
    draft = create_mission(
        organisation=flying.organisation,
        author=flying.author,
        name=name,
        request=request,
        external_id=flying.external_id,
        attributes=flying.attributes,
    )
    Mission.objects.filter(pk=draft.pk).update(continues=flying, simulates=flying.simulates_id, alert_limits=flying.alert_limits)
    for uav, one in zip(draft.mission_uavs.all(), continued, strict=True):
        MissionUav.objects.filter(pk=uav.pk).update(home_amsl_m=one.leaving.rest.take_off_amsl_m)
    planned = store_plan(mission=draft, actor=None, revision=draft.revision, plan=_plan(proposal, continued, targets))
    check_lost_link(mission=planned)
    planned.save(update_fields=["lost_link_check"])
    return planned


def _plan(proposal: Proposal, continued: Collection[Continued], targets: list[int]) -> dict[str, Any]:
    """Return the plan in the shape of the API, as far as it is stored."""
    routes = [one.route for one in continued]
    lengths_m = [round(route.length_m, 3) for route in routes]
    return {
        **NO_QUALITY,
        "method": "continued",
        "graph_version": proposal.plan["graph_version"],
        "ground_revision": proposal.plan["ground_revision"],
        "flat_ground_assumed": any(route.is_flat for route in routes),
        "total_length_m": round(sum(lengths_m), 3),
        "longest_route_m": max(lengths_m),
        "total_energy_wh": total_energy_wh(routes),
        "separation": None,
        "lost_link": None,
        "warnings": [],
        "routes": [_route(one, targets) for one in continued],
        "unassigned": [],
    }


def _route(one: Continued, targets: list[int]) -> dict[str, Any]:
    route = one.route
    assert route.waypoints is not None and route.line is not None  # noqa: S101 - it was composed of them
    rows = waypoints_to_json(route.waypoints)
    for row in rows:
        row["target"] = None if row["target"] is None else targets.index(row["target"])
    return {
        "length_m": round(route.length_m, 3),
        "duration_s": round(route.duration_s, 1),
        **timing_to_json(route, column_to_json),
        "charging": [],
        "base": route.base,
        "geometry": {"type": "LineString", "coordinates": route.line.tolist()},
        "waypoints": rows,
        "begun_by": one.begun_by,
    }
