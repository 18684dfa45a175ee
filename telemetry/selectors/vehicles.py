"""Reads of vehicles: what they said, the logs of their flights, and those that nobody knows."""

from pathlib import Path

from django.conf import settings
from django.db.models import QuerySet

from missions.models import Uav
from telemetry.models import FlightLog, UavLink, UnknownVehicle, VehicleText


class LogFileMissing(Exception):
    """The file is not there, or lies outside the folder of logs."""


def connection_of(uav: Uav) -> UavLink:
    """An empty one for a UAV that was never heard."""
    return UavLink.objects.filter(uav=uav).first() or UavLink(uav=uav)


def texts_of(uav: Uav) -> QuerySet[VehicleText]:
    return VehicleText.objects.filter(uav=uav)


def flight_logs_of(uav: Uav) -> QuerySet[FlightLog]:
    return FlightLog.objects.filter(uav=uav, organisation=uav.organisation_id)


def file_of(log: FlightLog) -> Path:
    """Raises LogFileMissing, also for a path that leaves the folder by whatever way."""
    folder = Path(settings.FLIGHT_LOG_DIR).resolve()
    path = (folder / log.path).resolve()
    if not path.is_relative_to(folder) or not path.is_file():
        raise LogFileMissing
    return path


def unknown_vehicles() -> QuerySet[UnknownVehicle]:
    """The last heard first."""
    return UnknownVehicle.objects.select_related("settled_by", "uav")
