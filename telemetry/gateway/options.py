"""Options of a gateway."""

import re
import socket
from dataclasses import dataclass
from pathlib import Path

from django.conf import settings

from workspace.leases import HolderOptions, holder_name

OWN_SYSTEM, OWN_COMPONENT = 255, 190  # usual ids of a ground station; MAV_COMP_ID_MISSIONPLANNER


class InvalidUdpAddress(ValueError):
    """The address is not of the form HOST:PORT."""


@dataclass(frozen=True)
class UdpAddress:
    host: str
    port: int

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


def addresses(text: str) -> list[UdpAddress]:
    """Parse "HOST:PORT, …", with IPv6 hosts in brackets. Raises InvalidUdpAddress."""
    return [_address(entry.strip()) for entry in text.split(",") if entry.strip()]


def _address(entry: str) -> UdpAddress:
    found = re.fullmatch(r"\[([0-9a-fA-F:.%]+)\]:(\d{1,5})|([^:\[\]]+):(\d{1,5})", entry)
    if not found or int(found[2] or found[4]) > 65_535:
        raise InvalidUdpAddress(f"{entry!r} is no address: HOST:PORT is, or [IPv6]:PORT")
    return UdpAddress(found[1] or found[3], int(found[2] or found[4]))


@dataclass(frozen=True, kw_only=True)
class GatewayOptions(HolderOptions):
    """Listening addresses of a gateway, and limits of its buffers."""

    udp: list[UdpAddress]
    tcp: list[UdpAddress]
    log_dir: Path
    flush_s: float = 0.2
    most_records: int = 100_000
    log_mib: float = 256.0


def options_of_settings(*, udp: str | None = None, tcp: str | None = None, name: str | None = None) -> GatewayOptions:
    udp_addresses = addresses(settings.GATEWAY_UDP if udp is None else udp)
    tcp_addresses = addresses(settings.GATEWAY_TCP if tcp is None else tcp)
    ports = [str(address.port) for address in [*udp_addresses, *tcp_addresses]]
    usual = "-".join([socket.gethostname(), *ports])
    return GatewayOptions(
        udp=udp_addresses,
        tcp=tcp_addresses,
        name=holder_name(name or settings.GATEWAY_NAME or usual),
        log_dir=Path(settings.FLIGHT_LOG_DIR),
        most_records=settings.GATEWAY_MAX_RECORDS,
        log_mib=settings.MAX_FLIGHT_LOG_MIB,
    )
