"""Limits of what one network address may ask for, for the proxy and the programs: each is so much for every operator behind one address.

Operators behind one NAT share an address, so an address is allowed what OPERATORS_PER_ADDRESS of them use at the same time.
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
    """Requests that cost much: which paths, and what one operator asks for at most."""

    name: str
    location: str  # as nginx writes it
    per_second: float  # of one operator, over a long time
    burst: int  # of one operator, at once
    at_once: int = 0  # of one operator, under way; 0: without limit


EXPORTS = r"^/api/v1/(missions|uavs)/[^/]+/(record\.zip|telemetry\.[a-z]+|flight-logs/[0-9]+/file)$"
COSTLY = (
    CostlyKind("schema", "= /api/schema", 0.1, 2),
    CostlyKind("tiles", "~ ^/api/v1/tiles/", 10.0, 60),
    CostlyKind("scene", "= /api/v1/scene", 0.2, 4),
    CostlyKind("exports", f"~ {EXPORTS}", 0.2, 4, at_once=1),
)


def operators_per_address() -> int:
    """SPANWISE_OPERATORS_PER_ADDRESS; 0 for no limits by address. Raises ValueError for what is no such number."""
    operators = int(os.environ.get("SPANWISE_OPERATORS_PER_ADDRESS", OPERATORS_PER_ADDRESS))
    if operators < 0:
        raise ValueError("SPANWISE_OPERATORS_PER_ADDRESS is below 0")
    return operators


def requests_per_minute(kind: CostlyKind, operators: int) -> int:
    """The rate of one address, in the unit of nginx that has no fractions at these rates."""
    return max(1, ceil(kind.per_second * 60 * operators))


def sockets_per_address(operators: int) -> int:
    return SOCKETS_PER_OPERATOR * operators


def trusted_proxies() -> list[ipaddress.IPv4Network | ipaddress.IPv6Network]:
    """SPANWISE_TRUSTED_PROXIES: from where a proxy of ours may come by TCP. Raises ValueError for what is no network."""
    named = os.environ.get("SPANWISE_TRUSTED_PROXIES", PRIVATE_NETWORKS)
    return [ipaddress.ip_network(network.strip()) for network in named.split(",") if network.strip()]
