"""What a plan says of UAVs that cannot start, or of which too little is known, and of ways that are not the preferred ones."""

from collections.abc import Mapping
from typing import Any

from missions.in_air_hooks import uavs_in_the_air
from missions.services.refusals import Grounding
from missions.services.requests import PlanRequest

SHORTEST_WAYS = "The routes take shorter ways than preferred, farther from the lines: along the lines, not all targets are in reach."


def warnings_of(request: PlanRequest, grounded: Mapping[int, Grounding], *, is_by_length: bool) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = [{"code": why.code, "uav": number, "message": why.message} for number, why in grounded.items()]
    flying = uavs_in_the_air([uav.uav for uav in request.uavs if uav.uav is not None])
    in_air = "%s is reported to be in the air: the plan begins with a take-off from the ground at the place where it was last seen."
    found += [
        {"code": "uav_in_air", "uav": number, "message": in_air % uav.name}
        for number, uav in enumerate(request.uavs)
        if uav.uav in flying and number not in grounded
    ]
    if is_by_length:
        found.append({"code": "shortest_ways", "uav": None, "message": SHORTEST_WAYS})
    if request.conditions.is_calm:
        return found
    unknown = "%s states no top airspeed: it is taken to fly no faster than its speed, through the air."
    return found + [
        {"code": "airspeed_not_stated", "uav": number, "message": unknown % uav.name}
        for number, uav in enumerate(request.uavs)
        if number not in grounded and uav.performance.max_airspeed_mps is None
    ]
