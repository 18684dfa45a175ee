"""Stores photos, each once, from all messages that report it, in any order and with repetitions."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from uuid import UUID

from django.conf import settings
from django.contrib.gis.geos import Point
from django.db import transaction

from inspection.geodesy import LonLat
from mavlink.decoding import captures as decoded
from mavlink.decoding.flight_log import captures_of_tlog
from missions.models import LinkKind
from telemetry.models import Capture, CaptureReport, FlightLog
from telemetry.services.ingest import known_with_missions, stream_ids
from telemetry.services.waypoints import LoadedList, lists_on
from workspace.leases import lock_until_end

CAPTURES_LOCK = 0x05A7_0033  # advisory lock, with the UAV
SAME_PHOTO_S = 1.0  # between two messages of different kinds about one photo
LATE_S = 2.0  # a photo that is reported later was requested again, or delayed
LOG_REPORTS_AT_ONCE = 500
SAME_RECEIPT_S = 10.0  # between receiving a message and reading it in the log of the flight
MAX_TIME_S = 253_000_000_000.0  # year 9987, within the range of Python and PostgreSQL


@dataclass(frozen=True, slots=True)
class NewCapture:
    """An incoming report of a photo. `stream` is the key of the sender's counter; `mission_item` is the item that its list is at."""

    uav_id: int
    link: str  # LinkKind
    stream: str
    received_at: datetime
    report: decoded.CaptureMessage
    mission_item: int | None = None
    waypoint_sequence: int | None = None
    mission_id: UUID | None = None


@dataclass(frozen=True)
class CaptureCount:
    """Counts of reports: of new photos, of known photos, and those that had been stored before or belong to no UAV."""

    photos: int = 0
    joined: int = 0
    known: int = 0


@transaction.atomic
def store_captures(new: Sequence[NewCapture], *, of_present_mission: bool = True) -> CaptureCount:
    """Store reports of photos. Idempotent for the same reports; the order does not matter.

    of_present_mission: those that name no mission belong to the one that the UAV flies now, or was sent.
    """
    uav_ids = {one.uav_id for one in new}
    missions, _ = known_with_missions(uav_ids)
    for uav_id in sorted(missions):
        lock_until_end(CAPTURES_LOCK, uav_id)
    kept = [one for one in new if one.uav_id in missions]
    if not kept:
        return CaptureCount(known=len(new))
    streams = stream_ids({(one.uav_id, one.link, one.stream) for one in kept})
    lists = lists_on({one.uav_id for one in kept if one.mission_item is not None})
    fresh = _not_stored(kept, streams)
    photos = joined = 0
    for one in sorted(fresh, key=lambda one: (one.report.taken_s, one.report.key)):
        known = _same_photo(one)
        capture = known or _begun(one, missions[one.uav_id] if of_present_mission else None, lists.get(one.uav_id))
        photos, joined = photos + (known is None), joined + (known is not None)
        CaptureReport.objects.create(
            capture=capture, stream_id=streams[one.uav_id, one.link, one.stream], key=one.report.key, source=one.report.source,
            received_at=one.received_at, values=one.report.to_json(),
        )  # fmt: skip
        if known is not None:
            _combine(known)
    return CaptureCount(photos, joined, len(new) - photos - joined)


def store_captures_of_log(log: FlightLog) -> CaptureCount:
    """Store the photos of a flight log; those that are stored are left as they are. Raises OSError without the file."""
    with (Path(settings.FLIGHT_LOG_DIR) / log.path).open("rb") as file:
        new = [
            NewCapture(
                uav_id=log.uav_id,
                link=LinkKind.MAVLINK,
                stream=found.stream,
                received_at=datetime.fromtimestamp(found.received_s, UTC),
                report=found.report,
                mission_item=found.mission_item,
                mission_id=log.mission_id,
            )
            for found in captures_of_tlog(file)
        ]
    counts = [
        store_captures(new[start : start + LOG_REPORTS_AT_ONCE], of_present_mission=False)
        for start in range(0, len(new), LOG_REPORTS_AT_ONCE)
    ]
    return CaptureCount(sum(one.photos for one in counts), sum(one.joined for one in counts), sum(one.known for one in counts))


def _not_stored(new: Sequence[NewCapture], streams: Mapping[tuple[int, str, str], int]) -> list[NewCapture]:
    """Return the reports that are not stored: in their stream, or, read again from a log, received at the same time."""
    rows = CaptureReport.objects.filter(stream__uav__in={one.uav_id for one in new}, key__in={one.report.key for one in new})
    stored: dict[tuple[int, str], list[tuple[int, datetime]]] = {}
    for uav_id, key, stream_id, received_at in rows.values_list("stream__uav_id", "key", "stream_id", "received_at"):
        stored.setdefault((uav_id, key), []).append((stream_id, received_at))
    fresh = []
    for one in new:
        stream_id = streams[one.uav_id, one.link, one.stream]
        before = stored.setdefault((one.uav_id, one.report.key), [])
        if not any(stream == stream_id or abs((at - one.received_at).total_seconds()) <= SAME_RECEIPT_S for stream, at in before):
            before.append((stream_id, one.received_at))
            fresh.append(one)
    return fresh


def _same_photo(new: NewCapture) -> Capture | None:
    """Return the stored photo of this report: the nearest in time without a message of this kind."""
    taken_at, reach = _time(new.report.taken_s), timedelta(seconds=SAME_PHOTO_S)
    near = Capture.objects.filter(uav=new.uav_id, taken_at__gte=taken_at - reach, taken_at__lte=taken_at + reach)
    free = near.exclude(reports__source=new.report.source)
    return min(free, key=lambda capture: (abs(capture.taken_at - taken_at), capture.pk), default=None)


def _begun(new: NewCapture, flies_mission: UUID | None, loaded: LoadedList | None) -> Capture:
    mission_id = new.mission_id or flies_mission
    waypoint, flight, report = new.waypoint_sequence, None, new.report
    taken_at = _time(report.taken_s)
    if loaded is not None and loaded.mission_id == mission_id and taken_at >= loaded.read_at:
        flight = loaded.flight
        if waypoint is None:
            lon, lat = report.longitude_deg, report.latitude_deg
            position = None if lon is None or lat is None else LonLat(lon, lat)
            is_late = new.received_at - taken_at > timedelta(seconds=LATE_S)
            waypoint = loaded.waypoint_of_photo(new.mission_item, position, report.altitude_relative_m, is_late=is_late)
    return Capture.objects.create(
        uav_id=new.uav_id, mission_id=mission_id, flight=flight, waypoint_sequence=waypoint, mission_item=new.mission_item,
        received_at=new.received_at, **_columns([report]),
    )  # fmt: skip


def _combine(capture: Capture) -> None:
    reports = [decoded.CaptureMessage.from_json(values) for values in capture.reports.values_list("values", flat=True)]
    for name, value in _columns(reports).items():
        setattr(capture, name, value)
    capture.save()


def _columns(reports: Iterable[decoded.CaptureMessage]) -> dict[str, Any]:
    whole = decoded.combined(list(reports))
    has_place = whole.longitude_deg is not None and whole.latitude_deg is not None
    as_they_are = (
        "is_taken", "camera", "image_index", "time_source", "time_bound_s", "position_bound_m", "altitude_amsl_m", "altitude_relative_m",
        "altitude_agl_m", "roll_deg", "pitch_deg", "yaw_deg", "file_url",
    )  # fmt: skip
    return {name: getattr(whole, name) for name in as_they_are} | {
        "taken_at": _time(whole.taken_s),
        "position": Point(whole.longitude_deg, whole.latitude_deg, srid=4326) if has_place else None,
        "position_source": whole.position_source or "",
        "yaw_frame": whole.yaw_frame or "",
        "attitude_source": whole.attitude_source or "",
    }


def _time(unix_s: float) -> datetime:
    return datetime.fromtimestamp(min(max(unix_s, 0.0), MAX_TIME_S), UTC)
