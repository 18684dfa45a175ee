"""Stores photos that companion computers report on the HTTP link."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial
from typing import Any
from uuid import UUID

from mavlink.decoding.captures import AttitudeSource, CaptureMessage, CaptureSource, CaptureTimeSource, PositionSource
from mavlink.decoding.companion_reports import CompanionCapture, read_capture
from mavlink.decoding.gimbal_attitude import YawFrame
from missions.models import LinkKind
from telemetry import models
from telemetry.services.captures import CaptureCount, NewCapture, store_captures
from telemetry.services.links.companion_reports import USED_AGAIN, RefusedReport, read_batch

FUTURE_S = 60.0  # after receipt: the UAV's clock is wrong


@dataclass(frozen=True)
class TakenCaptures:
    counts: CaptureCount
    refused: list[RefusedReport] = field(default_factory=list)


def take_captures(*, uav_id: int, place: tuple[float, float], stream: str, sent: Sequence[Any], received_at: datetime) -> TakenCaptures:
    """Store the valid photos and return the refused ones. `place` is the UAV's last position; `sent` is decoded JSON."""
    read, refused = read_batch(sent, partial(read_capture, known_place=place), uav_id)
    new = {index: _new(capture, uav_id, stream, received_at) for index, capture in read.items()}
    refused += [RefusedReport(index, {"sequence": USED_AGAIN}) for index in _numbers_used_again(uav_id, stream, new)]
    reused = {one.index for one in refused}
    counts = store_captures([one for index, one in new.items() if index not in reused])
    return TakenCaptures(counts, sorted(refused, key=lambda fault: fault.index))


def _numbers_used_again(uav_id: int, stream: str, new: dict[int, NewCapture]) -> list[int]:
    """Return photos whose number is stored with other values: the counter restarted; it is not a repetition."""
    rows = models.CaptureReport.objects.filter(stream__uav=uav_id, stream__link=LinkKind.HTTP, stream__key=stream)
    stored = dict(rows.filter(key__in=[one.report.key for one in new.values()]).values_list("key", "values__sent_at"))
    return [index for index, one in new.items() if stored.get(one.report.key, one.report.sent_at) != one.report.sent_at]


def _new(capture: CompanionCapture, uav_id: int, stream: str, received_at: datetime) -> NewCapture:
    """A time more than a minute ahead of the server's is that of a wrong clock: the photo has its receipt then."""
    taken_s, received_s = capture.taken_at.timestamp(), received_at.timestamp()
    is_possible = taken_s <= received_s + FUTURE_S
    values: dict[str, Any] = dict(capture.values)
    waypoint = values.pop("waypoint_sequence", None)
    has_attitude = values.get("pitch_deg") is not None
    longitude_deg, latitude_deg = capture.position or (None, None)
    report = CaptureMessage(
        CaptureSource.COMPANION,
        hashlib.sha256(f"companion {stream} {capture.sequence}".encode()).hexdigest()[:32],
        min(taken_s, received_s) if is_possible else received_s,
        CaptureTimeSource.UAV if is_possible else CaptureTimeSource.RECEIPT,
        longitude_deg=longitude_deg,
        latitude_deg=latitude_deg,
        position_source=None if capture.position is None else PositionSource.PHOTO,
        yaw_frame=None if values.get("yaw_deg") is None else YawFrame.EARTH,
        attitude_source=AttitudeSource.CAMERA if has_attitude else None,
        sent_at=capture.taken_at.isoformat(),
        **values,
    )
    mission_id = UUID(capture.mission) if capture.mission else None
    return NewCapture(uav_id, LinkKind.HTTP, stream, received_at, report, waypoint_sequence=waypoint, mission_id=mission_id)
