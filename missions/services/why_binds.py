"""What a route takes of its battery and its time, and what keeps it from being longer or quicker."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from missions.services.counted import counted
from missions.services.laid_out import LaidOut
from missions.services.places import Place
from missions.services.refusals import Scene, place_height_m, zone_at
from missions.services.requests import CALM, PlanRequest
from missions.services.visits import visits_of_places
from planning.connection_points import Ways
from planning.energy.assignment_costs import FlightCosts
from planning.problem import Amounts, Objective
from planning.trajectory.heights import inspection_agl_m

NEARLY = 0.9  # of a limit: no other target fits
NOTICEABLE = 1.05  # times as long as in calm air


def what_binds(
    request: PlanRequest,
    scene: Scene,
    places: Sequence[Place],
    ways: Ways,
    orders: Mapping[int, Sequence[int]],
    uav: int,
    *,
    length_m: float,
    is_round_zones: bool,
) -> dict[str, Any]:
    """orders: the visits of each UAV of the request that flies, by its number; uav is the one that is asked about."""
    flying = [number for number, asked in enumerate(request.uavs) if zone_at(asked.position, scene) is None]
    costs = _costs(request, scene, places, ways, flying)
    seconds_s = {number: _of_route(costs, "seconds", flying.index(number), order) for number, order in orders.items() if number in flying}
    calm = replace(request, conditions=replace(CALM, temperature_c=request.conditions.temperature_c))
    calm_s = _of_route(_costs(calm, scene, places, ways, flying), "seconds", flying.index(uav), orders[uav])
    asked = request.uavs[uav]
    usable_wh = asked.performance.usable_wh
    used_wh = None if usable_wh is None else _of_route(costs, "wh", flying.index(uav), orders[uav])
    binds = {
        "battery": usable_wh is not None and used_wh is not None and used_wh >= NEARLY * usable_wh * asked.sorties,
        "range": asked.max_range_m is not None and length_m >= NEARLY * asked.max_range_m * asked.sorties,
        "most_targets": asked.most_targets is not None and len(orders[uav]) >= asked.most_targets,
        "zone": is_round_zones,
        "wind": seconds_s[uav] >= NOTICEABLE * calm_s,
        "balance": request.objective is Objective.MAKESPAN and len(seconds_s) > 1 and seconds_s[uav] < max(seconds_s.values()),
    }
    return {
        "used_wh": used_wh,
        "usable_wh": None if usable_wh is None else usable_wh * asked.sorties,
        "flown_s": seconds_s[uav],
        "wind_s": seconds_s[uav] - calm_s,
        "binds": [what for what, is_so in binds.items() if is_so],
    }


def _costs(request: PlanRequest, scene: Scene, places: Sequence[Place], ways: Ways, flying: Sequence[int]) -> FlightCosts:
    visits, courses = visits_of_places(places)
    agl_m = [inspection_agl_m(place_height_m(place, scene), scene.flight) for place in places]
    bases = [base for base in request.bases if zone_at(base.position, scene) is None]
    return counted(LaidOut(request, scene, places, agl_m, visits, courses, ways, bases), flying)


def _of_route(costs: FlightCosts, quantity: str, number: int, order: Sequence[int]) -> float:
    amounts = Amounts(**vars(getattr(costs, quantity)))
    return float(amounts.of_route(number, costs.class_of[number], order))
