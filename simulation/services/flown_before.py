"""What was flown before and would be flown alike: the same plan, air, seed and limits over the same ground."""

from datetime import timedelta

from django.db import transaction
from django.utils import timezone

from simulation.models import RehearsalRun, RehearsalTrack

REUSED_FOR = timedelta(hours=24)  # another version of the program may fly otherwise


def take_flown_before(run: RehearsalRun) -> bool:
    """Give the run the verdict and the lines of its like, if there is one; `finished_at` stays when that was flown.

    Its rehearsal names the ground that it would be flown over.
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
            held.verdict, held.level, held.took_s, held.finished_at = before.verdict, before.level, before.took_s, before.finished_at
            held.save()
            RehearsalTrack.objects.bulk_create(
                RehearsalTrack(run=held, uav=track.uav, flights=track.flights) for track in before.tracks.all()
            )
    return True
