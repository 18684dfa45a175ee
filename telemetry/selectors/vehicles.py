"""Reads of vehicles: status texts, flight logs, unknown vehicles, and the addresses under which they reach the gateway."""

import ipaddress
from dataclasses import dataclass
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


LOOPBACK_NAMES = {"localhost"}


@dataclass(frozen=True)
class GatewayAddress:
    """`is_local`: reachable from the gateway's own machine alone."""

    protocol: str
    host: str
    port: int
    is_local: bool


def gateway_addresses(site_host: str) -> list[GatewayAddress]:
    """Return the addresses, UDP first. Where the gateway listens on all of its machine's, the host is SPANWISE_GATEWAY_PUBLIC_HOST, else
    the site's."""
    listened = [("udp", settings.GATEWAY_UDP), ("tcp", settings.GATEWAY_TCP)]
    return [_reached(protocol, entry.strip(), site_host) for protocol, entries in listened for entry in entries.split(",") if entry.strip()]


def _reached(protocol: str, entry: str, site_host: str) -> GatewayAddress:
    host, _, port = entry.rpartition(":")
    bound = host.strip("[]")
    if _is(bound, "is_unspecified"):
        return GatewayAddress(protocol, settings.GATEWAY_PUBLIC_HOST or site_host, int(port), is_local=False)
    is_local = bound in LOOPBACK_NAMES or _is(bound, "is_loopback")
    return GatewayAddress(protocol, bound if is_local else settings.GATEWAY_PUBLIC_HOST or bound, int(port), is_local)


def _is(host: str, what: str) -> bool:
    try:
        return bool(getattr(ipaddress.ip_address(host), what))
    except ValueError:
        return False
