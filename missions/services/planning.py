"""One plan from request to answer: places, ways, assignment, waypoints, heights, and the last look at the zones."""

from collections.abc import Sequence
from typing import Any

from django.conf import settings

from inspection.selectors import ground_heights_m, ground_revision, terrain_edition
from inspection.selectors.graph import zones_of_edition
from inspection.selectors.planning import Edition, PlanningGround, edition_now, has_terrain_at, planning_read
from missions.flight_plan.clearance import RouteMeetsZone, refuse_legs_in_zones
from missions.flight_plan.flyable_graph import flyable_graph
from missions.routing.solver import Stop, never
from missions.routing.terminals import AccessRules
from missions.services.assignment import quality_of
from missions.services.attempts import attempt
from missions.services.best_so_far import OnPlanProgress, PlanProgress, unheard
from missions.services.places import places_of, whole_assets
from missions.services.plan_json import PlannedRoute, plan_to_json
from missions.services.refusals import Scene
from missions.services.requests import PlanRequest


class GraphOutdated(Exception):
    """A zone is in force that the graph does not know yet, and a route would meet it. A new graph is seconds away."""

    def __init__(self, zone_name: str) -> None:
        super().__init__(f"{zone_name} has just changed, and the network is being rebuilt for it. Plan again in a moment.")


def make_plan(
    *,
    request: PlanRequest,
    stop: Stop = never,
    on_progress: OnPlanProgress = unheard,
    seed: int = 7,
    search_s: float = 0.0,
    as_text: bool = False,
) -> dict[str, Any]:
    """The plan in the shape of the API, on demand with parts of it `as_text` (see plan_to_json).

    Raises InvalidRequest, NoGraph or GraphOutdated.
    """
    on_progress(PlanProgress(0.0, "Looking up the targets"))
    read = planning_read(whole_assets(request.targets))
    places, gone = places_of(request.targets, read.points)
    scene = _scene_on(read.ground())
    found = attempt(request, places, gone, scene, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)

    on_progress(PlanProgress(0.95, "Working out heights and checking every leg"))
    edition = scene.edition
    while True:
        ground_before = terrain_edition() if edition != scene.edition else None
        has_ground = has_terrain_at(edition)
        routes = found.routes(request, ground_heights_m if has_ground else None)
        now = _look_at_zones_again(routes, scene)
        if now == edition or (ground_before is not None and terrain_edition() == ground_before):
            break  # else the heights belong to another ground than the revision says
        edition = now
    return plan_to_json(
        request,
        routes,
        found.left_out,
        [{"code": why.code, "uav": number, "message": why.message} for number, why in found.grounded.items()],
        graph_version=scene.graph.version,
        ground_revision=now[0],
        has_terrain=has_ground,
        separation={},
        quality=quality_of(
            found.solution,
            found.lock_cost,
            request.objective,
            total_m=sum(route.length_m for route in routes),
            longest_s=max(route.duration_s for route in routes),
        ),
        as_text=as_text,
    )


def current_scene() -> Scene:
    """Raises NoGraph."""
    return _scene_on(planning_read().ground())


def _scene_on(ground: PlanningGround) -> Scene:
    linking, routing, flight = settings.GRAPH_RULES, settings.ROUTING_RULES, settings.FLIGHT_RULES
    access = AccessRules(
        access_leg_m=routing.access_leg_m,
        direct_leg_m=routing.direct_leg_m,
        on_asset_m=linking.railway_spacing_m,
        off_network_factor=linking.off_network_factor,
        zone_clearance_m=linking.zone_clearance_m,
    )
    return Scene(ground.graph, flyable_graph(ground.graph, flight), ground.zones, access, flight, ground.edition)


def _look_at_zones_again(routes: Sequence[PlannedRoute], scene: Scene) -> Edition:
    """Check every leg against the zones in force at this moment; returns the ground's edition that they belong to."""
    now = edition_now()
    zones = zones_of_edition(now)
    for route in routes:
        if route.line is None:
            continue
        try:
            refuse_legs_in_zones(route.line, zones.polygons)
        except RouteMeetsZone as error:
            if scene.graph.ground_revision < ground_revision():  # asked anew: the zones may be younger than `now`
                raise GraphOutdated(zones.names[error.zone]) from error
            raise
    return now
