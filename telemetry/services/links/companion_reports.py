"""Stores reports and photos from companion computers on the HTTP link."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import partial
from typing import Any, TypeVar
from uuid import UUID

from mavlink.decoding.captures import AttitudeSource, CaptureMessage, CaptureSource, CaptureTimeSource, PositionSource
from mavlink.decoding.companion_reports import CompanionCapture, CompanionReport, FaultyReport, read_capture, read_report
from mavlink.decoding.gimbal_attitude import YawFrame
from mavlink.decoding.measurement import Measurement
from missions.models import LinkKind, MissionUav
from telemetry.models import CaptureReport, TelemetryRecord
from telemetry.services.captures import CaptureCount, NewCapture, store_captures
from telemetry.services.ingest import NewRecord, StoredCount, store_records
from telemetry.services.links.http_messages import note_state_over_http

AnyReport = TypeVar("AnyReport", CompanionReport, CompanionCapture)

FUTURE_S = 60.0  # after receipt: the UAV's clock is wrong
USED_AGAIN = "Another record has this number in this stream: take a new stream when the numbers begin anew."


@dataclass(frozen=True)
class RefusedReport:
    """A refused report. `index` is its place in the batch; `faults` holds a text for each field."""

    index: int
    faults: dict[str, str]


@dataclass(frozen=True)
class TakenReports:
    counts: StoredCount
    refused: list[RefusedReport] = field(default_factory=list)


def take_reports(*, uav_id: int, place: tuple[float, float], stream: str, sent: Sequence[Any], received_at: datetime) -> TakenReports:
    """Store the valid reports and return the refused ones, so that one faulty report does not block the others.

    `place` is the UAV's last position: longitude, latitude [deg]. `sent` is decoded JSON.
    """
    read, refused = read_batch(sent, partial(read_report, known_place=place), uav_id)
    records = {index: _new_record(report, uav_id, stream, received_at) for index, report in read.items()}
    counts = store_records(list(records.values())) if records else StoredCount()
    if counts.duplicates:
        reused = _numbers_used_again(uav_id, stream, records)
        refused += [RefusedReport(index, {"sequence": USED_AGAIN}) for index in reused]
        counts = replace(counts, duplicates=counts.duplicates - len(reused))
    if counts.stored:
        note_state_over_http(uav_id=uav_id, received_at=received_at)
    return TakenReports(counts, sorted(refused, key=lambda fault: fault.index))


def read_batch(sent: Sequence[Any], read: Callable[[Any], AnyReport], uav_id: int) -> tuple[dict[int, AnyReport], list[RefusedReport]]:
    """Return the valid reports of a batch by their index, and the refused ones: faulty, or of a mission that the UAV does not fly."""
    valid: dict[int, AnyReport] = {}
    refused: list[RefusedReport] = []
    for index, report in enumerate(sent):
        try:
            valid[index] = read(report)
        except FaultyReport as error:
            refused.append(RefusedReport(index, error.faults))
    own = _own_missions(uav_id, {UUID(report.mission) for report in valid.values() if report.mission})
    for index in [index for index, report in valid.items() if report.mission and UUID(report.mission) not in own]:
        del valid[index]
        refused.append(RefusedReport(index, {"mission": "The UAV has no mission of this id."}))
    return valid, refused


def _numbers_used_again(uav_id: int, stream: str, records: Mapping[int, NewRecord]) -> list[int]:
    """Return records whose number is stored with another time of measurement: the counter restarted; it is not a repetition."""
    run = TelemetryRecord.objects.filter(stream__uav_id=uav_id, stream__link=LinkKind.HTTP, stream__key=stream)
    stored = dict(run.filter(sequence__in=[record.sequence for record in records.values()]).values_list("sequence", "measured_at"))
    return [index for index, record in records.items() if stored.get(record.sequence, record.measured_at) != record.measured_at]


def _own_missions(uav_id: int, named: set[UUID]) -> set[UUID]:
    if not named:
        return set()
    return set(MissionUav.objects.filter(uav_id=uav_id, mission_id__in=named).values_list("mission_id", flat=True))


def _new_record(report: CompanionReport, uav_id: int, stream: str, received_at: datetime) -> NewRecord:
    longitude_deg, latitude_deg = report.position or (None, None)
    values: dict[str, Any] = dict(report.values)
    return NewRecord(
        uav_id=uav_id,
        link=LinkKind.HTTP,
        stream=stream,
        sequence=report.sequence,
        measured_at=report.measured_at,
        received_at=received_at,
        measurement=Measurement(longitude_deg=longitude_deg, latitude_deg=latitude_deg, **values),
        mission_id=UUID(report.mission) if report.mission else None,
    )


@dataclass(frozen=True)
class TakenCaptures:
    counts: CaptureCount
    refused: list[RefusedReport] = field(default_factory=list)


def take_captures(*, uav_id: int, place: tuple[float, float], stream: str, sent: Sequence[Any], received_at: datetime) -> TakenCaptures:
    """Store the valid photos and return the refused ones. `place` is the UAV's last position; `sent` is decoded JSON."""
    read, refused = read_batch(sent, partial(read_capture, known_place=place), uav_id)
    new = {index: _new(capture, uav_id, stream, received_at) for index, capture in read.items()}
    refused += [RefusedReport(index, {"sequence": USED_AGAIN}) for index in _photo_numbers_used_again(uav_id, stream, new)]
    reused = {one.index for one in refused}
    counts = store_captures([one for index, one in new.items() if index not in reused])
    return TakenCaptures(counts, sorted(refused, key=lambda fault: fault.index))


def _photo_numbers_used_again(uav_id: int, stream: str, new: dict[int, NewCapture]) -> list[int]:
    """Return photos whose number is stored with other values: the counter restarted; it is not a repetition."""
    rows = CaptureReport.objects.filter(stream__uav=uav_id, stream__link=LinkKind.HTTP, stream__key=stream)
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
