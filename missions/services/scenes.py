"""What a plan looks at: the network cleared of its zones, the zones, and the rules."""

import numpy as np
from django.conf import settings

from inspection.selectors.planning import PlanningGround, planning_read
from inspection.zones.reach import BoolArray
from missions.flight_plan.flyable_graph import flyable_graph
from missions.routing.terminals import AccessRules
from missions.services.refusals import Scene
from missions.services.requests import PlanRequest
from missions.services.zone_choice import zone_choice


def scene_on(ground: PlanningGround, chosen: BoolArray | None) -> Scene:
    """With all zones of the ground, or with those where the mask (z,) is true. Raises NoGraph."""
    linking, routing, flight = settings.GRAPH_RULES, settings.ROUTING_RULES, settings.FLIGHT_RULES
    access = AccessRules(
        access_leg_m=routing.access_leg_m,
        direct_leg_m=routing.direct_leg_m,
        on_asset_m=linking.railway_spacing_m,
        off_network_factor=linking.off_network_factor,
        zone_clearance_m=linking.zone_clearance_m,
    )
    zones = ground.zones(chosen)
    graph = ground.graph(zones)
    in_transit = ground.table.reaching(flight.transit_agl_m - flight.terrain_tolerance_m, flight.max_agl_m + flight.terrain_tolerance_m)
    leg_zones = ground.zones(in_transit if chosen is None else chosen & in_transit)
    return Scene(graph, ground.network(), flyable_graph(graph, flight), zones, leg_zones, access, flight, ground.edition)


def current_scene(request: PlanRequest | None = None) -> Scene:
    """With all zones, or with those that can be in force while the request is flown. Raises NoGraph."""
    ground = planning_read().ground()
    chosen = None if request is None else zone_choice(ground.table, request.departs_at, settings.FLIGHT_RULES).widest
    return scene_on(ground, chosen)


def scene_without_zones() -> Scene:
    """As if there were none. Raises NoGraph."""
    ground = planning_read().ground()
    return scene_on(ground, np.zeros(len(ground.table), dtype=bool))
