"""Photos of a mission."""

from collections.abc import Iterable, Iterator

from django.db.models import Count, QuerySet

from missions.models import Mission
from telemetry.exports.captures import STORED, CaptureRow
from telemetry.models import Capture

ROWS_AT_ONCE = 2_000
ORDER = ("taken_at", "pk")


def captures_of_mission(mission: Mission) -> QuerySet[Capture]:
    return Capture.objects.filter(mission=mission).select_related("uav")


def capture_rows(captures: Iterable[Capture]) -> Iterator[CaptureRow]:
    """Yield the rows of captures that were read with their UAVs."""
    for one in captures:
        place = one.position
        yield CaptureRow(
            id=one.pk,
            uav=one.uav_id,
            uav_name=one.uav.name,
            mission=None if one.mission_id is None else str(one.mission_id),
            taken_at=one.taken_at,
            received_at=one.received_at,
            position=None if place is None else (place.x, place.y),
            values=tuple(getattr(one, name) for name in STORED),
        )


def all_captures(mission: Mission) -> Iterator[CaptureRow]:
    """Yield all photos of a mission by time, with at most some thousand in memory."""
    return capture_rows(captures_of_mission(mission).order_by(*ORDER).iterator(chunk_size=ROWS_AT_ONCE))


def photos_by_uav(mission: Mission) -> dict[int, int]:
    """Return the numbers of photos taken in a mission."""
    taken = Capture.objects.filter(mission=mission, is_taken=True).order_by()
    return dict(taken.values_list("uav_id").annotate(Count("pk")))
