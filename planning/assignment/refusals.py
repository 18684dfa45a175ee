"""Why a target is left out of a plan before any route is looked for, and why a UAV stays on the ground."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat
from inspection.network.route_index import asset_places
from operation.reasons import Reason
from planning.airspace import Airspace, zone_along, zone_at
from planning.connection_points import tallest_support_m
from planning.context import ResolvedTarget
from planning.plan import UnassignedTarget
from planning.request import UavRequest
from planning.trajectory.heights import inspection_agl_m, is_above_limit

# why a stored UAV is not planned: the code of the warning, and that of its reason
NOT_PLANNED = {
    "retired": ("uav_out_of_service", "uav_retired"),
    "maintenance": ("uav_out_of_service", "uav_in_maintenance"),
    "without_type": ("uav_incomplete", "uav_without_type"),
    "without_range": ("uav_incomplete", "uav_without_range"),
}


def deleted_target(target: int) -> UnassignedTarget:
    return UnassignedTarget(target, "asset_gone", (Reason("asset_deleted"),))


def refused_target(target: ResolvedTarget, airspace: Airspace) -> UnassignedTarget | None:
    """Return why a target can be on no route at all, or None. Zones count at the heights between its inspection and the flight to it."""
    height_m = target_height_m(target, airspace)
    agl_m = inspection_agl_m(height_m, airspace.flight)
    if is_above_limit(height_m, airspace.flight):
        figures = {"height_m": height_m, "needed_m": height_m + airspace.flight.clearance_m, "limit_m": airspace.flight.max_agl_m}
        return UnassignedTarget(target.target, "above_height_limit", (Reason("above_height_limit", figures),))
    if target.is_stretch:
        zone = zone_along(target.course, (agl_m, agl_m), airspace)
        if zone is not None:
            return UnassignedTarget(target.target, "inside_zone", (Reason("runs_through_zone", zone.params),))
    else:
        zone = zone_at(target.course[0], airspace, agl_m)
        if zone is not None:
            return UnassignedTarget(target.target, "inside_zone", (Reason("stands_inside_zone", zone.params),))
    return _without_photos(target, airspace)


def _without_photos(target: ResolvedTarget, airspace: Airspace) -> UnassignedTarget | None:
    """Return why the photos that are asked of a target cannot be taken, or None."""
    if target.no_photos is not None:
        return UnassignedTarget(target.target, "no_photos", (target.no_photos,))
    if target.photos is None:
        return None
    heights_m = float(target.photos.agl_m.min()), float(target.photos.agl_m.max())
    zone = zone_along([LonLat(*at) for at in target.photos.position.tolist()], heights_m, airspace)
    return None if zone is None else UnassignedTarget(target.target, "inside_zone", (Reason("photos_meet_zone", zone.params),))


def target_height_m(target: ResolvedTarget, airspace: Airspace) -> float:
    """The asset's height, not less than what its line's voltage tells; over a stretch of a line not less than its tallest support.

    Of a target with photos so much that the UAV comes to it and leaves it no lower than where the flight through them begins.
    """
    if target.photos is not None:
        return max(_asset_height_m(target, airspace), float(target.photos.agl_m[0]) - airspace.flight.clearance_m)
    return _asset_height_m(target, airspace)


def _asset_height_m(target: ResolvedTarget, airspace: Airspace) -> float:
    if target.asset is None:
        return target.height_m
    if target.is_stretch:
        return max(target.height_m, tallest_support_m(airspace.network, target.asset, target.course))
    node = asset_places(airspace.whole_graph).node_of(target.asset)
    return target.height_m if node is None else float(np.fmax(target.height_m, airspace.whole_graph.node_height_m[node]))


@dataclass(frozen=True)
class Grounding:
    """Why a UAV stays on the ground. code: one of the API's."""

    code: str
    why: Reason


def groundings(uavs: Sequence[UavRequest], airspace: Airspace) -> dict[int, Grounding]:
    """By their places in the request, the UAVs that cannot take off: retired, in maintenance, incomplete, or inside a zone."""
    found: dict[int, Grounding] = {}
    for number, uav in enumerate(uavs):
        zone = zone_at(uav.position, airspace)
        state = None if uav.uav is None else airspace.context.out_of_service.get(uav.uav)
        if state is not None:
            code, reason = NOT_PLANNED[state]
            found[number] = Grounding(code, Reason(reason, {"uav": uav.name}))
        elif zone is not None:
            found[number] = Grounding("uav_inside_zone", Reason("uav_inside_zone", {"uav": uav.name, **zone.params}))
    return found
