"""Limits of a vehicle: the length of lists, and the length of legs by its parameters."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

from inspection.geodesy import LonLat
from mavlink.autopilot_type import AutopilotType
from mavlink.legs import FLOWN, length_on_sphere_m, position_of
from mavlink.reasons import list_reason
from mavlink.vehicle_plan import FlightLoad, MissionType
from operation.reasons import Reason

# ArduPilot: 650 with home, observed on its simulator. PX4's dataman.h and navigation.h: a board's space is set at build time, so the usual
# numbers only cause a warning. A vehicle with less space refuses at once and keeps its list.
MAX_ITEMS = {(AutopilotType.ARDUPILOT, MissionType.MISSION): 649}
USUAL_ITEMS = {
    (AutopilotType.PX4, MissionType.MISSION): 500,
    (AutopilotType.PX4, MissionType.FENCE): 64,
    (AutopilotType.PX4, MissionType.RALLY): 8,
}
FIRST_LEG = "MIS_DIST_1WP"  # PX4, in metres; 0 or below: not limited
ANY_LEG = "MIS_DIST_WPS"
PARAMETERS = (FIRST_LEG, ANY_LEG)


@dataclass(frozen=True)
class LimitWarning:
    """`code` is short and stable; `item` is the place in the mission."""

    code: str
    reason: Reason
    item: int | None = None


def too_many(load: FlightLoad, autopilot_type: AutopilotType) -> LimitWarning | None:
    """Return the first list that is too long for every vehicle of this autopilot, else None."""
    return next(_longer(load, autopilot_type, MAX_ITEMS, "too_many_items", "too-many-items"), None)


def count_warnings(load: FlightLoad, autopilot_type: AutopilotType) -> tuple[LimitWarning, ...]:
    """Return warnings for lists that are too long for most vehicles of this autopilot."""
    return tuple(_longer(load, autopilot_type, USUAL_ITEMS, "many_items", "many-items"))


def _longer(
    load: FlightLoad, autopilot_type: AutopilotType, most_items: Mapping[tuple[AutopilotType, MissionType], int], reason: str, code: str
) -> Iterator[LimitWarning]:
    for kind in MissionType:
        most = most_items.get((autopilot_type, kind))
        if most is not None and len(load.of(kind)) > most:
            params = {"list": list_reason(kind.name), "count": len(load.of(kind)), "autopilot": autopilot_type.value, "most": most}
            yield LimitWarning(code, Reason(reason, params))


def leg_warnings(load: FlightLoad, parameters: Mapping[str, float], stands_at: LonLat | None) -> tuple[LimitWarning, ...]:
    """Return warnings for legs that the vehicle would refuse, by the parameters that it reported. `stands_at` is its take-off place."""
    warnings = []
    flown = [(place, item) for place, item in enumerate(load.mission) if item.command in FLOWN]
    most_m = parameters.get(FIRST_LEG, 0.0)
    if most_m > 0 and flown and stands_at is not None:
        length_m = length_on_sphere_m(stands_at, position_of(flown[0][1]))
        if length_m >= most_m:
            params = {"metres": round(length_m), "parameter": FIRST_LEG, "allowed": round(most_m)}
            warnings.append(LimitWarning("far-first-waypoint", Reason("far_first_waypoint", params), 0))
    most_m = parameters.get(ANY_LEG, 0.0)
    if most_m > 0:
        for (_, left), (place, right) in pairwise(flown):
            length_m = length_on_sphere_m(position_of(left), position_of(right))
            if length_m > most_m:
                params = {"item": place, "metres": round(length_m), "parameter": ANY_LEG, "allowed": round(most_m)}
                warnings.append(LimitWarning("long-leg", Reason("long_leg", params), place))
    return tuple(warnings)
