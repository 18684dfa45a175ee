"""Take-offs and landings, recorded once each from incoming reports."""

from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Protocol
from uuid import UUID

from mavlink.decoding.measurement import Measurement
from telemetry.models import FlightEvent, FlightEventKind, UavWatch


class FlightEventReport(Protocol):
    """One stored report of a UAV."""

    @property
    def uav_id(self) -> int: ...
    @property
    def mission_id(self) -> UUID | None: ...
    @property
    def measured_at(self) -> datetime: ...
    @property
    def measurement(self) -> Measurement: ...


def note_take_offs_and_landings(reports: Iterable[FlightEventReport]) -> None:
    """Record take-offs and landings of reports not from the future, before these are stored as the latest. Late reports are ignored."""
    reported = sorted((report for report in reports if report.measurement.is_in_air is not None), key=lambda report: report.measured_at)
    if not reported:
        return
    before = _in_air_before({report.uav_id for report in reported})
    for report in reported:
        is_in_air, since = before.get(report.uav_id, (None, None))
        if since is not None and report.measured_at <= since:
            continue
        now_in_air = report.measurement.is_in_air
        before[report.uav_id] = (now_in_air, report.measured_at)
        if now_in_air == is_in_air:
            continue
        kind = FlightEventKind.TAKE_OFF if now_in_air else FlightEventKind.LANDING
        mission_id = report.mission_id or (None if now_in_air else _took_off_for(report.uav_id, report.measured_at))
        if is_in_air is None and not now_in_air:  # an intermediate report had no value: if it had taken off, it has landed
            if mission_id is not None:
                note_landing(mission_id=mission_id, uav_id=report.uav_id, at=report.measured_at)
        elif mission_id is not None:
            _note(mission_id, report.uav_id, kind, report.measured_at)


def note_landing(*, mission_id: UUID, uav_id: int, at: datetime) -> None:
    """Record the landing of a flight reported as ended, if its take-off was recorded and its landing was not."""
    if _last_of(mission_id, uav_id) == FlightEventKind.TAKE_OFF:
        _note(mission_id, uav_id, FlightEventKind.LANDING, at)


def _note(mission_id: UUID, uav_id: int, kind: FlightEventKind, at: datetime) -> None:
    if _last_of(mission_id, uav_id) != kind:
        FlightEvent.objects.bulk_create([FlightEvent(mission_id=mission_id, uav_id=uav_id, kind=kind, at=at)], ignore_conflicts=True)


def _last_of(mission_id: UUID, uav_id: int) -> str | None:
    return FlightEvent.objects.filter(mission=mission_id, uav=uav_id).order_by("-at", "-pk").values_list("kind", flat=True).first()


def _in_air_before(uav_ids: Sequence[int] | set[int]) -> dict[int, tuple[bool | None, datetime | None]]:
    """Return whether each UAV was in the air by its newest report with that value, and when that was measured."""
    rows = UavWatch.objects.filter(uav__in=uav_ids, measured__has_key="state").values_list("uav_id", "measured__state")
    return {uav_id: (state.get("is_in_air"), datetime.fromisoformat(state["measured_at"])) for uav_id, state in rows}


def _took_off_for(uav_id: int, at: datetime) -> UUID | None:
    """Return the mission of its last take-off without a landing, which may end before its last UAV is down."""
    last = FlightEvent.objects.filter(uav=uav_id, at__lt=at).order_by("-at", "-pk").first()
    return last.mission_id if last is not None and last.kind == FlightEventKind.TAKE_OFF else None
