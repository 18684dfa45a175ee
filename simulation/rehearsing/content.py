"""The hash that names what was rehearsed: the same plan, UAVs and airframes, or another."""

import hashlib
import json
from collections.abc import Sequence
from typing import Any

from mavlink.approved_route import route_to_json
from mavlink.vehicle_plan import FlightLoad, load_to_json
from simulation.rehearsing.flying import RouteToFly


def content_of(
    routes: Sequence[RouteToFly],
    airframes: Sequence[str],
    batteries_wh: Sequence[float | None],
    departs_s: float | None,
    turnaround_s: float,
) -> str:
    """SHA-256 of the routes, their items, what flies them, when, and how long after a landing the next take-off is."""
    parts: list[dict[str, Any]] = [
        {
            "uav": route.uav,
            "route": route_to_json(route.route),
            "items": [load_to_json(FlightLoad(items))["mission"] for items in route.items],
            **({"rally": [load_to_json(FlightLoad((), rally=rally))["rally"] for rally in route.rally]} if any(route.rally) else {}),
            "reserve_percent": route.reserve_percent,
            "limit_mps": route.limit_mps,
            "airframe": airframe,
            "battery_wh": battery_wh,
        }
        for route, airframe, battery_wh in zip(routes, airframes, batteries_wh, strict=True)
    ]
    between = {"turnaround_s": turnaround_s} if any(len(route.items) > 1 for route in routes) else {}
    text = json.dumps({"departs_s": departs_s, "routes": parts, **between}, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
