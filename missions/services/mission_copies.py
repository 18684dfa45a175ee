"""A second mission like the first, its plan included."""

from collections.abc import Iterable
from typing import Any

from django.db import transaction
from django.db.models import Model

from missions.models import InspectionTarget, Mission, MissionState, MissionUav, Route, TargetState, Waypoint
from missions.models.missions import LONGEST_NAME
from missions.services.missions import note
from missions.services.still_apart import separation_of_stored
from workspace.models import User

COPIED = (
    "organisation_id", "state", "objective", "return_to_start", "planned_at", "graph_version", "ground_revision", "flat_ground_assumed",
    "total_length_m", "longest_route_m", "plan_warnings", "last_plan", "locks", "plan_quality",
    "departs_at", "conditions", "charging_w", "total_energy_wh", "separation", "lost_link",
    "lost_link_check", "external_id", "attributes",
)  # fmt: skip
NOT_FLOWN: dict[str, Any] = {
    "state": TargetState.PENDING, "state_at": None, "state_reason": "", "reached_at": None, "held_s": None, "visit_stored_at": None,
}  # fmt: skip


def duplicate_mission(*, mission: Mission, author: User, name: str = "", **other: Any) -> Mission:
    """A copy of its own: targets are pending again, and a mission that was on its way is merely planned.

    It is compared with what is approved by now, the mission itself among it. `other` are values that differ from the mission's.
    """
    with transaction.atomic():
        mission = Mission.objects.select_for_update(no_key=True).get(
            pk=mission.pk
        )  # as it is now: never half of one plan and half of the next
        values = {field: getattr(mission, field) for field in COPIED} | other
        if values["state"] != MissionState.DRAFT:
            values["state"] = MissionState.PLANNED
        copy = Mission.objects.create(author=author, name=(name or _free_name(mission))[:LONGEST_NAME], **values)
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
    """The rows under the new mission, by the primary keys of the old ones."""
    old = list(rows)
    new = model._default_manager.bulk_create([_copy_of(row, **values) for row in old])
    return {before.pk: after for before, after in zip(old, new, strict=True)}


def _copy_of(row: Any, **values: Any) -> Any:
    fields = {field.attname: getattr(row, field.attname) for field in row._meta.concrete_fields if not field.primary_key}
    for name in values:
        fields.pop(row._meta.get_field(name).attname, None)
    return type(row)(**fields, **values)


def _free_name(mission: Mission) -> str:
    """ "North (copy)", then "North (copy 2)"."""
    stem = mission.name[: LONGEST_NAME - 12]
    taken = set(
        Mission.objects.filter(organisation=mission.organisation, deleted_at=None, name__startswith=stem).values_list("name", flat=True)
    )
    name, number = f"{stem} (copy)", 2
    while name in taken:
        name, number = f"{stem} (copy {number})", number + 1
    return name
