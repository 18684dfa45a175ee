"""Missions from creation to deletion. Every write locks the mission's row, increments its revision and writes a history entry."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from datetime import datetime
from typing import Any
from uuid import UUID

from django.contrib.gis.geos import LineString, Point
from django.db import transaction
from django.utils import timezone

from inspection.geodesy import LonLat
from missions.models import InspectionTarget, Mission, MissionState, MissionUav
from missions.selectors.resolved_targets import resolved_targets
from missions.services.last_plan import summary_of_plan
from missions.services.stored_routes import lost_link_of_stored
from planning.assignment.options import refuse_contradictions
from planning.energy.conditions import Conditions, conditions_from_json, conditions_to_json
from planning.energy.performance import InvalidPerformance, Performance, performance_from_json, performance_to_json
from planning.problem import Objective
from planning.request import (
    EndAction,
    InvalidRequest,
    LockRequest,
    LostLinkRequest,
    PlanRequest,
    TargetRequest,
    UavRequest,
    lock_from_json,
    lock_to_json,
    lost_link_from_json,
    lost_link_to_json,
    moment_to_json,
    priority_from_json,
    priority_to_json,
)
from planning.task import task_from_json, task_to_json
from workspace.audit import record_change
from workspace.models import Organisation, User

BESIDE_ROUTES = ("name", "lost_link", "external_id", "attributes")  # do not affect routes
MAX_NAMES = 5  # in a history entry
EDITABLE = {MissionState.DRAFT, MissionState.PLANNED}


def as_stated_before(uav: UavRequest, before: Sequence[UavRequest]) -> UavRequest:
    """Return the UAV with its earlier fleet values for those of its own values that were sent again unchanged."""
    old = next((other for other in before if other.uav is not None and other.uav == uav.uav), None)
    if old is None or not old.fleet_figures:
        return uav
    values, stated = ({**vars(one), **vars(one.performance)} for one in (uav, old))
    kept = {name: value for name, value in old.fleet_figures.items() if name in uav.fleet_figures and values[name] == stated[name]}
    return replace(uav, fleet_figures={**uav.fleet_figures, **kept})


class MissionChanged(Exception):
    """Raised when another user changed the mission after the caller read it."""


class MissionFrozen(Exception):
    """Raised when the mission is neither a draft nor planned, so that it cannot be changed."""


@dataclass(frozen=True)
class Departure:
    """Departure of a mission; None: at any time."""

    at: datetime | None


@dataclass(frozen=True)
class Charging:
    """Power of charging at towers [W]; None: no charging."""

    power_w: float | None


@dataclass(frozen=True)
class MissionChange:
    """Changes to a mission; None leaves a part as it is."""

    name: str | None = None
    uavs: tuple[UavRequest, ...] | None = None
    targets: tuple[TargetRequest, ...] | None = None
    objective: Objective | None = None
    return_to_start: bool | None = None
    locks: tuple[LockRequest, ...] | None = None
    departure: Departure | None = None
    conditions: Conditions | None = None
    charging: Charging | None = None
    lost_link: LostLinkRequest | None = None
    external_id: str | None = None
    attributes: Mapping[str, Any] | None = None

    @property
    def drops_plan(self) -> bool:
        return any(getattr(self, part.name) is not None for part in fields(self) if part.name not in BESIDE_ROUTES)


def create_mission(
    *,
    organisation: Organisation,
    author: User | None,
    name: str,
    request: PlanRequest,
    external_id: str = "",
    attributes: Mapping[str, Any] | None = None,
) -> Mission:
    """Store a draft. Raises InvalidRequest if a target is not on the map, or constraints contradict each other."""
    refuse_contradictions(request)
    targets = _target_rows(request.targets)
    with transaction.atomic():
        mission = Mission.objects.create(
            organisation=organisation,
            author=author,
            name=name,
            objective=request.objective,
            return_to_start=request.return_to_start,
            locks=[lock_to_json(lock) for lock in request.locks],
            departs_at=request.departs_at,
            conditions=conditions_to_json(request.conditions),
            charging_w=request.charging_w,
            lost_link=lost_link_to_json(request.lost_link),
            external_id=external_id,
            attributes=dict(attributes or {}),
        )
        _store_uavs(mission, request.uavs)
        _store_targets(mission, targets)
        note(mission, author, "create", before=None, after=_summary(mission) | {"uavs": len(request.uavs), "targets": len(targets)})
    return mission


def change_mission(*, mission: Mission, actor: User, change: MissionChange, expected_revision: int | None = None) -> Mission:
    """Change a mission. New targets, UAVs or options drop its plan; new targets also drop its locks unless new ones are given.

    A new lost-link action keeps the routes and is checked on them. Raises MissionChanged, MissionFrozen, InvalidRequest or NoGraph.
    """
    targets = None if change.targets is None else _target_rows(change.targets)
    with transaction.atomic():
        locked = lock_mission(mission_id=mission.pk, expected_revision=expected_revision)
        before = _summary(locked)
        picked = _what_is_picked(locked)
        if change.drops_plan:
            drop_plan(mission=locked)  # stored with the options that it was made with
        if change.name is not None:
            locked.name = change.name
        if change.objective is not None:
            locked.objective = change.objective
        if change.return_to_start is not None:
            locked.return_to_start = change.return_to_start
        if change.departure is not None:
            locked.departs_at = change.departure.at
        if change.conditions is not None:
            locked.conditions = conditions_to_json(change.conditions)
        if change.charging is not None:
            locked.charging_w = change.charging.power_w
        if change.lost_link is not None:
            locked.lost_link = lost_link_to_json(change.lost_link)
        if change.external_id is not None:
            locked.external_id = change.external_id
        if change.attributes is not None:
            locked.attributes = dict(change.attributes)
        if change.locks is not None:
            locked.locks = [lock_to_json(lock) for lock in change.locks]
        elif targets is not None:
            locked.locks = []
        if change.uavs is not None:
            stated_before = request_of_mission(mission=locked).uavs
            locked.mission_uavs.all().delete()
            _store_uavs(locked, tuple(as_stated_before(uav, stated_before) for uav in change.uavs))
        if targets is not None:
            locked.targets.all().delete()
            _store_targets(locked, targets)
        if change.drops_plan:
            refuse_contradictions(request_of_mission(mission=locked))
        elif change.lost_link is not None:
            check_lost_link(mission=locked)
        _save(locked)
        action = "rename" if _only_renames(change) else "change"
        note(locked, actor, action, before=before, after=_summary(locked) | _differences(picked, _what_is_picked(locked)))
    return locked


def _only_renames(change: MissionChange) -> bool:
    return all(getattr(change, part.name) is None for part in fields(change) if part.name != "name")


def _what_is_picked(mission: Mission) -> dict[str, list[str]]:
    return {
        "targets": list(mission.targets.order_by("sequence").values_list("label", flat=True)),
        "uavs": list(mission.mission_uavs.order_by("sequence").values_list("name", flat=True)),
    }


def _differences(before: dict[str, list[str]], after: dict[str, list[str]]) -> dict[str, Any]:
    """Return the differences for the history: the current count, and the names of the first added and removed items."""
    found: dict[str, Any] = {}
    for what, now in after.items():
        came, went = Counter(now) - Counter(before[what]), Counter(before[what]) - Counter(now)
        found |= {what: len(now), f"{what}_added": came.total(), f"{what}_removed": went.total()}
        found[f"{what}_names"] = {"added": list(came)[:MAX_NAMES], "removed": list(went)[:MAX_NAMES]}
    return found


def delete_mission(*, mission: Mission, actor: User | None, expected_revision: int | None = None) -> Mission:
    """Mark the mission deleted; it can be restored."""
    with transaction.atomic():
        locked = lock_mission(mission_id=mission.pk, expected_revision=expected_revision)
        before = _summary(locked)
        locked.deleted_at = timezone.now()
        _save(locked)
        note(locked, actor, "delete", before=before, after=None)
    return locked


def restore_mission(*, mission: Mission, actor: User) -> Mission:
    with transaction.atomic():
        locked = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)
        if locked.deleted_at is not None:
            locked.deleted_at = None
            _save(locked)
            note(locked, actor, "restore", before=None, after=_summary(locked))
    return locked


def lock_mission(*, mission_id: UUID, expected_revision: int | None) -> Mission:
    """Return the mission's row, locked until the caller's transaction ends. Raises MissionChanged or MissionFrozen."""
    mission = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
    if mission.deleted_at is not None or (expected_revision is not None and mission.revision != expected_revision):
        raise MissionChanged
    if mission.state not in EDITABLE:
        raise MissionFrozen
    return mission


def drop_plan(*, mission: Mission) -> None:
    """Turn the mission into a draft and keep a summary of its plan; the caller holds the row and saves it."""
    mission.last_plan = summary_of_plan(mission=mission) or mission.last_plan
    mission.routes.all().delete()
    mission.targets.update(unassigned_reason="", unassigned_message="", unassigned_why=[], unassigned_missing={})
    mission.state = MissionState.DRAFT
    mission.planned_at = mission.graph_version = mission.ground_revision = mission.flat_ground_assumed = None
    mission.total_length_m = mission.longest_route_m = mission.total_energy_wh = None
    mission.separation = mission.lost_link_check = None
    mission.plan_quality = None
    mission.plan_warnings = []


def check_lost_link(*, mission: Mission) -> None:
    """Check the lost-link action on the stored routes; the caller holds the row and saves it. Raises NoGraph or InvalidRequest."""
    mission.lost_link_check = lost_link_of_stored(mission, request_of_mission(mission=mission))


def request_of_mission(*, mission: Mission) -> PlanRequest:
    """Return the planning request of this mission, with UAVs and targets in their order."""
    return PlanRequest(
        uavs=tuple(
            UavRequest(
                name=row.name,
                position=LonLat(*row.start.coords),
                max_range_m=row.max_range_m,
                cruise_speed_mps=row.cruise_speed_mps,
                end_action=EndAction(row.end_action),
                uav=row.uav_id,
                most_targets=row.most_targets,
                sensors=tuple(row.sensors),
                performance=_performance(row),
                sorties=row.sorties,
                home=None if row.home is None else LonLat(*row.home.coords),
                own_figures=tuple(row.own_figures),
                fleet_figures=row.fleet_figures,
            )
            for row in mission.mission_uavs.all()
        ),
        targets=tuple(
            TargetRequest(
                asset=row.asset_id,
                position=LonLat(*row.position.coords) if row.position else None,
                stretch=(LonLat(*row.stretch.coords[0]), LonLat(*row.stretch.coords[-1])) if row.stretch else None,
                task=task_from_json(row.task),
                priority=priority_from_json(row.priority),
                uav=row.uav_name,
                sensor=row.sensor,
                external_id=row.external_id,
                attributes=row.attributes,
            )
            for row in mission.targets.all()
        ),
        objective=Objective(mission.objective),
        return_to_start=mission.return_to_start,
        locks=tuple(lock_from_json(lock) for lock in mission.locks),
        departs_at=mission.departs_at,
        conditions=conditions_from_json(mission.conditions),
        charging_w=mission.charging_w,
        lost_link=lost_link_from_json(mission.lost_link),
    )


def _performance(row: MissionUav) -> Performance:
    """Return the performance as stored with the mission."""
    try:
        return performance_from_json(row.performance)
    except InvalidPerformance as error:
        raise InvalidRequest({f"uavs.{row.sequence}.{error.place}": error.message}) from error


def _target_rows(targets: tuple[TargetRequest, ...]) -> list[InspectionTarget]:
    """Return unsaved rows with each target's current label and task. Raises InvalidRequest."""
    places, _ = resolved_targets(targets)
    rows = []
    for place in places:
        target = targets[place.target]
        rows.append(
            InspectionTarget(
                sequence=place.target,
                asset_id=target.asset,
                label=place.label[:255],
                position=Point(*target.position, srid=4326) if target.position else None,
                stretch=LineString(*target.stretch, srid=4326) if target.stretch else None,
                task=task_to_json(place.task),
                priority=priority_to_json(target.priority),
                uav_name=target.uav,
                sensor=target.sensor,
                external_id=target.external_id,
                attributes=dict(target.attributes),
            )
        )
    return rows


def _store_targets(mission: Mission, rows: list[InspectionTarget]) -> None:
    for row in rows:
        row.mission = mission
    InspectionTarget.objects.bulk_create(rows)


def _store_uavs(mission: Mission, uavs: tuple[UavRequest, ...]) -> None:
    MissionUav.objects.bulk_create(
        MissionUav(
            mission=mission,
            uav_id=uav.uav,
            sequence=sequence,
            name=uav.name,
            start=Point(*uav.position, srid=4326),
            max_range_m=uav.max_range_m,
            cruise_speed_mps=uav.cruise_speed_mps,
            end_action=uav.end_action,
            most_targets=uav.most_targets,
            sensors=list(uav.sensors),
            performance=performance_to_json(uav.performance),
            sorties=uav.sorties,
            home=None if uav.home is None else Point(*uav.home, srid=4326),
            own_figures=list(uav.own_figures),
            fleet_figures=dict(uav.fleet_figures),
        )
        for sequence, uav in enumerate(uavs)
    )


def _save(mission: Mission) -> None:
    mission.revision += 1
    mission.save()


def _summary(mission: Mission) -> dict[str, Any]:
    return {
        "name": mission.name,
        "external_id": mission.external_id,
        "attributes": mission.attributes,
        "state": str(mission.state),
        "revision": mission.revision,
        "objective": str(mission.objective),
        "return_to_start": mission.return_to_start,
        "departs_at": moment_to_json(mission.departs_at),
        "conditions": mission.conditions,
        "charging_w": mission.charging_w,
        "lost_link": mission.lost_link,
        "locks": len(mission.locks),
        "total_length_m": mission.total_length_m,
        "graph_version": mission.graph_version,
    }


def note(mission: Mission, actor: User | None, action: str, *, before: Any, after: Any) -> None:
    record_change(
        organisation=mission.organisation,
        actor=actor,
        action=action,
        subject_type="mission",
        subject_id=mission.pk,
        before=before,
        after=after,
    )
