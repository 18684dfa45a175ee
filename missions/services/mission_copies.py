"""Copies and follow-ups of missions."""

from collections.abc import Collection, Iterable
from dataclasses import replace
from typing import Any

from django.db import transaction
from django.db.models import Model
from django.utils.translation import gettext as _

from missions.models import ENDED_STATES, InspectionTarget, Mission, MissionState, MissionUav, Route, TargetState, Uav, Waypoint
from missions.models.missions import MAX_NAME_LENGTH
from missions.services.commands.refused import refuse
from missions.services.manual_edits.still_separated import separation_of_stored
from missions.services.missions import create_mission, note, request_of_mission
from planning.request import PlanRequest, TargetRequest
from workspace.models import User

COPIED = (
    "organisation_id", "state", "objective", "return_to_start", "planned_at", "graph_version", "ground_revision", "flat_ground_assumed",
    "total_length_m", "longest_route_m", "plan_warnings", "last_plan", "locks", "plan_quality",
    "departs_at", "conditions", "charging_w", "total_energy_wh", "separation", "lost_link",
    "lost_link_check", "external_id", "attributes",
)  # fmt: skip
NOT_FLOWN: dict[str, Any] = {
    "state": TargetState.PENDING, "state_at": None, "state_reason": "", "state_why": None, "reached_at": None, "held_s": None,
    "visit_stored_at": None,
}  # fmt: skip


def draft_follow_up(*, mission: Mission, author: User, name: str = "", targets: Collection[int] | None = None) -> Mission:
    """Create a draft of the missed targets with the same UAVs and constraints, without departure or targets that a continuation took over.

    targets: places of those to fly again, complete or not, in place of the missed ones. UAVs begin where they return to. Raises Refused
    where the mission is not over, or nothing was missed, and InvalidRequest where its targets no longer exist.
    """
    if mission.state not in ENDED_STATES:
        raise refuse("not_over", _("A follow-up is planned once the mission is over."))
    taken_over = {_what(target) for target in InspectionTarget.objects.filter(mission__continues=mission, mission__deleted_at=None)}
    missed = {
        target.sequence
        for target in mission.targets.all()
        if (target.sequence in targets if targets is not None else target.state != TargetState.COMPLETE) and _what(target) not in taken_over
    }
    if not missed:
        none = _("No target of this mission was missed.") if targets is None else _("None of these targets is left to this mission.")
        raise refuse("nothing_missed", none)
    work = mission if mission.simulates is None else mission.simulates
    return create_mission(
        organisation=mission.organisation,
        author=author,
        name=(name or _("{name} – follow-up").format(name=mission.name[: MAX_NAME_LENGTH - 20]))[:MAX_NAME_LENGTH],
        request=request_again(mission, missed),
        external_id=work.external_id,
        attributes=work.attributes,
    )


def request_again(mission: Mission, places: Collection[int]) -> PlanRequest:
    """Return the request for some targets of a mission, by their places, with its UAVs and constraints, without departure and locks.

    UAVs begin where they return to; those of a simulated copy are the UAVs themselves.
    """
    asked = request_of_mission(mission=mission)
    wishes = tuple(wish for wish, target in zip(asked.targets, mission.targets.all(), strict=True) if target.sequence in places)
    if mission.simulates is not None:
        asked, wishes = _for_the_uavs_themselves(asked, wishes, mission.simulates)
    uavs = tuple(replace(uav, position=uav.returns_to, home=None) for uav in asked.uavs)
    return replace(asked, uavs=uavs, targets=wishes, locks=(), departs_at=None)


def _for_the_uavs_themselves(
    asked: PlanRequest, missed: tuple[TargetRequest, ...], original: Mission
) -> tuple[PlanRequest, tuple[TargetRequest, ...]]:
    """Return UAVs and targets of a simulated copy as in the mission that it is a copy of: real UAVs, their names, other systems' ids."""
    twins = Uav.objects.filter(pk__in=[uav.uav for uav in asked.uavs], twin_of__isnull=False).values_list("pk", "twin_of", "twin_of__name")
    real_of: dict[int | None, tuple[int | None, str]] = {twin: (real, name) for twin, real, name in twins}
    name_of: dict[int | None, str] = dict(original.mission_uavs.filter(uav__isnull=False).values_list("uav", "name"))
    uavs = []
    for uav in asked.uavs:
        real, name = real_of.get(uav.uav, (uav.uav, uav.name))
        uavs.append(replace(uav, uav=real, name=name_of.get(real, name)))
    names = {twin.name: uav.name for twin, uav in zip(asked.uavs, uavs, strict=True)}
    known = {_what(target): target for target in original.targets.all()}
    targets = []
    for wish in missed:
        target = known.get(_what_of(wish))
        ids = {} if target is None else {"external_id": target.external_id, "attributes": target.attributes}
        targets.append(replace(wish, uav=names.get(wish.uav, wish.uav), **ids))
    return replace(asked, uavs=tuple(uavs)), tuple(targets)


def _what(target: InspectionTarget) -> tuple[Any, ...]:
    """Return what identifies the inspected thing in any mission."""
    return (target.asset_id, *(None if shape is None else shape.coords for shape in (target.position, target.stretch)))


def _what_of(wish: TargetRequest) -> tuple[Any, ...]:
    """Return the same of a request."""
    stretch = None if wish.stretch is None else tuple(map(tuple, wish.stretch))
    return (wish.asset, None if wish.position is None else tuple(wish.position), stretch)


def duplicate_mission(*, mission: Mission, author: User, name: str = "", **other: Any) -> Mission:
    """Copy a mission with its plan: targets are pending again, and a mission on its way becomes planned.

    The copy's separation is checked against all missions approved by now, including the original. `other` are values that differ.
    """
    with transaction.atomic():
        mission = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)  # the current row, to avoid mixing two plans
        values = {field: getattr(mission, field) for field in COPIED} | other
        values["plan_quality"] = {name: value for name, value in (mission.plan_quality or {}).items() if name != "proof"} or None
        if values["state"] != MissionState.DRAFT:
            values["state"] = MissionState.PLANNED
        copy = Mission.objects.create(author=author, name=(name or _free_name(mission))[:MAX_NAME_LENGTH], **values)
        uavs = _copied(MissionUav, mission.mission_uavs.all(), mission=copy)
        targets = _copied(InspectionTarget, mission.targets.all(), mission=copy, **NOT_FLOWN)
        rows = list(mission.routes.prefetch_related("waypoints"))
        routes = [_copy_of(route, mission=copy, mission_uav=uavs[route.mission_uav_id]) for route in rows]
        Route.objects.bulk_create(routes)
        waypoints = [
            _copy_of(waypoint, route=route, target=targets.get(waypoint.target_id))
            for old, route in zip(rows, routes, strict=True)
            for waypoint in old.waypoints.all()
        ]
        Waypoint.objects.bulk_create(waypoints, batch_size=1_000)
        if mission.separation is not None:
            copy.separation = separation_of_stored(copy)
            copy.save(update_fields=["separation"])
        note(copy, author, "duplicate", before=None, after={"name": copy.name, "of": mission.name, "of_id": str(mission.pk)})
    return copy


def _copied(model: type[Model], rows: Iterable[Any], **values: Any) -> dict[int | None, Any]:
    """Copy rows to the new mission; returns them by the primary keys of the old ones."""
    old = list(rows)
    new = model._default_manager.bulk_create([_copy_of(row, **values) for row in old])
    return {before.pk: after for before, after in zip(old, new, strict=True)}


def _copy_of(row: Any, **values: Any) -> Any:
    fields = {field.attname: getattr(row, field.attname) for field in row._meta.concrete_fields if not field.primary_key}
    for name in values:
        fields.pop(row._meta.get_field(name).attname, None)
    return type(row)(**fields, **values)


def _free_name(mission: Mission) -> str:
    """Return a free name: "North (copy)", then "North (copy 2)"."""
    stem = mission.name[: MAX_NAME_LENGTH - 12]
    taken = set(
        Mission.objects.filter(organisation=mission.organisation, deleted_at=None, name__startswith=stem).values_list("name", flat=True)
    )
    name, number = f"{stem} (copy)", 2
    while name in taken:
        name, number = f"{stem} (copy {number})", number + 1
    return name
