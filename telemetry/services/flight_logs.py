"""Rows of tlog files. The file comes first; a row that was left open by a gateway that died is closed by the next log of its UAV."""

from datetime import datetime
from pathlib import Path

from django.conf import settings
from django.db import transaction

from missions.models import Uav
from missions.services.steering import mission_in_hand
from telemetry.models import FlightLog


@transaction.atomic
def begin_flight_log(*, uav_id: int, path: str, started_at: datetime) -> None:
    """path: under the folder of logs. Safe to call again; nothing happens for a UAV that is gone."""
    uav = Uav.objects.select_for_update(of=("self",), no_key=True).filter(pk=uav_id).first()
    if uav is None or FlightLog.objects.filter(path=path).exists():
        return
    for left_open in FlightLog.objects.filter(uav=uav, ended_at=None):
        end_flight_log(path=left_open.path, ended_at=_last_written(left_open.path) or started_at)
    FlightLog.objects.create(organisation_id=uav.organisation_id, uav=uav, mission=mission_in_hand(uav), path=path, started_at=started_at)


def end_flight_log(*, path: str, ended_at: datetime) -> None:
    FlightLog.objects.filter(path=path, ended_at=None).update(ended_at=ended_at, size_bytes=_size_bytes(path))


def _file(path: str) -> Path:
    return Path(settings.FLIGHT_LOG_DIR) / path


def _size_bytes(path: str) -> int:
    return _file(path).stat().st_size if _file(path).exists() else 0


def _last_written(path: str) -> datetime | None:
    return datetime.fromtimestamp(_file(path).stat().st_mtime).astimezone() if _file(path).exists() else None
