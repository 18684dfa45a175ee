"""What a plan says of UAVs that cannot start, or of which too little is known."""

from collections.abc import Mapping
from typing import Any

from missions.services.refusals import Grounding
from missions.services.requests import PlanRequest


def warnings_of(request: PlanRequest, grounded: Mapping[int, Grounding]) -> list[dict[str, Any]]:
    found = [{"code": why.code, "uav": number, "message": why.message} for number, why in grounded.items()]
    if request.conditions.is_calm:
        return found
    unknown = "%s states no top airspeed: it is taken to keep its speed over ground in any wind."
    return found + [
        {"code": "airspeed_not_stated", "uav": number, "message": unknown % uav.name}
        for number, uav in enumerate(request.uavs)
        if number not in grounded and uav.performance.max_airspeed_mps is None
    ]
