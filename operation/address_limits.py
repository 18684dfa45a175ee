"""Limits per client address, for the proxy and the programs, scaled by the number of operators behind one address.

Operators behind one NAT share an address, so an address may use what OPERATORS_PER_ADDRESS of them need at the same time.
"""

import ipaddress
import os
from dataclasses import dataclass
from math import ceil

OPERATORS_PER_ADDRESS = 50
PRIVATE_NETWORKS = "127.0.0.0/8,10.0.0.0/8,172.16.0.0/12,192.168.0.0/16,100.64.0.0/10,::1/128,fc00::/7"
SOCKETS_PER_OPERATOR = 12  # a page has one, and one more for each job that it follows


@dataclass(frozen=True)
class CostlyKind:
    """A kind of expensive requests: its paths, and the limits of one operator."""

    name: str
    location: str  # as nginx writes it
    per_second: float  # of one operator, long-term average
    burst: int  # of one operator, at once
    at_once: int = 0  # of one operator, concurrent; 0: no limit


EXPORTS = r"^/api/v1/(missions|uavs)/[^/]+/(record\.zip|telemetry\.[a-z]+|flight-logs/[0-9]+/file)$"
COSTLY = (
    CostlyKind("schema", "= /api/schema", 0.1, 2),
    CostlyKind("tiles", "~ ^/api/v1/tiles/", 10.0, 60),
    CostlyKind("scene", "= /api/v1/scene", 0.2, 4),
    CostlyKind("exports", f"~ {EXPORTS}", 0.2, 4, at_once=1),
)


def operators_per_address() -> int:
    """Return SPANWISE_OPERATORS_PER_ADDRESS; 0: no limits by address. Raises ValueError for an invalid number."""
    operators = int(os.environ.get("SPANWISE_OPERATORS_PER_ADDRESS", OPERATORS_PER_ADDRESS))
    if operators < 0:
        raise ValueError("SPANWISE_OPERATORS_PER_ADDRESS is below 0")
    return operators


def requests_per_minute(kind: CostlyKind, operators: int) -> int:
    """Return the rate of one address, in the unit of nginx that has no fractions at these rates."""
    return max(1, ceil(kind.per_second * 60 * operators))


def sockets_per_address(operators: int) -> int:
    return SOCKETS_PER_OPERATOR * operators


def trusted_proxies() -> list[ipaddress.IPv4Network | ipaddress.IPv6Network]:
    """Return SPANWISE_TRUSTED_PROXIES: networks from which our own proxy may connect. Raises ValueError for an invalid network."""
    named = os.environ.get("SPANWISE_TRUSTED_PROXIES", PRIVATE_NETWORKS)
    return [ipaddress.ip_network(network.strip()) for network in named.split(",") if network.strip()]
