"""Random missions on generated and real regions: no leg meets a zone, distances equal networkx's, reasons for unassigned targets hold."""

import math
import random
from collections import Counter
from functools import cache
from itertools import pairwise
from typing import Any

import networkx as nx
import numpy as np
import pytest
import shapely

from inspection.geodesy import distance_m, path_length_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.selectors import zones_in_force
from inspection.services import import_osm
from missions.selectors.planning_context import current_airspace
from missions.selectors.resolved_targets import NamedTarget, resolved_targets
from missions.services import PlanRequest, make_plan
from planning.airspace import Airspace
from planning.connection_points import TargetPaths, Terminal, access_legs, attachments, direct_legs, paths_between
from planning.problem import Objective, Problem, UavStart, Visit
from tests.cases import long
from tests.exact_geometry import segment_meets_polygon
from tests.missions.property_tests.random_missions import Region, put_random_zones
from tests.planning.solver.random_problems import best_merit

pytestmark = pytest.mark.django_db

REAL_REGIONS = ["columbus-ohio.osm.pbf", "liechtenstein-2021-infra.osm.pbf", "nepal-power-2025.osm.pbf"]
ZONE_SETS = 2
NETWORKX_EVERY = 12  # of so many missions one is checked against networkx

Rings = list[list[tuple[float, float]]]


@pytest.mark.parametrize("file_name", ["quillmoor.osm.pbf", *long("elme-valley.osm.pbf")])
def test_random_missions_keep_every_promise(region_file: Any, file_name: str) -> None:
    _fly(region_file(file_name), missions=40, seed=1)


@pytest.mark.long
@pytest.mark.parametrize("file_name", REAL_REGIONS)
def test_2000_random_missions_keep_every_promise(region_file: Any, file_name: str) -> None:
    _fly(region_file(file_name), missions=667, seed=2)


def _fly(path: Any, *, missions: int, seed: int) -> None:
    import_osm(path=path)
    seen: Counter[str] = Counter()
    for zone_set in range(ZONE_SETS):
        put_random_zones(seed * 100 + zone_set)
        region, scene, shortest = Region(), current_airspace(), current_airspace(is_by_length=True)
        draw = random.Random(seed * 1_000 + zone_set)
        rings = _exact_rings()
        network = _networkx_graph(scene.graph)
        for number in range(missions // ZONE_SETS + 1):
            request = region.mission(draw)
            plan = make_plan(request=request)
            _assert_no_leg_meets_a_zone(plan, rings)
            _assert_ranges_and_lengths(request, plan)
            model = MissionModel(request, scene)
            _assert_reasons_are_true(request, plan, scene, model, shortest)
            if number % NETWORKX_EVERY == 0:
                model.assert_distances_are_networkxs(network)
                seen["checked by networkx"] += 1
            seen.update(item["reason"] for item in plan["unassigned"])
            seen["visited"] += sum(len(route["targets"]) for route in plan["routes"])
    print(path.name, dict(seen))
    assert seen["visited"] > missions
    assert seen["inside_zone"] > 0
    assert seen["beyond_range"] > 0


def _exact_rings() -> list[tuple[tuple[float, float, float, float], Rings]]:
    """Bounding box and rings of every polygon in force."""
    polygons = shapely.get_parts(zones_in_force().polygons)
    return [
        (polygon.bounds, [list(polygon.exterior.coords), *(list(ring.coords) for ring in polygon.interiors)])
        for polygon in polygons.tolist()
    ]


def _assert_no_leg_meets_a_zone(plan: dict[str, Any], rings: list[tuple[tuple[float, float, float, float], Rings]]) -> None:
    for route in plan["routes"]:
        places = [tuple(waypoint["position"]) for waypoint in route["waypoints"]]
        if places:
            line = [tuple(place) for place in route["geometry"]["coordinates"]]
            assert (
                line == [place for number, place in enumerate(places) if number == 0 or place != places[number - 1]]
                or len(set(places)) == 1
            )
        for (west, south, east, north), zone in rings:
            for start, end in pairwise(places):
                if (
                    max(start[0], end[0]) < west
                    or min(start[0], end[0]) > east
                    or max(start[1], end[1]) < south
                    or min(start[1], end[1]) > north
                ):
                    continue
                assert not segment_meets_polygon(start, end, zone), f"{start} to {end}"


def _assert_ranges_and_lengths(request: PlanRequest, plan: dict[str, Any]) -> None:
    for uav, route in zip(request.uavs, plan["routes"], strict=True):
        flown_m = path_length_m(np.array(route["geometry"]["coordinates"])) if route["geometry"] else 0.0
        assert route["length_m"] == pytest.approx(flown_m, rel=1e-6, abs=0.002)
        if uav.max_range_m is not None:
            assert flown_m <= uav.max_range_m
    assert plan["total_length_m"] == pytest.approx(sum(route["length_m"] for route in plan["routes"]), abs=0.01)
    done = [target for route in plan["routes"] for target in route["targets"]] + [item["target"] for item in plan["unassigned"]]
    assert sorted(done) == list(range(len(request.targets)))


class MissionModel:
    """The mission as terminals and ways, put together here once more from the request, without the planner's own assembly."""

    def __init__(self, request: PlanRequest, scene: Airspace) -> None:
        self.scene = scene
        self.places, _ = resolved_targets(request.targets)
        near = scene.access.zone_clearance_m
        self.uavs = [number for number, uav in enumerate(request.uavs) if not scene.zones.contains([uav.position], near)[0]]
        self.open = [place for place in self.places if not _is_in_zone(place, scene)]
        self.visits, self.courses = [], []
        for number, place in enumerate(self.open):
            for is_reversed in (False, True) if len(place.course) > 1 else (False,):
                self.visits.append(Visit(number, is_reversed, path_length_m(np.array(place.course))))
                self.courses.append((place, place.course[::-1] if is_reversed else place.course))
        self.starts = [Terminal(request.uavs[uav].position) for uav in self.uavs]
        self.entries = [Terminal(course[0], place.asset) for place, course in self.courses]
        self.exits = [Terminal(course[-1], place.asset) for place, course in self.courses]
        bases = [Terminal(base.position) for base in request.bases if not scene.zones.contains([base.position], near)[0]]
        self.ways: TargetPaths = paths_between(scene.graph, scene.zones, self.starts, self.entries, self.exits, scene.access, bases)
        self.problem = Problem(
            uavs=tuple(
                UavStart(request.uavs[uav].max_range_m, request.route_end(uav), request.uavs[uav].cruise_speed_mps) for uav in self.uavs
            ),
            visits=tuple(self.visits),
            target_count=len(self.open),
            from_start_m=self.ways.from_start_m,
            between_m=self.ways.between_m,
            to_start_m=self.ways.to_start_m,
            objective=Objective.TOTAL if request.objective is Objective.ENERGY else request.objective,  # who is left out is the same
            to_base_m=np.repeat(self.ways.to_base_m[:, None], len(self.uavs), axis=1),
        )

    def assert_distances_are_networkxs(self, network: nx.Graph) -> None:
        """Costs of all pairs by networkx's Dijkstra, with starts and targets hung on by the same legs."""
        scene, ways = self.scene, self.ways
        sources, sinks = [*self.starts, *self.exits], [*self.entries, *self.starts]
        direct = {(leg.source, leg.sink): leg.cost for leg in direct_legs(sources, sinks, scene.zones, scene.access)}
        for row, outward in enumerate([*ways.uav_legs, *ways.exit_legs]):
            for leg in outward:
                line = np.array([sources[row].position, *leg.bends, scene.graph.position[leg.node]])
                assert leg.length_m == pytest.approx(path_length_m(line), abs=1e-6)
                assert not scene.zones.meets(line[:-1], line[1:], scene.access.zone_clearance_m).any()
            network.add_weighted_edges_from(("source", leg.node, leg.cost) for leg in outward)
            cost = nx.single_source_dijkstra_path_length(network, "source") if outward else {}
            network.remove_nodes_from(["source"])
            for column, inward in enumerate([*ways.entry_legs, *ways.uav_legs]):
                over_network = min((cost.get(leg.node, math.inf) + leg.cost for leg in inward), default=math.inf)
                straight = direct.get((row, column), math.inf)
                assert ways.travel.cost[row, column] == pytest.approx(min(over_network, straight), rel=1e-9)


def _networkx_graph(graph: InspectionGraph) -> nx.Graph:
    network = nx.Graph()
    network.add_nodes_from(range(graph.node_count))
    network.add_weighted_edges_from(zip(graph.edge[:, 0].tolist(), graph.edge[:, 1].tolist(), graph.cost.tolist(), strict=True))
    return network


def _is_in_zone(place: NamedTarget, scene: Airspace) -> bool:
    near = scene.access.zone_clearance_m
    if len(place.course) == 1:
        return bool(scene.zones.contains([place.course[0]], near)[0])
    line = np.array(place.course)
    return bool(scene.zones.meets(line[:-1], line[1:], near).any())


def _assert_reasons_are_true(request: PlanRequest, plan: dict[str, Any], scene: Airspace, model: MissionModel, shortest: Airspace) -> None:
    reason_of = {item["target"]: item["reason"] for item in plan["unassigned"]}
    for place in model.places:
        reason = reason_of.get(place.target)
        assert (reason == "inside_zone") == _is_in_zone(place, scene)
        if reason == "inside_zone":
            assert _metres_to_a_zone(place, scene) <= scene.access.zone_clearance_m * 1.02
    for number, place in enumerate(model.open):
        reason = reason_of.get(place.target)
        if reason == "too_far_from_network":
            for end in (place.course[0], place.course[-1]):
                everywhere = np.broadcast_to(np.array(end), scene.graph.position.shape)
                assert distance_m(everywhere, scene.graph.position).min() > scene.access.access_leg_m
        if reason in {"no_path", "too_far_from_network"}:
            assert not _can_be_reached(number, model, scene) or not _fits_beside_the_others(model, plan)
        if reason == "beyond_range":
            assert any(uav.max_range_m is not None for uav in request.uavs)
    if not model.uavs:
        assert len(reason_of) == len(request.targets)
        return
    left_out, least = len(reason_of) - (len(model.places) - len(model.open)), best_merit(model.problem)[0]
    if "beyond_range" in reason_of.values() or is_on_shortest_ways(plan):
        on_shortest = best_merit(MissionModel(request, shortest).problem)[0]
        assert is_on_shortest_ways(plan) == (on_shortest < least)
        least = min(least, on_shortest)
    assert left_out == least


def is_on_shortest_ways(plan: dict[str, Any]) -> bool:
    """What is out of reach along infrastructure is tried on the shortest ways."""
    return any(warning["code"] == "shortest_ways" for warning in plan["warnings"])


def _fits_beside_the_others(model: MissionModel, plan: dict[str, Any]) -> bool:
    """Whether a better plan would have visited more."""
    visited = sum(len(route["targets"]) for route in plan["routes"])
    return bool(model.uavs) and len(model.open) - best_merit(model.problem)[0] > visited


def _can_be_reached(target: int, model: MissionModel, scene: Airspace) -> bool:
    """By components alone: whether access legs and direct legs join the target to a UAV, perhaps by way of other targets."""
    network = _component_of(scene.graph)
    joined = nx.Graph()
    for number, start in enumerate(model.starts):
        joined.add_edges_from(
            (("uav", number), ("network", network[leg.node])) for leg in attachments(scene.graph, scene.zones, start, scene.access)
        )
    for visit, entry in zip(model.visits, model.entries, strict=True):
        legs = [*attachments(scene.graph, scene.zones, entry, scene.access), *access_legs(scene.graph, scene.zones, entry, scene.access)]
        joined.add_edges_from((("target", visit.target), ("network", network[leg.node])) for leg in legs)
    names = [*(("uav", number) for number in range(len(model.starts))), *(("target", visit.target) for visit in model.visits)]
    for leg in direct_legs([*model.starts, *model.exits], model.entries, scene.zones, scene.access):
        joined.add_edge(names[leg.source], ("target", model.visits[leg.sink].target))
    goal = ("target", target)
    return goal in joined and any(
        ("uav", number) in joined and nx.has_path(joined, ("uav", number), goal) for number in range(len(model.starts))
    )


@cache
def _component_of(graph: InspectionGraph) -> dict[int, int]:
    parts = nx.connected_components(_networkx_graph(graph))
    return {node: number for number, nodes in enumerate(parts) for node in nodes}


def _metres_to_a_zone(place: NamedTarget, scene: Airspace) -> float:
    """Measured in a plane stretched to metres at the place."""
    lon, lat = place.course[0]
    scale = np.array([111_320.0 * math.cos(math.radians(lat)), 111_320.0])
    course = shapely.points((np.array(place.course) - (lon, lat)) * scale)
    line = shapely.linestrings(shapely.get_coordinates(course)) if len(place.course) > 1 else course[0]
    zones = [shapely.transform(zone, lambda at: (at - (lon, lat)) * scale) for zone in scene.zones.polygons]
    return float(min(shapely.distance(line, zone) for zone in zones))
