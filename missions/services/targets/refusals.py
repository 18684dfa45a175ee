"""Why a target is left out of a plan before any route is looked for, and why a UAV stays on the ground."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from django.conf import settings

from inspection.geodesy import LonLat
from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.route_index import asset_places
from inspection.network.zones.zone_index import ZoneIndex
from inspection.selectors.planning import Edition
from missions.models import UavState
from missions.selectors.fleet import states_out_of_service
from missions.services.planning.requests import UavRequest
from missions.services.targets.places import Place
from missions.services.targets.shortfall import Shortfall
from planning.connection_points import AccessRules, tallest_support_m
from planning.rules import FlightRules
from planning.trajectory.heights import inspection_agl_m, is_above_limit


@dataclass(frozen=True)
class Scene:
    """What every step of one plan looks at. `graph` is the part of `whole_graph` that can be flown over.

    `zones` are all that are kept clear of, `leg_zones` those of them that reach the heights between targets; both with what is too tall
    to be flown over.
    """

    whole_graph: InspectionGraph
    network: Network  # free of zones
    graph: InspectionGraph
    zones: ZoneIndex
    leg_zones: ZoneIndex
    access: AccessRules
    flight: FlightRules
    edition: Edition  # of the ground, when the plan was begun
    is_by_length: bool = False  # whether the shortest ways are the best on it, near infrastructure or not


@dataclass(frozen=True)
class LeftOut:
    """A target that no route visits; `target` is its place in the request.

    missing: metres or Wh without which no UAV can do it even alone, 0 where one could; None where that has no number. `shortfall` is
    what the message tells. uavs: those that the message speaks of, by their places in the request.
    """

    target: int
    reason: str
    message: str
    missing: float | None = None
    shortfall: Shortfall | None = None
    uavs: tuple[int, ...] = ()


def asset_gone(target: int) -> LeftOut:
    return LeftOut(target, "asset_gone", "The asset has been deleted since it was picked.")


def refused_place(place: Place, scene: Scene) -> LeftOut | None:
    """Why a place can be on no route at all, or None. Zones count at the heights between its inspection and the flight to it."""
    height_m = place_height_m(place, scene)
    agl_m = inspection_agl_m(height_m, scene.flight)
    if is_above_limit(height_m, scene.flight):
        needed_m = height_m + scene.flight.clearance_m
        limit_m = scene.flight.max_agl_m
        message = f"It is {height_m:.0f} m high: a UAV would have to fly at {needed_m:.0f} m, above the limit of {limit_m:.0f} m."
        return LeftOut(place.target, "above_height_limit", message)
    if place.is_stretch:
        zone = _zone_along(place.course, agl_m, scene)
        if zone is not None:
            return LeftOut(place.target, "inside_zone", f"It runs through {zone}.")
    else:
        zone = zone_at(place.course[0], scene, agl_m)
        if zone is not None:
            return LeftOut(place.target, "inside_zone", f"It stands inside {zone}.")
    return None


def place_height_m(place: Place, scene: Scene) -> float:
    """The asset's height, not less than what its line's voltage tells; over a stretch of a line not less than its tallest support."""
    if place.asset is None:
        return place.height_m
    if place.is_stretch:
        return max(place.height_m, tallest_support_m(scene.network, place.asset, place.course))
    node = asset_places(scene.whole_graph).node_of(place.asset)
    return place.height_m if node is None else float(np.fmax(place.height_m, scene.whole_graph.node_height_m[node]))


@dataclass(frozen=True)
class Grounding:
    """Why a UAV stays on the ground."""

    code: str
    message: str


def groundings(uavs: Sequence[UavRequest], scene: Scene) -> dict[int, Grounding]:
    """By their places in the request, the UAVs that cannot take off: retired, in maintenance, or inside a zone."""
    stored = [uav.uav for uav in uavs if uav.uav is not None]
    states = states_out_of_service(stored) if stored else {}
    found: dict[int, Grounding] = {}
    for number, uav in enumerate(uavs):
        zone = zone_at(uav.position, scene)
        state = states.get(uav.uav) if uav.uav is not None else None
        if state is UavState.RETIRED:
            found[number] = Grounding("uav_out_of_service", f"{uav.name} is retired and flies no more.")
        elif state is not None:
            found[number] = Grounding("uav_out_of_service", f"{uav.name} is in maintenance and does not fly.")
        elif zone is not None:
            found[number] = Grounding("uav_inside_zone", f"{uav.name} stands inside {zone} and cannot take off.")
    return found


def zone_at(position: LonLat, scene: Scene, agl_m: float = 0.0) -> str | None:
    """Name of the zone that holds the position between this height above ground and that of the flight to it.

    A place nearer to a zone than the clearance counts as inside it.
    """
    if not len(scene.zones):
        return None
    low_m, high_m = column_m(agl_m, scene)
    if not scene.zones.contains([position], scene.access.zone_clearance_m, low_m, high_m)[0]:
        return None
    found = scene.zones.zone_at(position, low_m, high_m)
    return found[1] if found else f"the {scene.access.zone_clearance_m:g} m around a no-fly zone"


def _zone_along(course: tuple[LonLat, ...], agl_m: float, scene: Scene) -> str | None:
    line = np.array(course)
    low_m, high_m = column_m(agl_m, scene)
    met = np.flatnonzero(scene.zones.meets(line[:-1], line[1:], scene.access.zone_clearance_m, low_m, high_m))
    if not len(met):
        return None
    for leg in met.tolist():
        found = scene.zones.first_met(course[leg], course[leg + 1], low_m, high_m)
        if found is not None:
            return found[1]
    return f"the {scene.access.zone_clearance_m:g} m around a no-fly zone"


def column_m(agl_m: float, scene: Scene) -> tuple[float, float]:
    """From this height to that of the flight to it, with all that a height may stray and that is kept from a zone's limits."""
    give_m = scene.flight.terrain_tolerance_m + settings.ZONE_RULES.height_margin_m
    return min(agl_m, scene.flight.transit_agl_m) - give_m, max(agl_m, scene.flight.transit_agl_m) + give_m
