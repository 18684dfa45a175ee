"""What an autopilot gets beside its route: a fence of nearby zones, and rally points for a lost link."""

from dataclasses import replace

from django.conf import settings

from inspection.geodesy import LonLat
from inspection.selectors.zone_table import zone_table
from mavlink.fence import FenceRules, FenceZone
from missions.models import Mission, Route
from missions.selectors.zones import flown_route, zone_margins
from planning.clearance.lost_link import LostLink
from planning.clearance.nearby_zones import zones_near
from planning.request import lost_link_from_json


def zones_beside(route: Route, departs_s: float | None) -> list[FenceZone]:
    """Return the zones that reach down to the flight's heights and are in force during it; each part of a zone is an entry of its own.

    departs_s: the mission's departure, in seconds since the epoch; None: every zone counts as in force.
    """
    flown, margins = flown_route(route, departs_s), zone_margins()
    near, _facts = zones_near(zone_table(), flown.position, replace(margins, lateral_m=FenceRules.reach_m))
    in_force = [True] * len(near)
    if flown.departs_s is not None and flown.ends_s is not None:
        in_force = near.active_within(flown.departs_s, flown.ends_s).tolist()
    highest_m = float(flown.agl_m.max()) + margins.height_m
    return [
        FenceZone(near.names[row], tuple(LonLat(*place) for place in part.exterior.coords[:-1]))
        for row, counts in enumerate(in_force)
        if counts and near.floor_agl_m[row] <= highest_m
        for part in near.polygons[row].geoms
    ]


def rally_points(mission: Mission, place: int) -> list[tuple[LonLat, float]]:
    """Return the rally points of the UAV at this place, each with the height above its start at which the path was checked.

    Returns none if the UAV is to go on without a link.
    """
    lost_link = lost_link_from_json(mission.lost_link)
    if lost_link.behaviour is LostLink.GO_ON:
        return []
    highest_m = (mission.lost_link_check or {}).get("highest_m") or []
    known_m = highest_m[place] if place < len(highest_m) else None
    return [(point, settings.FLIGHT_RULES.transit_agl_m if known_m is None else known_m) for point in lost_link.rally_points]
