"""Photos of a mission."""

from collections.abc import Iterable, Iterator
from datetime import timedelta

from django.conf import settings
from django.db.models import Count, QuerySet
from django.utils import timezone

from mavlink.decoding.captures import AttitudeSource
from mavlink.decoding.gimbal_attitude import YawFrame
from missions.hooks.taken_photos import PhotoOfMission
from missions.models import Mission
from planning.views.proof import TakenPhoto
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


def achieved_photos(mission: Mission) -> list[PhotoOfMission] | None:
    """Return the photos that UAVs of a mission reported, for what they prove; None while nothing was flown or reported, and of
    flights whose telemetry is not kept any more.

    Where only the vehicle's attitude is known, or a yaw from its nose, the camera's is unknown.
    """
    oldest = None if settings.TELEMETRY_DAYS <= 0 else timezone.now() - timedelta(days=settings.TELEMETRY_DAYS)
    if oldest is not None and mission.started_at is not None and mission.started_at < oldest:
        return None  # they have been deleted with the telemetry, or soon are
    places = {row.uav_id: row.sequence for row in mission.mission_uavs.all()}
    found = [_photo(one, places.get(one.uav_id)) for one in Capture.objects.filter(mission=mission).order_by(*ORDER).iterator()]
    return found if found or mission.started_at is not None else None


def _photo(one: Capture, uav: int | None) -> PhotoOfMission:
    is_aimed = one.attitude_source in {AttitudeSource.CAMERA, AttitudeSource.GIMBAL} and one.yaw_frame == YawFrame.EARTH
    lon, lat = (None, None) if one.position is None else one.position.coords
    yaw_deg, pitch_deg, roll_deg = (one.yaw_deg, one.pitch_deg, one.roll_deg) if is_aimed else (None, None, None)
    photo = TakenPhoto(lon, lat, one.altitude_amsl_m, yaw_deg, pitch_deg, roll_deg, one.is_taken)
    return PhotoOfMission(photo, uav, one.waypoint_sequence, one.altitude_relative_m, one.flight or 1)
