"""Addresses under which UAVs reach this installation's gateway, as its settings state them."""

import ipaddress
from dataclasses import dataclass

from django.conf import settings

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
