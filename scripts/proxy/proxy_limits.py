"""nginx's limits per address: expensive requests, and websockets (operation/address_limits.py)."""

from operation.address_limits import COSTLY, CostlyKind, operators_per_address, requests_per_minute, sockets_per_address
from scripts.places import CannotStart
from scripts.proxy.proxy_site import error_json

TOO_MANY = error_json(429, "throttled", "Too many requests from this network address; see Retry-After.")
RETRY_AFTER_S = 5
NETWORK_OF_IPV6 = "~*(?:^|[ ,])(?<network>(?:[0-9a-f]{1,4}:){4})[0-9a-f:]+ *$"  # usual network of one subscriber: 64 bits
SOCKETS_ABOVE = 16  # the program refuses first, with a close code; nginx a few later, so that a page gets the reason


def _operators() -> int:
    try:
        return operators_per_address()
    except ValueError:
        raise CannotStart("SPANWISE_OPERATORS_PER_ADDRESS is no number of operators") from None


def zones() -> str:
    """Return the counters, keyed on the client's own address: the last one, which the proxy in front has appended."""
    operators = _operators()
    if not operators:
        return ""
    lines = [f'    map $visitor $visitor_address {{ "{NETWORK_OF_IPV6}" $network; "~(?<address>[^, ]+) *$" $address; default $visitor; }}']
    for kind in COSTLY:
        lines.append(f"    limit_req_zone $visitor_address zone={kind.name}:4m rate={requests_per_minute(kind, operators)}r/m;")
        if kind.at_once:
            lines.append(f"    limit_conn_zone $visitor_address zone={kind.name}_at_once:4m;")
    lines += ["    limit_conn_zone $visitor_address zone=sockets:4m;", "    limit_req_status 429;", "    limit_conn_status 429;"]
    return "\n".join(lines)


def of_requests(kind: CostlyKind) -> str:
    """Return the limits for a location of this kind."""
    operators = _operators()
    if not operators:
        return ""
    stated = f"\n            limit_req zone={kind.name} burst={kind.burst * operators} nodelay;"
    if kind.at_once:
        stated += f"\n            limit_conn {kind.name}_at_once {kind.at_once * operators};"
    return f"{stated}\n            error_page 429 = @api_too_many;"


def of_sockets() -> str:
    operators = _operators()
    if not operators:
        return ""
    return f"""
            limit_conn sockets {sockets_per_address(operators) + SOCKETS_ABOVE};
            error_page 429 = @api_too_many;"""
