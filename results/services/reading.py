"""Reads received media: what they state and what they show, in a process with limits; then places them."""

import logging
import tempfile
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from celery.exceptions import SoftTimeLimitExceeded
from django.conf import settings
from django.contrib.gis.geos import Point
from django.db import OperationalError, transaction
from django.utils import timezone

from results.media_metadata.media_types import MEDIA_TYPES
from results.media_metadata.photo_process import ReadPhoto, read_photo
from results.media_metadata.record import MediaRecord, TimeSource, record_to_json
from results.models import Medium, MediumKind, MediumState, TakenAtSource
from results.services.placing import place_medium
from results.services.store import MediumMissing, derivative_name, original_as_file, store_file
from results.services.uploads import upload_folder
from workspace.leases import try_lock_until_end

MAX_SIDE_PX = 2**31 - 1
FIRST_YEAR, AHEAD = 1980, timedelta(days=1)  # of times that a camera may state
READING_LOCK = 0x05A7_0035  # advisory lock, with a slot: so many photos are read at once

logger = logging.getLogger(__name__)


def read_waiting(*, budget_s: float) -> bool:
    """Read waiting media for some seconds. Returns whether more of them wait."""
    ends_s = time.monotonic() + budget_s
    while time.monotonic() < ends_s:
        if not _read_next():
            return False
    return Medium.objects.filter(state=MediumState.WAITING).exists()


def _read_next() -> bool:
    """Read the medium that has waited longest; False where none waits, or others read as many as may be read at once.

    The row stays locked meanwhile: if this process is killed, the medium still waits. One that cannot be stored as it was read is marked
    as not shown, so that it holds up no other.
    """
    with transaction.atomic():
        slots = max(settings.DATA_WORKERS - 1, 1)  # one worker stays free for imports
        if not any(try_lock_until_end(READING_LOCK, slot) for slot in range(slots)):
            return False
        waiting = Medium.objects.select_for_update(skip_locked=True, of=["self"]).filter(state=MediumState.WAITING)
        medium = waiting.order_by("received_at").first()
        if medium is None:
            return False
        try:
            with transaction.atomic():
                read_medium(medium)
        except (OSError, OperationalError, SoftTimeLimitExceeded):
            raise  # of the store, the database or the worker: it is read again
        except Exception:
            logger.exception("medium %s cannot be read", medium.pk)
            Medium.objects.filter(pk=medium.pk).update(state=MediumState.NOT_SHOWN, fault="medium_decoder_failed")
    return True


def read_medium(medium: Medium) -> None:
    """Read one medium, store its derivatives, and place it."""
    if not MEDIA_TYPES[medium.media_type].pillow_formats:
        found = ReadPhoto(None, None, None, {}, "not_decoded")
    else:
        try:
            found = _read_file(medium)
        except MediumMissing:
            found = ReadPhoto(None, None, None, {}, "missing")
    medium.state = MediumState.NOT_SHOWN if found.fault else MediumState.READY
    medium.fault = f"medium_{found.fault}" if found.fault else ""
    medium.width_px, medium.height_px = (size if (size or 0) <= MAX_SIDE_PX else None for size in (found.width_px, found.height_px))
    medium.derivatives = found.derivatives
    if found.record is not None:
        _take_record(medium, found.record)
    place_medium(medium)
    medium.save()


def _read_file(medium: Medium) -> ReadPhoto:
    with tempfile.TemporaryDirectory(prefix="photo-", dir=upload_folder()) as folder, original_as_file(medium) as file:
        found = read_photo(file, Path(folder), settings.READING_LIMITS)
        for edge in found.derivatives:
            store_file(Path(folder) / f"{edge}.webp", derivative_name(medium.organisation_id, medium.sha256, int(edge)))
        return found


def _take_record(medium: Medium, record: MediaRecord) -> None:
    medium.record = record_to_json(record)
    medium.kind = MediumKind.THERMAL if record.is_thermal else MediumKind.PHOTO
    medium.heights = medium.record["heights"]
    medium.camera_model = f"{record.camera_make} {record.camera_model}".strip()
    medium.focal_length_mm = record.focal_length_mm
    if record.position is not None:
        medium.position = Point(record.position.lon, record.position.lat, srid=4326)
    if record.attitude is not None:
        attitude = record.attitude
        medium.camera_yaw_deg, medium.camera_pitch_deg, medium.camera_roll_deg = attitude.yaw_deg, attitude.pitch_deg, attitude.roll_deg
        medium.attitude_source = attitude.source
    if record.taken_at is not None and _can_be(record.taken_at):
        medium.taken_at = record.taken_at
        medium.taken_at_source = TakenAtSource.GPS if record.time_source == TimeSource.GPS else TakenAtSource.CAMERA
    elif record.taken_local is not None and _can_be(record.taken_local.replace(tzinfo=UTC)):
        medium.taken_at = _in_zone(record.taken_local, medium.organisation.time_zone)
        medium.taken_at_source = TakenAtSource.LOCAL


def _can_be(taken_at: datetime) -> bool:
    """Whether a photo can have been taken then: a camera whose clock was never set says another time."""
    return taken_at.year >= FIRST_YEAR and taken_at <= timezone.now() + AHEAD


def _in_zone(local: datetime, time_zone: str) -> datetime:
    """Return a local time in the organisation's zone; UTC where it has none."""
    try:
        return local.replace(tzinfo=ZoneInfo(time_zone)) if time_zone else local.replace(tzinfo=UTC)
    except (ZoneInfoNotFoundError, ValueError):
        return local.replace(tzinfo=UTC)
