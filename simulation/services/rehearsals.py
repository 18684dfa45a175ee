"""Rehearsals from request to assessment."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from functools import lru_cache
from typing import Any
from uuid import UUID

from django.conf import settings
from django.db import transaction
from django.db.models import Count, Max, Q
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.selectors.planning import PlanningGround, heights_at, planning_read
from mavlink.vehicle_plan import MissionItem
from missions.models import Mission
from missions.selectors.missions import mission_of_organisation
from missions.services.approval.approval import ACKNOWLEDGE_FAILED_REHEARSAL
from missions.services.commands.refused import RefusalReason, Refused
from missions.services.missions import note
from operation.reasons import Reason, Why
from simulation.assessment.flown import AssessedRoute
from simulation.assessment.judging import Assessment, judge, wind_finding
from simulation.assessment.limits import AssessmentFinding, AssessmentLimits, Level, limits_to_json, worst
from simulation.assessment.stored import assessment_to_json, track_to_json
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.events import Crashed, Event, PhotoTaken, StatusTextSent
from simulation.flight.states import FlightMode, Outcome, Severity, SimulatedState
from simulation.flight.uav import SimulatedUav
from simulation.models import AssessmentLevel, Rehearsal, RehearsalRule, RehearsalRun, RehearsalTrack
from simulation.rehearsing.flying import MakeVehicle, RehearsedVehicle, Start, fly
from simulation.rehearsing.ground import BlockedGround, Heights
from simulation.rehearsing.scenario_weather import weather_of
from simulation.rehearsing.weather_scenario import Named, WeatherScenario, named_scenario, scenario_from_json, scenario_to_json
from simulation.selectors import newest_finished, rehearsals_of_mission, requires_green
from simulation.services.fleet import StandIn, stand_in_to_json
from simulation.services.plan_to_fly import PlanToFly, ground_of_plan, plan_to_fly, surroundings_of
from simulation.vehicle_protocol.fence import rally_points_of
from workspace.audit import record_change
from workspace.jobs.services import cancel_job, create_job_within, finish_job
from workspace.models import Job, JobState, Organisation, User

REUSED_FOR = timedelta(hours=24)  # another version of the program may fly differently
REHEARSE = "simulation.tasks.rehearse_mission"
KEPT = 20  # rehearsals per mission; older ones are deleted
OnProgress = Callable[[Why, float], None]


class RehearsedUav:
    """A simulated UAV with the interface for rehearsals."""

    def __init__(self, uav: SimulatedUav) -> None:
        self._uav = uav
        self._events: list[Event] = []

    @property
    def now_s(self) -> float:
        return self._uav.now_s

    @property
    def state(self) -> SimulatedState:
        return self._uav.state

    def step(self) -> None:
        self._uav.step()

    def load(self, items: Sequence[MissionItem], rally: Sequence[MissionItem]) -> Outcome:
        self._uav.rally_points = rally_points_of(rally, self._uav.state.home_amsl_m)
        return self._uav.load(items)

    def arm(self) -> Outcome:
        return self._uav.arm()

    def take_off(self, height_relative_m: float) -> Outcome:
        return self._uav.take_off(height_relative_m)

    def start_mission(self) -> Outcome:
        return self._uav.set_mode(FlightMode.MISSION)

    def take_texts(self) -> list[Reason | str]:
        """Return its problem reports since the last call. The reason of a crash is included once."""
        self._take_events()
        events = [event for event in self._events if not isinstance(event, PhotoTaken)]
        self._events = [event for event in self._events if isinstance(event, PhotoTaken)]
        reasons = [event.reason for event in events if isinstance(event, Crashed)]
        stated = [event.text for event in events if isinstance(event, StatusTextSent) and event.severity is not Severity.INFO]
        return [text for text in stated if not (isinstance(text, Reason) and text.code == "crashed")] + reasons

    def take_photos(self) -> list[PhotoTaken]:
        """Return the photos since the last call."""
        self._take_events()
        photos = [event for event in self._events if isinstance(event, PhotoTaken)]
        self._events = [event for event in self._events if not isinstance(event, PhotoTaken)]
        return photos

    def _take_events(self) -> None:
        self._events += self._uav.take_events()


def vehicle_maker(stand_ins: Sequence[StandIn], scenario: WeatherScenario, terrain: Heights | None) -> MakeVehicle:
    """Return the function that makes the UAV of each flight: its airframe with the real UAV's battery, charged by the conditions."""
    by_uav = {stand_in.uav: stand_in for stand_in in stand_ins}
    weather = weather_of(scenario)

    def make(start: Start) -> RehearsedVehicle:
        stand_in = by_uav[start.uav]
        airframe = replace(AIRFRAMES[stand_in.airframe], battery_wh=stand_in.battery_wh)
        home_m = 0.0 if start.ground_amsl_m is None else start.ground_amsl_m
        ground = BlockedGround(None if start.ground_amsl_m is None else terrain, home_m)
        uav = SimulatedUav(
            airframe, start.home, ground=ground, weather=weather, seed=start.seed, heading_deg=start.heading_deg,
            battery_percent=scenario.battery_percent, camera=stand_in.camera,
        )  # fmt: skip
        return RehearsedUav(uav)

    return make


def take_flown_before(run: RehearsalRun) -> bool:
    """Copy assessment and tracks from an equal earlier run, if there is one; `finished_at` keeps the time of that flight.

    The rehearsal must already have the hash of its surroundings.
    """
    rehearsal = run.rehearsal
    alike = RehearsalRun.objects.filter(
        rehearsal__mission=rehearsal.mission_id,
        rehearsal__content_sha256=rehearsal.content_sha256,
        rehearsal__ground_revision=rehearsal.ground_revision,
        rehearsal__ground_sha256=rehearsal.ground_sha256,
        rehearsal__seed=rehearsal.seed,
        rehearsal__limits=rehearsal.limits,
        rehearsal__uavs=rehearsal.uavs,
        conditions=run.conditions,
        finished_at__gte=timezone.now() - REUSED_FOR,
    )
    before = alike.exclude(pk=run.pk).order_by("-finished_at").first()
    if before is None:
        return False
    with transaction.atomic():
        held = RehearsalRun.objects.select_for_update().get(pk=run.pk)
        if held.finished_at is None:
            held.assessment, held.level, held.took_s, held.finished_at = before.assessment, before.level, before.took_s, before.finished_at
            held.save()
            RehearsalTrack.objects.bulk_create(
                RehearsalTrack(run=held, uav=track.uav, flights=track.flights) for track in before.tracks.all()
            )
    return True


class PlanChanged(Exception):
    """The mission has changed since the request."""


class GroundChanged(Exception):
    """Parts were flown with other surroundings than the present ones."""


def start_rehearsal(
    *, mission: Mission, actor: User, scenarios: Sequence[WeatherScenario], seed: int = 7, afresh: bool = False
) -> Rehearsal:
    """Create a rehearsal, which a job flies. Raises Refused if there is nothing to fly, TooManyJobs.

    Equal recent runs are reused and not flown again, unless `afresh`.
    """
    plan, ground = plan_to_fly(mission), planning_read().ground()
    with transaction.atomic():
        job = create_job_within(
            settings.MAX_OPEN_REHEARSALS,
            organisation=mission.organisation,
            created_by=actor,
            task=REHEARSE,
            parameters={"mission": str(mission.pk), "afresh": afresh},
            message=Reason("waiting_for_worker"),
        )
        rehearsal = Rehearsal.objects.create(
            organisation=mission.organisation,
            mission=mission,
            job=job,
            content_sha256=plan.content_sha256,
            mission_revision=mission.revision,
            ground_revision=ground.dataset_version[0],
            ground_sha256=ground_of_plan(plan, ground),
            uavs=[stand_in_to_json(stand_in) for stand_in in plan.stand_ins],
            seed=seed,
            limits=limits_to_json(limits_of_settings()),
            created_by=actor,
        )
        RehearsalRun.objects.bulk_create(
            RehearsalRun(rehearsal=rehearsal, sequence=number, conditions=scenario_to_json(scenario))
            for number, scenario in enumerate(scenarios)
        )
        _forget_old(mission)
        facts = {
            "rehearsal": str(rehearsal.pk),
            "conditions": [str(scenario.code) for scenario in scenarios],
            "sha256": plan.content_sha256,
        }
        note(mission, actor, "rehearse", before=None, after=facts)
    return rehearsal


def cancel_rehearsal(*, rehearsal: Rehearsal, actor: User) -> Job:
    """Stop the rehearsal and keep completed runs."""
    job = cancel_job(job=rehearsal.job)
    note(rehearsal.mission, actor, "cancel-rehearsal", before=None, after={"rehearsal": str(rehearsal.pk)})
    return job


def rehearse_for_job(*, job: Job, progress: OnProgress) -> None:
    """Fly the missing runs, all with the same surroundings, and end the job.

    Raises PlanChanged, GroundChanged, Refused, and what `progress` raises.
    """
    rehearsal = Rehearsal.objects.select_related("mission__organisation").get(job=job)
    mission = mission_of_organisation(rehearsal.organisation, rehearsal.mission_id)
    plan = plan_to_fly(mission)
    if plan.content_sha256 != rehearsal.content_sha256:
        raise PlanChanged
    ground = planning_read().ground()
    _stand_on(rehearsal, plan, ground)
    runs = list(rehearsal.runs.select_related("rehearsal"))
    is_afresh = bool(job.parameters.get("afresh"))
    for number, run in enumerate(runs):
        if run.finished_at is not None or (not is_afresh and take_flown_before(run)):
            continue
        _fly_run(run, plan, ground, rehearsal.seed, _shares(progress, number, len(runs)))
    _finish(rehearsal.pk, job)


def _stand_on(rehearsal: Rehearsal, plan: PlanToFly, ground: PlanningGround) -> None:
    """Store the present surroundings with the rehearsal, as they may have changed since the request."""
    known, now = rehearsal.ground_sha256, ground_of_plan(plan, ground)
    with transaction.atomic():
        held = Rehearsal.objects.select_for_update(of=("self",)).get(pk=rehearsal.pk)
        if held.runs.exclude(finished_at=None).exists():
            if known != now:
                raise GroundChanged
            return
        held.ground_revision, held.ground_sha256 = ground.dataset_version[0], now
        held.save(update_fields=["ground_revision", "ground_sha256"])


def limits_of_settings() -> AssessmentLimits:
    return AssessmentLimits.of(
        settings.FLIGHT_RULES,
        settings.SEPARATION_RULES,
        zone_beside_m=settings.GRAPH_RULES.zone_clearance_m,
        zone_height_m=settings.ZONE_RULES.height_margin_m,
    )


def _shares(progress: OnProgress, number: int, runs: int) -> Callable[[float], None]:
    def reported(share: float) -> None:
        progress(Reason("flying_run", {"number": number + 1, "all": runs}), (number + share) / runs)

    return reported


def _fly_run(run: RehearsalRun, plan: PlanToFly, ground: PlanningGround, seed: int, on_progress: Callable[[float], None]) -> None:
    began_s = time.monotonic()
    scenario = scenario_from_json(run.conditions)
    maker = vehicle_maker(plan.stand_ins, scenario, heights_at(ground.dataset_version))
    on_progress(0.0)
    flown = fly(plan.routes, maker, turnaround_s=settings.FLIGHT_RULES.turnaround_s, seed=seed, on_progress=on_progress)
    around = surroundings_of(plan, ground)
    assessment = judge(flown, around, limits_of_settings(), known=[*_too_windy(plan, scenario), *_mid_air_starts(plan)])
    _store(run, flown, assessment, time.monotonic() - began_s)


def _too_windy(plan: PlanToFly, scenario: WeatherScenario) -> list[AssessmentFinding]:
    """Check the wind against the slower of the UAV and its airframe."""
    found = (
        wind_finding(route.uav, route.route, scenario.conditions, min(route.limit_mps, AIRFRAMES[stand_in.airframe].max_airspeed_mps))
        for route, stand_in in zip(plan.routes, plan.stand_ins, strict=True)
    )
    return [finding for finding in found if finding is not None]


def _mid_air_starts(plan: PlanToFly) -> list[AssessmentFinding]:
    """Report UAVs with a mid-air start: in reality they have no take-off of their own, and a partly used battery."""
    return [AssessmentFinding(Level.WARNINGS, "begun-in-air", route.uav) for route in plan.routes if route.route.begun_by is not None]


def _store(run: RehearsalRun, flown: Sequence[AssessedRoute], assessment: Assessment, took_s: float) -> None:
    """Store a run once and completely; another worker that took over finds all or nothing."""
    with transaction.atomic():
        held = RehearsalRun.objects.select_for_update(of=("self",)).select_related("rehearsal").get(pk=run.pk)
        if held.finished_at is not None or held.rehearsal.ground_sha256 != run.rehearsal.ground_sha256:
            return
        held.assessment, held.level, held.took_s = assessment_to_json(assessment), str(assessment.level), took_s
        held.finished_at = timezone.now()
        held.save()
        RehearsalTrack.objects.bulk_create(RehearsalTrack(run=held, uav=route.uav, flights=track_to_json(route.tracks)) for route in flown)


def _finish(rehearsal_id: UUID, job: Job) -> None:
    with transaction.atomic():
        levels = [Level(level) for level in RehearsalRun.objects.filter(rehearsal=rehearsal_id).values_list("level", flat=True)]
        level = worst(levels)
        result: dict[str, Any] = {"rehearsal": str(rehearsal_id), "level": str(level)}
        if finish_job(job=job, result=result, message=Reason("rehearsed")):
            Rehearsal.objects.filter(pk=rehearsal_id).update(level=str(level))


def _forget_old(mission: Mission) -> None:
    """Delete completed rehearsals beyond KEPT."""
    keys = list(Rehearsal.objects.filter(mission=mission).order_by("-created_at").values_list("pk", flat=True)[KEPT:])
    for old in Rehearsal.objects.filter(pk__in=keys).exclude(job__state__in=("queued", "running")).select_related("job"):
        old.delete()


def reasons_without_rehearsal(mission: Mission) -> list[RefusalReason]:
    """Return why a mission cannot be approved yet, and what to do.

    Where the organisation requires no rehearsal, a failed one of this plan has to be acknowledged.
    """
    if not requires_green(mission.organisation_id):
        return _failed_rehearsal(mission)
    try:
        plan = plan_to_fly(mission)
    except Refused as refused:
        return list(refused.reasons)
    newest = newest_finished(mission.pk, plan.content_sha256)
    if newest is None:
        if rehearsals_of_mission(mission.organisation, mission.pk).exclude(level="").exists():
            words = _("The plan has changed since it was rehearsed. Rehearse it again: your organisation approves only what has passed.")
            return [RefusalReason("rehearsal_outdated", words)]
        return [RefusalReason("not_rehearsed", _("Rehearse the mission first: your organisation approves only what has passed."))]
    if newest.level == AssessmentLevel.FAIL:
        words = _("The rehearsal failed. Change the plan for what its assessment says, plan and rehearse it again.")
        return [RefusalReason("rehearsal_failed", words)]
    if not newest.runs.filter(conditions__code=str(Named.AS_PLANNED)).exists():
        words = _("The rehearsal left out the conditions that the mission is planned for. Rehearse it again with them.")
        return [RefusalReason("rehearsal_without_planned_conditions", words)]
    if not newest.runs.filter(conditions=scenario_to_json(named_scenario(Named.AS_PLANNED, plan.conditions))).exists():
        words = _("The mission is planned for other wind or temperature than it was rehearsed in. Rehearse it again.")
        return [RefusalReason("rehearsal_in_other_air", words)]
    if not _is_on_this_ground(newest, plan):
        words = _("Zones, terrain, towers or wires about the routes have changed since the mission was rehearsed. Rehearse it again.")
        return [RefusalReason("rehearsal_on_other_ground", words)]
    return []


def failed_rehearsals(missions: Sequence[Mission]) -> set[UUID]:
    """Return the keys of the missions whose present plan failed its newest rehearsal."""
    done = Rehearsal.objects.filter(mission__in=[mission.pk for mission in missions], job__state=JobState.DONE).order_by()
    newest = {
        row["mission"]: row["newest"]
        for row in done.values("mission").annotate(newest=Max("created_at"), failed=Count("pk", filter=Q(level=AssessmentLevel.FAIL)))
        if row["failed"]
    }
    return {
        mission.pk
        for mission in missions
        if mission.pk in newest and _had_failed(mission.organisation_id, mission.pk, mission.revision, newest[mission.pk])
    }


@lru_cache(maxsize=1_000)
def _had_failed(organisation_id: int, mission_id: UUID, revision: int, newest: datetime) -> bool:
    """Return _has_failed for a list, where a plan is not made into a document again until the mission or its rehearsals change."""
    return _has_failed(mission_of_organisation(Organisation(pk=organisation_id), mission_id))


def _has_failed(mission: Mission) -> bool:
    """Return whether the newest rehearsal of the present plan failed. mission: as loaded by mission_of_organisation."""
    try:
        newest = newest_finished(mission.pk, plan_to_fly(mission).content_sha256)
    except Refused:  # it can be flown, but not rehearsed any more
        return False
    return newest is not None and newest.level == AssessmentLevel.FAIL


def _failed_rehearsal(mission: Mission) -> list[RefusalReason]:
    if not Rehearsal.objects.filter(mission=mission.pk, level=AssessmentLevel.FAIL).exists() or not _has_failed(mission):
        return []
    words = _("The rehearsal of this plan failed. Change the plan, or say why it is approved nevertheless.")
    return [RefusalReason(ACKNOWLEDGE_FAILED_REHEARSAL, words)]


def _is_on_this_ground(rehearsal: Rehearsal, plan: PlanToFly) -> bool:
    """Return whether the surroundings of the routes are unchanged.

    They are compared by hash: a newer network of the same revision may have other towers and wires.
    """
    return rehearsal.ground_sha256 == ground_of_plan(plan, planning_read().ground())


def set_rule(*, organisation: Organisation, actor: User, requires: bool) -> RehearsalRule:
    with transaction.atomic():
        before = requires_green(organisation.pk)
        rule, _made = RehearsalRule.objects.update_or_create(organisation=organisation, defaults={"requires_green": requires})
        if before != requires:
            record_change(
                organisation=organisation, actor=actor, action="changed", subject_type="rehearsal rule", subject_id=organisation.pk,
                before={"requires_green": before}, after={"requires_green": requires},
            )  # fmt: skip
    return rule
