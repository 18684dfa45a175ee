"""Reads of rehearsals, always within one organisation."""

from uuid import UUID

from django.db.models import QuerySet

from missions.models import UavType
from simulation.models import Rehearsal, RehearsalRule, RehearsalTrack, SimulatedAirframe
from workspace.models import JobState, Organisation


def rehearsals_of_mission(organisation: Organisation, mission_id: UUID) -> QuerySet[Rehearsal]:
    """Return the rehearsals without details of their assessments; see rehearsal_of_mission."""
    found = Rehearsal.objects.filter(organisation=organisation, mission=mission_id, mission__deleted_at=None)
    return found.select_related("job", "created_by").prefetch_related("runs")


def rehearsal_of_mission(organisation: Organisation, mission_id: UUID, rehearsal_id: UUID) -> Rehearsal:
    """Return a rehearsal. Raises Rehearsal.DoesNotExist, also for another organisation's."""
    return rehearsals_of_mission(organisation, mission_id).select_related("mission").get(pk=rehearsal_id)


def tracks_of_run(rehearsal: Rehearsal, sequence: int) -> QuerySet[RehearsalTrack]:
    return RehearsalTrack.objects.filter(run__rehearsal=rehearsal, run__sequence=sequence).order_by("uav")


def newest_finished(mission_id: UUID, content_sha256: str) -> Rehearsal | None:
    """Return the newest completed rehearsal of exactly this content."""
    found = Rehearsal.objects.filter(mission=mission_id, content_sha256=content_sha256, job__state=JobState.DONE)
    return found.order_by("-created_at").first()


def requires_green(organisation_id: int) -> bool:
    return RehearsalRule.objects.filter(organisation=organisation_id, requires_green=True).exists()


def chosen_airframe(uav_type: UavType) -> str | None:
    return SimulatedAirframe.objects.filter(uav_type=uav_type).values_list("airframe", flat=True).first()
