"""Demo missions, made by the planner and simulated UAVs: one flown, one in flight and one planned; and their removal."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Protocol
from uuid import UUID

from django.contrib.gis.db.models.functions import Distance
from django.contrib.gis.measure import D
from django.db import transaction
from django.db.models import Q
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.demo_region import BASES
from inspection.geodesy import LonLat
from inspection.models import Asset, AssetKind
from missions.models import Base, Mission, MissionState, MissionUav, Uav, UavCommand, UavType
from missions.selectors.fleet import performance_of
from missions.services import PlanRequest, TargetRequest, UavRequest, create_mission, plan_mission
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.refused import refuse
from missions.services.fleet.demo_uavs import create_demo_uavs
from operation.reasons import Reason, Why
from planning.energy.conditions import Conditions, WindLayer
from planning.problem import Objective
from planning.request import EndAction
from planning.task import Task, TaskKind
from simulation.models import Simulation
from simulation.services.demo_flights import fly_demo_mission
from simulation.services.simulations import end_simulation
from simulation.vehicle_models import PRESENT
from workspace.audit import record_change
from workspace.jobs.services import cancel_job, create_job
from workspace.models import Job, Organisation, User

MAKE_DEMO_MISSIONS = "simulation.tasks.make_demo_missions"
MAX_SPEED = 10.0  # factor on real time, for the flight that is to end soon
FROZEN_IN_FLIGHT = (MissionState.APPROVED, *ON_ITS_WAY)


class OnProgress(Protocol):
    """Receives the present activity and the completed share."""

    def __call__(self, message: Why, share: float) -> None: ...


@dataclass(frozen=True)
class DemoMission:
    """Definition of a demo mission. Targets are towers in a range of distances from the UAVs' bases, evenly picked.

    speed: factor on real time of its flight; None: it stays planned.
    """

    name: str
    uavs: tuple[str, ...]
    targets: int
    between_m: tuple[float, float]
    task: Task
    speed: float | None
    wind: tuple[WindLayer, ...] = ()
    sorties: int = 1
    departs_in_h: float | None = None


DEMO_MISSIONS = (
    DemoMission("Demo: Varneck lines", ("Osprey 1",), 10, (400.0, 3_500.0), Task(TaskKind.PHOTO, 30.0), 1.0),
    DemoMission(
        "Demo: Elmsgard and Varneck, in wind", ("Kestrel 2", "Osprey 2"), 14, (600.0, 5_000.0), Task(TaskKind.PHOTO, 30.0), None,
        wind=(WindLayer(60.0, 6.0, 240.0),), sorties=2, departs_in_h=3.0,
    ),
    DemoMission("Demo: Elmsgard lines", ("Kestrel 1",), 4, (300.0, 1_500.0), Task(TaskKind.PHOTO, 10.0), MAX_SPEED),
)  # fmt: skip


@dataclass(frozen=True)
class Step:
    """The present activity, and the completed share."""

    message: Reason
    share: float


class NotThere(Exception):
    """The demo region has been removed."""


def has_demo_region(organisation: Organisation) -> bool:
    """Return whether its towers exist, and no other UAV of the organisation has the name of a demo UAV."""
    names = {uav.name for base in BASES for uav in base.uavs}
    if Uav.objects.filter(organisation=organisation, is_demo=False, name__in=names).exists():
        return False
    return Asset.objects.filter(kind=AssetKind.TOWER, vanished_at=None, data_import__is_synthetic=True).exists()


def open_demo_job(organisation: Organisation) -> Job | None:
    return Job.objects.filter(organisation=organisation, task=MAKE_DEMO_MISSIONS, state__in=("queued", "running")).first()


def want_demo_missions(*, organisation: Organisation, actor: User) -> Job:
    """Return the job that makes them, which may already be open."""
    with transaction.atomic():
        Organisation.objects.select_for_update(no_key=True).get(pk=organisation.pk)
        return open_demo_job(organisation) or create_job(
            organisation=organisation, created_by=actor, task=MAKE_DEMO_MISSIONS, parameters={}, message=Reason("waiting_for_worker")
        )


def make_demo_missions(*, organisation: Organisation, actor: User, since: datetime, progress: OnProgress) -> Step | None:
    """Take the next step and return at once: add missing demo UAVs, plan one mission, or advance a flight.

    since: when the job was requested. Older missions are left unchanged, as are missions that users have changed or deleted since. Returns
    None once all are planned and the fast flight is over. Raises NotThere, Refused, TimeoutError, and what `progress` raises.
    """
    if not has_demo_region(organisation):
        raise NotThere
    create_demo_uavs(organisation=organisation)
    of_demo = Mission.objects.filter(organisation=organisation, is_demo=True)
    for number, demo in enumerate(DEMO_MISSIONS):
        if not of_demo.filter(Q(deleted_at=None) | Q(created_at__gte=since), name=demo.name).exists():
            step = Step(Reason("demo_planning", {"mission": demo.name}), 0.5 * number / len(DEMO_MISSIONS))
            progress(step.message, step.share)
            _plan(demo, organisation, actor)
            return step
    for number, demo in enumerate(DEMO_MISSIONS):
        mission = of_demo.filter(deleted_at=None, name=demo.name).first()
        if demo.speed is not None and mission is not None:
            message = fly_demo_mission(mission=mission, actor=actor, speed=demo.speed, since=since)
            if message:
                return Step(message, 0.5 + 0.5 * number / len(DEMO_MISSIONS))
    return None


def missions_made(*, organisation: Organisation, since: datetime) -> list[UUID]:
    made = Mission.objects.filter(organisation=organisation, is_demo=True, deleted_at=None, created_at__gte=since)
    return list(made.order_by("created_at").values_list("pk", flat=True))


def _plan(demo: DemoMission, organisation: Organisation, actor: User) -> None:
    uavs = [Uav.objects.select_related("uav_type").get(organisation=organisation, name=name) for name in demo.uavs]
    request = PlanRequest(
        tuple(_request_of(uav, demo.sorties) for uav in uavs),
        tuple(TargetRequest(tower.pk, task=demo.task) for tower in _towers(demo, uavs)),
        Objective.MAKESPAN,
        return_to_start=True,
        conditions=Conditions(demo.wind),
        departs_at=None if demo.departs_in_h is None else timezone.now().replace(microsecond=0) + timedelta(hours=demo.departs_in_h),
        organisation=organisation.pk,
    )
    with transaction.atomic():
        mission = create_mission(organisation=organisation, author=actor, name=demo.name, request=request)
        Mission.objects.filter(pk=mission.pk).update(is_demo=True)
    plan_mission(mission=mission, actor=actor)


def _request_of(uav: Uav, sorties: int) -> UavRequest:
    return UavRequest(
        uav.name, LonLat(*uav.location.coords[:2]), uav.range_m, uav.speed_mps, EndAction.RETURN, uav=uav.pk, sensors=tuple(uav.sensors),
        performance=performance_of(uav), sorties=sorties,
    )  # fmt: skip


def _towers(demo: DemoMission, uavs: Sequence[Uav]) -> list[Asset]:
    """Return the same number of towers around each UAV's base, each once."""
    near_m, far_m = demo.between_m
    found: dict[int, Asset] = {}
    for uav in uavs:
        towers = Asset.objects.filter(
            Q(centre__distance_gte=(uav.location, D(m=near_m))) & Q(centre__distance_lte=(uav.location, D(m=far_m))),
            kind=AssetKind.TOWER, subtype="tower", is_flyable=True, vanished_at=None, data_import__is_synthetic=True,
        )  # fmt: skip
        near = list(towers.annotate(away=Distance("centre", uav.location)).order_by("away", "pk"))
        wanted = demo.targets // len(uavs)
        found |= {tower.pk: tower for tower in near[:: max(len(near) // wanted, 1)][:wanted]}
    if not found:
        raise NotThere
    return list(found.values())


def remove_demo_data(*, organisation: Organisation, actor: User) -> dict[str, int]:
    """End the simulated flights, and delete the demo missions with their records. Returns the number of deleted missions and UAVs.

    Also deletes demo UAVs without another mission, and types and bases of the demo region without a UAV. Assets and zones stay. Raises
    Refused while a real UAV may fly one of the missions.
    """
    with transaction.atomic():
        job = open_demo_job(organisation)
        missions = Mission.objects.filter(organisation=organisation, is_demo=True)
        list(missions.select_for_update(no_key=True).values_list("pk"))
        real = MissionUav.objects.filter(mission__in=missions, mission__state__in=FROZEN_IN_FLIGHT, uav__is_simulated=False)
        for name in real.values_list("uav__name", flat=True)[:1]:
            raise refuse("demo_in_flight", _("%(uav)s flies a demo mission. Revoke or abort it first.") % {"uav": name})
        for simulation in Simulation.objects.filter(mission__in=missions, state__in=PRESENT):
            end_simulation(simulation=simulation, actor=actor)
        if job is not None:
            cancel_job(job=job)
        names = list(missions.values_list("name", flat=True))
        UavCommand.objects.filter(Q(mission__in=missions) | Q(approval__mission__in=missions)).delete()
        missions.delete()
        uavs = Uav.objects.filter(organisation=organisation, is_demo=True, mission_uavs=None)
        uav_names = list(uavs.values_list("name", flat=True))
        Uav.objects.filter(pk__in=list(uavs.values_list("pk", flat=True))).delete()
        type_names = {uav.type_name for base in BASES for uav in base.uavs}
        UavType.objects.filter(organisation=organisation, name__in=type_names, uavs=None).delete()
        Base.objects.filter(organisation=organisation, name__in=[base.name for base in BASES], uavs=None).delete()
        gone = {"missions": len(names), "uavs": len(uav_names)}
        record_change(
            organisation=organisation, actor=actor, action="delete", subject_type="demo-data", subject_id=organisation.pk,
            before={"missions": names, "uavs": uav_names},
        )  # fmt: skip
    return gone
