"""Which assets can be inspected from where UAVs stand, one flight for each, and why the others cannot.

A node is judged as a plan with this node as its only target would be: by the way of least cost there and on to where the flight ends,
its metres, and what it takes of the battery in the wind.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame
from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph, NodeKind
from inspection.network.legs import Attachments, joined
from inspection.network.nearness import chord
from inspection.network.paths.access import band_of_legs
from inspection.network.paths.node_tree import points_on_sphere
from inspection.network.paths.one_to_all import CoreGraph, core_graph, search_from
from inspection.network.route_index import components_of_nodes, node_tree, route_index
from inspection.network.rules import asset_heights_m
from inspection.network.zones.zone_index import ZoneIndex
from planning.connection_points import AccessRules, Terminal, access_legs, direct_legs
from planning.energy.conditions import Conditions
from planning.energy.leg_cost import J_PER_WH
from planning.energy.node_cost import DONE, LANDING, LANDING_THERE, TAKE_OFF, UP, at_nodes, both_directions
from planning.energy.path_cost import NO_HEADWAY, FlightClass, GraphTaken, graph_taken
from planning.problem import End
from planning.reachability.reachable_assets import NodeReach, Reach, Reachability, of_assets
from planning.rules import FlightRules
from planning.task import DEFAULT_HOLD_S, TaskKind

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

CALM = Conditions()
USUAL = FlightRules()
MAX_DISTANCE_M, MAX_WH = 1e12, 1e12  # stand for no limit where what is missing is worked out
SAME_PLACE_M = 1.0  # nodes nearer than that have become one
NEAREST_LEGS = 24  # of a node that no flight gets to over the network, as `clear_legs` gives a target
MAX_ROUND = 40  # nodes from which legs round zones are looked for
TRIED_LEGS = (1, 8, 64)  # of the nearest to each part of the network: more, where all of these meet zones


@dataclass(frozen=True)
class PossibleFlight:
    """A UAV that could take off at a place. Without a class of flight neither battery nor wind are looked at."""

    position: LonLat
    end: End
    limit_m: float
    lands: bool = False
    flying: FlightClass | None = None

    @property
    def lands_there(self) -> bool:
        """At its target."""
        return self.lands and self.end is End.OPEN

    @property
    def usable_wh(self) -> float:
        usable_wh = None if self.flying is None else self.flying.performance.usable_wh
        return np.inf if usable_wh is None else usable_wh


@dataclass(frozen=True, eq=False)
class FlownNetwork:
    """A network, the cleared graph of it, and the part of that which can be flown over; with the zones.

    leg_zones are those of the zones that reach the heights between targets. no_landing (n,): nodes of the graph where a flight that lands
    at its target cannot come down to the ground.
    """

    network: Network
    whole_graph: InspectionGraph
    graph: InspectionGraph
    zones: ZoneIndex
    leg_zones: ZoneIndex
    no_landing: BoolArray | None = None


def reach(
    flown: FlownNetwork,
    flights: Sequence[PossibleFlight],
    bases: Sequence[LonLat],
    rules: AccessRules,
    *,
    conditions: Conditions = CALM,
    flight_rules: FlightRules = USUAL,
) -> Reach:
    """Bases are outside zones. At a tower or bridge a photo is taken, elsewhere a look."""
    network, whole_graph, graph = flown.network, flown.whole_graph, flown.graph
    on_whole = _nodes_of(network.position, network.node_asset, whole_graph.position, whole_graph.node_asset)
    on_graph = _nodes_of(network.position, network.node_asset, graph.position, graph.node_asset)
    state, zone = _off_the_graph(network, whole_graph, graph, on_whole, on_graph, flown.zones, rules.zone_clearance_m)
    found = _reach_of_nodes(graph, flown.leg_zones, flights, bases, rules, conditions, flight_rules, flown.no_landing)
    is_on = on_graph >= 0
    count, at = network.node_count, on_graph[is_on]
    flight, missing_m, missing_wh = np.full(count, -1, dtype=np.int16), np.zeros(count), np.zeros(count)
    state[is_on], flight[is_on] = found.state[at], found.flight[at]
    missing_m[is_on], missing_wh[is_on] = found.missing_m[at], found.missing_wh[at]
    return of_assets(network, graph, on_graph, NodeReach(state, flight, missing_m, missing_wh, zone))


@njit(cache=True, nogil=True)
def _nodes_of(position: FloatArray, asset: IntArray, graph_position: FloatArray, graph_asset: IntArray) -> IntArray:
    """The number in a part of a network of each of its nodes, -1 for those that it lacks. A part keeps the order."""
    found = np.full(len(position), -1, dtype=np.int64)
    at = 0
    for node in range(len(position)):
        if at == len(graph_position):
            break
        is_same = (
            asset[node] == graph_asset[at] and position[node, 0] == graph_position[at, 0] and position[node, 1] == graph_position[at, 1]
        )
        if is_same:
            found[node] = at
            at += 1
    return found


def _off_the_graph(
    network: Network,
    whole_graph: InspectionGraph,
    graph: InspectionGraph,
    on_whole: IntArray,
    on_graph: IntArray,
    zones: ZoneIndex,
    clearance_m: float,
) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
    """Why nodes are not on the graph, and the zones that took them; where two nodes have become one, on_graph is told the other."""
    state = np.full(network.node_count, Reachability.ABOVE_HEIGHT_LIMIT, dtype=np.int8)
    zone = np.full(network.node_count, -1, dtype=np.int32)
    gone = np.flatnonzero(on_whole < 0)
    if len(gone):
        zone[gone] = _zones_at(zones, network.position[gone], clearance_m)
        state[gone[zone[gone] >= 0]] = Reachability.INSIDE_ZONE
        for node in gone[zone[gone] < 0].tolist():
            at = network.position[node]
            nearest = node_tree(graph).nearest(LonLat(*at.tolist()), 1)
            if len(nearest) and distance_m(graph.position[nearest], at[None])[0] <= SAME_PLACE_M:
                on_graph[node] = nearest[0]
    return state, zone


def _zones_at(zones: ZoneIndex, position: FloatArray, clearance_m: float) -> NDArray[np.int32]:
    """For each position the first zone that it is in or nearer to than the clearance; -1 for none."""
    found = np.full(len(position), -1, dtype=np.int32)
    inside = np.flatnonzero(zones.contains(position, clearance_m)) if len(zones) else np.zeros(0, dtype=np.int64)
    if not len(inside):
        return found
    polygons = zones.polygons
    frame = LocalFrame.around(0.0, float(np.abs(position[inside, 1]).max()))
    widest_deg = 1.01 * clearance_m / frame.metres_per_degree_east
    points = shapely.points(position[inside])
    for margin_deg in (0.0, widest_deg):
        at, number = shapely.STRtree(polygons).query(points, predicate="dwithin", distance=margin_deg)
        for place, one in zip(at[::-1].tolist(), number[::-1].tolist(), strict=True):
            if margin_deg == 0.0 or found[inside[place]] < 0:
                found[inside[place]] = one
    return found


def _reach_of_nodes(
    graph: InspectionGraph,
    zones: ZoneIndex,
    flights: Sequence[PossibleFlight],
    bases: Sequence[LonLat],
    rules: AccessRules,
    conditions: Conditions,
    flight_rules: FlightRules,
    no_landing: BoolArray | None,
) -> NodeReach:
    count = graph.node_count
    barred = np.zeros(count, dtype=bool) if no_landing is None else no_landing
    lands_nowhere = np.zeros(count, dtype=bool)
    able_m, flight = np.full(count, np.inf), np.full(count, -1, dtype=np.int16)
    missing_m, missing_wh, has_path = np.full(count, np.inf), np.full(count, np.inf), np.zeros(count, dtype=bool)
    places = list(dict.fromkeys(flight.position for flight in flights))
    legs = {place: access_legs(graph, zones, Terminal(place), rules) for place in places}
    landed_at = bases if any(one.end is End.ANY_BASE for one in flights) else []
    base_legs = [access_legs(graph, zones, Terminal(base), rules) for base in landed_at]
    islands = _Islands.of(graph, zones, joined(list(legs.values())), joined(base_legs), rules)
    scene = _Scene(graph, zones, rules, islands, core_graph(route_index(graph).contracted), conditions, flight_rules)
    to_base: dict[FlightClass | None, _Paths] = {}
    for (place, flying), alike in _alike(flights).items():
        there = scene.ways([place], [legs[place]], flying)
        for number in alike:
            one = flights[number]
            if one.end is End.ANY_BASE and flying not in to_base:
                to_base[flying] = scene.ways(landed_at, base_legs, flying)
            back = there if one.end is End.RETURN else to_base[flying] if one.end is End.ANY_BASE else None
            needed_m = there.length_m if back is None else there.length_m + back.length_m
            needed_wh = scene.needed_wh(there, back, one)
            is_able = (needed_m <= one.limit_m) & (needed_wh <= one.usable_wh) & np.isfinite(needed_wh)
            if one.lands_there:
                lands_nowhere |= is_able & barred
                is_able &= ~barred
            can = is_able & (needed_m < able_m)
            able_m[can], flight[can] = needed_m[can], number
            has_path |= np.isfinite(needed_m)
            against = np.isfinite(needed_m) & np.isfinite(needed_wh)
            np.minimum(missing_m, np.where(against, needed_m - min(one.limit_m, MAX_DISTANCE_M), np.inf), out=missing_m)
            enough = against & (needed_m <= one.limit_m)
            np.minimum(missing_wh, np.where(enough, needed_wh - min(one.usable_wh, MAX_WH), np.inf), out=missing_wh)
    state = np.full(count, Reachability.CUT_OFF, dtype=np.int8)
    state[has_path] = Reachability.WIND
    state[np.isfinite(missing_m)] = Reachability.BEYOND_RANGE
    state[np.isfinite(missing_wh)] = Reachability.BEYOND_ENERGY
    state[lands_nowhere] = Reachability.NO_LANDING
    state[flight >= 0] = Reachability.REACHABLE
    return NodeReach(
        state,
        flight,
        np.where(state == Reachability.BEYOND_RANGE, missing_m, 0.0),
        np.where(state == Reachability.BEYOND_ENERGY, missing_wh, 0.0),
        np.full(count, -1, dtype=np.int32),
    )


def _alike(flights: Sequence[PossibleFlight]) -> dict[tuple[LonLat, FlightClass | None], list[int]]:
    """Flights by the place that they start at and how they fly, so that ways are found once for all of them."""
    alike: dict[tuple[LonLat, FlightClass | None], list[int]] = {}
    for number, one in enumerate(flights):
        alike.setdefault((one.position, one.flying), []).append(number)
    return alike


@dataclass(frozen=True, eq=False)
class _Islands:
    """Nodes of parts of the network that no flight gets onto, and clear legs from them to nodes of other parts: column by column."""

    node: IntArray
    other: IntArray
    length_m: FloatArray

    @classmethod
    def of(cls, graph: InspectionGraph, zones: ZoneIndex, legs: Attachments, base_legs: Attachments, rules: AccessRules) -> "_Islands":
        """As a plan gives such a target legs of its own: of its nearest neighbours, and the shortest clear one to each part that counts.

        The parts that count are those that flights or bases meet.
        """
        component = components_of_nodes(graph)
        met, known = (np.zeros(component.max(initial=-1) + 1, dtype=bool) for _ in range(2))
        met[component[legs.node]] = True
        known[component[legs.node]], known[component[base_legs.node]] = True, True
        left = np.flatnonzero(~met[component])
        if not len(left) or not met.any():
            return cls(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))
        look = _Look(graph, zones, rules, points_on_sphere(graph.position))
        found = [look.legs(left, np.arange(graph.node_count), NEAREST_LEGS, known, component)]
        for part in np.flatnonzero(known).tolist():
            nodes = np.flatnonzero(component == part)
            waiting = left[component[left] != part]
            for tried in TRIED_LEGS:
                waiting = look.near(waiting, nodes)
                found.append(look.legs(waiting, nodes, tried, known, component))
                waiting = np.setdiff1d(waiting, found[-1][0])
                if not len(waiting) or len(nodes) <= tried:
                    break
        if len(zones):
            served = np.concatenate([node[met[component[other]]] for node, other, _ in found])
            found += look.legs_round(np.setdiff1d(left, served), known, component)
        return cls(*(np.concatenate(column) for column in zip(*found, strict=True)))


@dataclass(frozen=True, eq=False)
class _Look:
    """For nodes that are near to other nodes."""

    graph: InspectionGraph
    zones: ZoneIndex
    rules: AccessRules
    point: FloatArray

    def near(self, nodes: IntArray, others: IntArray) -> IntArray:
        """Those of the nodes that lie within a leg of the box around the others."""
        within = chord(float(self.rules.access_leg_m))
        low, high = self.point[others].min(axis=0) - within, self.point[others].max(axis=0) + within
        kept: IntArray = nodes[((self.point[nodes] >= low) & (self.point[nodes] <= high)).all(axis=1)]
        return kept

    def legs(
        self, nodes: IntArray, others: IntArray, count: int, known: BoolArray, component: NDArray[np.int32]
    ) -> tuple[IntArray, IntArray, FloatArray]:
        """Clear legs from each node to those of the others nearest to it that are on a part which counts."""
        if not len(nodes):
            return nodes, nodes, np.zeros(0)
        tree = cKDTree(self.point[others], balanced_tree=False, compact_nodes=False)
        within = chord(float(self.rules.access_leg_m))
        _, near = tree.query(self.point[nodes], k=min(count, len(others)), distance_upper_bound=within)
        near = near.reshape(len(nodes), -1)
        row, column = np.nonzero(near < len(others))
        node, other = nodes[row], others[near[row, column]]
        counts = known[component[other]]
        node, other = node[counts], other[counts]
        position = self.graph.position
        length_m = distance_m(position[node], position[other])
        kept = length_m <= self.rules.access_leg_m
        if len(self.zones):
            kept &= ~self._meets(node, other)
        return node[kept], other[kept], length_m[kept]

    def _meets(self, node: IntArray, other: IntArray) -> BoolArray:
        position, clearance_m, heights = self.graph.position, self.rules.zone_clearance_m, self.rules.heights
        if heights is None:
            return self.zones.meets(position[node], position[other], clearance_m)
        low_m, high_m = heights.band_m(asset_heights_m(self.graph.node_kind, self.graph.node_height_m))
        low_m, high_m = np.minimum(low_m[node], low_m[other]), np.maximum(high_m[node], high_m[other])
        return self.zones.meets(position[node], position[other], clearance_m, low_m, high_m)

    def legs_round(self, nodes: IntArray, known: BoolArray, component: NDArray[np.int32]) -> list[tuple[IntArray, IntArray, FloatArray]]:
        """What a plan would find for each of the nodes, of no more than some: legs round zones are looked for one by one."""
        found = []
        for node in nodes[:MAX_ROUND].tolist():
            place = Terminal(LonLat(*self.graph.position[node].tolist()))
            legs = access_legs(self.graph, self.zones, place, self.rules)
            counts = known[component[legs.node]]
            other = legs.node[counts].astype(np.int64)
            found.append((np.full(len(other), node, dtype=np.int64), other, legs.length_m[counts]))
        return found


@dataclass(frozen=True, eq=False)
class _Paths:
    """Between each node and the place, of some, that is nearest to it by cost.

    cost, length_m (n,), inf where there is no way; taken (n, 2, 2): from the place to the node and back, seconds and joules.
    """

    cost: FloatArray
    length_m: FloatArray
    taken: FloatArray | None


@dataclass(frozen=True, eq=False)
class _Scene:
    graph: InspectionGraph
    zones: ZoneIndex
    rules: AccessRules
    islands: _Islands
    at_core: CoreGraph
    conditions: Conditions
    flight_rules: FlightRules

    def ways(self, places: Sequence[LonLat], legs: Sequence[Attachments], flying: FlightClass | None) -> _Paths:
        """legs are those of each place."""
        all_legs = joined(list(legs))
        graph, islands = self.graph, self.islands
        if flying is None:
            found = search_from(graph, all_legs, self.at_core)
            ways = _Paths(found.cost, found.length_m, None)
        else:
            kept = self._taken(flying)
            start = np.repeat(np.array(places, dtype=np.float64).reshape(-1, 2), [len(some) for some in legs], axis=0)
            leg_taken = self._legs_taken(start, all_legs.node, all_legs.length_m, flying)
            found = search_from(graph, all_legs, self.at_core, place_sum=kept.sums.place, leg_taken=leg_taken)
            ways = _Paths(found.cost, found.length_m, found.taken)
        if len(islands.node):
            over_cost = self.rules.off_network_factor * islands.length_m + ways.cost[islands.other]
            order = np.lexsort((over_cost, islands.node))
            first = order[np.unique(islands.node[order], return_index=True)[1]]
            first = first[over_cost[first] < ways.cost[islands.node[first]]]
            over, onto = islands.node[first], islands.other[first]
            ways.cost[over], ways.length_m[over] = over_cost[first], islands.length_m[first] + ways.length_m[onto]
            if ways.taken is not None and flying is not None:
                passed_m = self._taken(flying).passed_m
                position = graph.position
                last = both_directions(
                    position[onto], passed_m[onto], position[over], passed_m[over], islands.length_m[first], self._taken(flying).air
                )
                ways.taken[over] = ways.taken[onto] + last
        for place in places:
            self._straight(place, ways, flying)
        return ways

    def needed_wh(self, there: _Paths, back: _Paths | None, one: PossibleFlight) -> FloatArray:
        """Of the battery, from take-off to the end; inf where the wind is too strong, or there is no way; 0 where nothing is counted."""
        if there.taken is None or one.flying is None:
            return np.where(np.isfinite(there.length_m), 0.0, np.inf)
        done, columns = self._at_nodes(one.flying)
        taken = there.taken[:, 0] + columns[TAKE_OFF] + done[:, DONE]
        is_open = ~np.isfinite(there.length_m)
        if back is not None and back.taken is not None:
            taken = taken + done[:, UP] + back.taken[:, 1]
            is_open |= ~np.isfinite(back.length_m)
            if one.lands:
                taken = taken + columns[LANDING]
        elif one.lands:
            taken = taken + done[:, LANDING_THERE]
        needed_wh: FloatArray = np.where(is_open | (taken >= NO_HEADWAY / 2.0).any(axis=1), np.inf, taken[:, 1] / J_PER_WH)
        return needed_wh

    def _taken(self, flying: FlightClass) -> GraphTaken:
        return graph_taken(self.graph, flying, self.conditions, self.flight_rules, None)

    def _at_nodes(self, flying: FlightClass) -> tuple[FloatArray, FloatArray]:
        heights_m = asset_heights_m(self.graph.node_kind, self.graph.node_height_m)
        level_m = np.where(heights_m > 0, heights_m + self.flight_rules.clearance_m, self.flight_rules.transit_agl_m)
        photo = np.isin(self.graph.node_kind, (NodeKind.SUPPORT, NodeKind.BRIDGE))
        hold_s = np.where(photo, DEFAULT_HOLD_S[TaskKind.PHOTO], DEFAULT_HOLD_S[TaskKind.LOOK])
        return at_nodes(level_m, self.flight_rules.transit_agl_m, hold_s, self._taken(flying).air)

    def _legs_taken(self, start: FloatArray, node: NDArray[np.integer], length_m: FloatArray, flying: FlightClass) -> FloatArray:
        """Of legs from places (k, 2), at transit height, to nodes: (k, 2, 2)."""
        kept = self._taken(flying)
        transit_m = np.full(len(start), self.flight_rules.transit_agl_m)
        return np.minimum(both_directions(start, transit_m, self.graph.position[node], kept.passed_m[node], length_m, kept.air), NO_HEADWAY)

    def _straight(self, place: LonLat, ways: _Paths, flying: FlightClass | None) -> None:
        """Nodes that are flown to straight, where that costs no more."""
        position, rules, cost = self.graph.position, self.rules, ways.cost
        frame = LocalFrame.around(place.lon, place.lat)
        within = np.flatnonzero(np.abs(position[:, 1] - place.lat) * frame.metres_per_degree_north <= 1.02 * rules.direct_leg_m)
        east, north = frame.to_metres(position[within]).T
        rough_m = np.hypot(east, north)
        within = within[(rough_m <= 1.02 * rules.direct_leg_m) & (0.98 * rules.off_network_factor * rough_m <= cost[within])]
        if not len(within):
            return
        straight_m = distance_m(np.broadcast_to(np.array(place), (len(within), 2)), position[within])
        better = (straight_m <= rules.direct_leg_m) & (rules.off_network_factor * straight_m <= cost[within])
        within, straight_m = within[better], straight_m[better]
        if len(within) and len(self.zones):
            clear = ~self.zones.meets(
                [place], position[within], rules.zone_clearance_m, *band_of_legs(self.graph, within, rules.heights, 0.0)
            )
            self._round(place, within[~clear & np.isinf(cost[within])], ways, flying)
            within, straight_m = within[clear], straight_m[clear]
        self._put(place, within, straight_m, rules.off_network_factor * straight_m, ways, flying)

    def _put(
        self, place: LonLat, nodes: IntArray, length_m: FloatArray, cost: FloatArray, ways: _Paths, flying: FlightClass | None
    ) -> None:
        ways.cost[nodes], ways.length_m[nodes] = cost, length_m
        if ways.taken is not None and flying is not None:
            start = np.broadcast_to(np.array(place), (len(nodes), 2)).copy()
            ways.taken[nodes] = self._legs_taken(start, nodes, length_m, flying)

    def _round(self, place: LonLat, nodes: IntArray, ways: _Paths, flying: FlightClass | None) -> None:
        """Nodes that nothing else reaches, round the zones that stand before them."""
        for node in nodes[:MAX_ROUND].tolist():
            target = Terminal(LonLat(*self.graph.position[node].tolist()))
            for leg in direct_legs([Terminal(place)], [target], self.zones, self.rules):
                self._put(place, np.array([node]), np.array([leg.length_m]), np.array([leg.cost]), ways, flying)
