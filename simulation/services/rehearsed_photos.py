"""Photos of rehearsals: the true poses of lenses, for what they prove of the photographed targets."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from django.db.models import F, Func, JSONField

from missions.hooks.taken_photos import PhotoOfMission, RehearsedPhotos
from missions.models import Mission
from missions.services.commands.refused import Refused
from planning.views.proof import TakenPhoto
from simulation.models import Rehearsal, RehearsalTrack
from simulation.selectors import rehearsals_of_mission
from simulation.services.plan_to_fly import plan_to_fly
from workspace.models import JobState

PHOTOS = "jsonb_path_query_array(%(expressions)s, '$[*].photos[*]')"  # of all flights of a track, without its columns


def rehearsed_photos(mission: Mission, rehearsal_id: UUID | None) -> list[RehearsedPhotos]:
    """Return the photos of each flown run of a rehearsal, without key of the newest that is done.

    mission: as loaded by mission_of_organisation. Raises LookupError where the mission has no such rehearsal.
    """
    rehearsals = rehearsals_of_mission(mission.organisation, mission.pk)
    if rehearsal_id is not None:
        rehearsal = rehearsals.filter(pk=rehearsal_id).first()
        if rehearsal is None:
            raise LookupError
    else:
        rehearsal = rehearsals.filter(job__state=JobState.DONE).order_by("-created_at").first()
        if rehearsal is None:
            return []
    is_outdated = _is_outdated(mission, rehearsal)
    tracks = RehearsalTrack.objects.filter(run__rehearsal=rehearsal).annotate(
        photos=Func(F("flights"), template=PHOTOS, output_field=JSONField())
    )
    photos: dict[int, list[PhotoOfMission]] = {}
    for run, uav, rows in tracks.values_list("run", "uav", "photos"):
        photos.setdefault(run, []).extend(_photos(uav, rows))
    return [
        RehearsedPhotos(
            rehearsal.pk, run.sequence, run.conditions["code"], run.conditions.get("name") or "", is_outdated, photos.get(run.pk, [])
        )
        for run in rehearsal.runs.all()
        if run.finished_at is not None
    ]


def _is_outdated(mission: Mission, rehearsal: Rehearsal) -> bool:
    try:
        return plan_to_fly(mission).content_sha256 != rehearsal.content_sha256
    except Refused:  # it cannot be rehearsed any more
        return mission.planned_at is None or rehearsal.created_at < mission.planned_at


def _photos(uav: int, rows: Sequence[dict[str, Any]]) -> list[PhotoOfMission]:
    return [PhotoOfMission(_taken(row), uav, row["waypoint"]) for row in rows]


def _taken(row: dict[str, Any]) -> TakenPhoto:
    lon, lat = row["position"]
    return TakenPhoto(lon, lat, row["altitude_amsl_m"], row["yaw_deg"], row["pitch_deg"], row["roll_deg"])
