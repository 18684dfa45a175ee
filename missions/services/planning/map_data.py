"""What a plan looks at: the network cleared of its zones, the zones, and the rules."""

import numpy as np
from django.conf import settings

from inspection.network.build.obstacles import too_tall_walls, with_walls
from inspection.network.by_length import by_length
from inspection.network.zones.zone_index import ZoneIndex
from inspection.selectors.planning import PlanningGround, planning_read
from inspection.zones.reach import BoolArray
from missions.services.planning.requests import PlanRequest
from missions.services.planning.zone_choice import zone_choice
from missions.services.targets.refusals import Scene
from planning.clearance.flyable_graph import flyable_graph
from planning.connection_points import AccessRules


def scene_on(ground: PlanningGround, chosen: BoolArray | None, more_walls: ZoneIndex | None = None, *, is_by_length: bool = False) -> Scene:
    """With all zones of the ground, or with those where the mask (z,) is true. Raises NoGraph.

    What cannot be flown over is kept clear of like a zone; more_walls is what has shown itself to be so. With
    is_by_length the shortest ways are the best, near infrastructure or not.
    """
    linking, routing, flight = settings.GRAPH_RULES, settings.ROUTING_RULES, settings.FLIGHT_RULES
    access = AccessRules(
        access_leg_m=routing.access_leg_m,
        direct_leg_m=routing.direct_leg_m,
        on_asset_m=linking.railway_spacing_m,
        off_network_factor=1.0 if is_by_length else linking.off_network_factor,
        zone_clearance_m=linking.zone_clearance_m,
    )
    network, zones = ground.network(), ground.zones(chosen)
    walls = too_tall_walls(network, settings.FLOWN_HEIGHTS)
    graph = ground.graph(zones if more_walls is None else with_walls(zones, more_walls))
    graph = by_length(graph) if is_by_length else graph
    walls = walls if more_walls is None else with_walls(walls, more_walls)
    in_transit = ground.table.reaching(flight.transit_agl_m - flight.terrain_tolerance_m, flight.max_agl_m + flight.terrain_tolerance_m)
    leg_zones = with_walls(ground.zones(in_transit if chosen is None else chosen & in_transit), walls)
    return Scene(
        graph, network, flyable_graph(graph, flight), with_walls(zones, walls), leg_zones, access, flight, ground.edition, is_by_length
    )


def current_scene(request: PlanRequest | None = None, *, is_by_length: bool = False) -> Scene:
    """With all zones, or with those that can be in force while the request is flown; is_by_length as in scene_on. Raises NoGraph."""
    ground = planning_read().ground()
    chosen = None if request is None else zone_choice(ground.table, request.departs_at, settings.FLIGHT_RULES).widest
    return scene_on(ground, chosen, is_by_length=is_by_length)


def scene_without_zones(*, is_by_length: bool = False) -> Scene:
    """As if there were none; is_by_length as in scene_on. Raises NoGraph."""
    ground = planning_read().ground()
    return scene_on(ground, np.zeros(len(ground.table), dtype=bool), is_by_length=is_by_length)
