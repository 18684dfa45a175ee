"""Reads of vehicles: status texts, flight logs and unknown vehicles."""

from pathlib import Path

from django.conf import settings
from django.db.models import QuerySet

from missions.models import Uav
from telemetry.models import FlightLog, UavLink, UnknownVehicle, VehicleText


class LogFileMissing(Exception):
    """The file is missing, or outside the log folder."""


def connection_of(uav: Uav) -> UavLink:
    """Return the UAV's link; an empty one for a UAV that never connected."""
    return UavLink.objects.filter(uav=uav).first() or UavLink(uav=uav)


def texts_of(uav: Uav) -> QuerySet[VehicleText]:
    return VehicleText.objects.filter(uav=uav)


def flight_logs_of(uav: Uav) -> QuerySet[FlightLog]:
    return FlightLog.objects.filter(uav=uav, organisation=uav.organisation_id)


def file_of(log: FlightLog) -> Path:
    """Return the path of a log file. Raises LogFileMissing, also for a path that leaves the folder in any way."""
    folder = Path(settings.FLIGHT_LOG_DIR).resolve()
    path = (folder / log.path).resolve()
    if not path.is_relative_to(folder) or not path.is_file():
        raise LogFileMissing
    return path


def unknown_vehicles() -> QuerySet[UnknownVehicle]:
    """Return unknown vehicles, the most recently received first."""
    return UnknownVehicle.objects.select_related("settled_by", "uav")
