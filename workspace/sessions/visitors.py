"""Where a request came from: the visitor's own address, though a proxy brings it."""

import ipaddress

from django.conf import settings


def visitor_address(peer: str, forwarded: str) -> str:
    """Return the address of the visitor.

    peer: who has opened the connection, empty over a unix socket. forwarded: X-Forwarded-For, of which only what our own proxy has
    appended last counts, and only where the peer may be that proxy (SPANWISE_TRUSTED_PROXIES, or a unix socket).
    """
    last = forwarded.rpartition(",")[2].strip()
    return last if last and _is_trusted(peer) else peer


def _is_trusted(peer: str) -> bool:
    try:
        address = ipaddress.ip_address(peer)
    except ValueError:  # a unix socket has no address: nobody but the proxy can open it
        return True
    address = getattr(address, "ipv4_mapped", None) or address
    return any(address in network for network in settings.TRUSTED_PROXIES)
