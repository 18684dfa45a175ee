"""Where UAVs and targets meet the network, and the ways between all of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame
from inspection.geodesy.wgs84 import short_distance_m
from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import NO_LEGS, Attachments, DirectLeg, joined
from inspection.network.nearness import chord
from inspection.network.paths.access import MAX_ROUND, LegRules, band_of_legs, clear_legs
from inspection.network.paths.node_tree import points_on_sphere
from inspection.network.paths.paths import Travel, travel_between_places
from inspection.network.route_index import asset_places, node_tree
from inspection.network.rules import FlownHeights
from inspection.network.zones.zone_detours import Errand, ways_round
from inspection.network.zones.zone_index import ZoneIndex
from planning.problem import End

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


ON_SPAN_DEG = 1e-6  # a tenth of a metre: places on a span are rounded
END_SHARE = 0.01  # of a span at each end, where the wire hangs as high as its support
_NO_WAY_TO_GO = np.zeros(1)  # metres from a place to its own node


@dataclass(frozen=True)
class Terminal:
    """One end of a visit, or a UAV's start. `asset` is the asset that it lies on, if any; height_m its height, None if not known."""

    position: LonLat
    asset: int | None = None
    height_m: float | None = None

    @property
    def known_height_m(self) -> float | None:
        """Where there is no asset there is nothing to be flown over."""
        return 0.0 if self.asset is None else self.height_m


@dataclass(frozen=True)
class AccessRules:
    """Metres, and the cost of a metre flown away from infrastructure."""

    access_leg_m: float
    direct_leg_m: float
    on_asset_m: float  # how far a place on a line or railway may lie from the graph's edge: the spacing of thinned vertices
    off_network_factor: float
    zone_clearance_m: float
    heights: FlownHeights | None = None  # without them zones count at all heights


def attachments(graph: InspectionGraph, zones: ZoneIndex, terminal: Terminal, rules: AccessRules) -> Attachments:
    """How a terminal meets the network: at its own node, along its own line, else over access legs that are clear of zones."""
    if terminal.asset is not None:
        places = asset_places(graph)
        node = places.node_of(terminal.asset)
        if node is not None and graph.position[node].tolist() == [*terminal.position]:
            return Attachments(np.array([node], dtype=np.int32), _NO_WAY_TO_GO, _NO_WAY_TO_GO)
        along = _along_own_line(graph, zones, terminal, places.edges_of(terminal.asset), rules)
        if len(along):
            return along
    return access_legs(graph, zones, terminal, rules)


def access_legs(graph: InspectionGraph, zones: ZoneIndex, terminal: Terminal, rules: AccessRules) -> Attachments:
    """Legs that are clear of zones, and the nearest places behind zones round these."""
    leg_rules = LegRules(rules.access_leg_m, rules.off_network_factor, rules.zone_clearance_m, rules.heights)
    return clear_legs(graph, zones, terminal.position, leg_rules, height_m=terminal.known_height_m)


def is_near_network(graph: InspectionGraph, position: LonLat, radius_m: float) -> bool:
    """Whether any node lies within the radius, zones or not."""
    nearest = node_tree(graph).nearest(position, 1)
    return bool(len(nearest)) and float(distance_m(graph.position[nearest], np.array([position]))[0]) <= radius_m


def _along_own_line(
    graph: InspectionGraph, zones: ZoneIndex, terminal: Terminal, edges: NDArray[np.int64], rules: AccessRules
) -> Attachments:
    """Legs to both ends of the asset's edge nearest to the position; flown along the asset, they cost what they measure."""
    if not len(edges):
        return NO_LEGS
    position = terminal.position
    frame = LocalFrame.around(position.lon, position.lat)
    tail, head = frame.to_metres(graph.position[graph.edge[edges, 0]]), frame.to_metres(graph.position[graph.edge[edges, 1]])
    along = head - tail
    squared = (along**2).sum(axis=1)
    share = np.clip(-(tail * along).sum(axis=1) / np.where(squared > 0, squared, 1.0), 0.0, 1.0)
    gap_m = np.hypot(*(tail + share[:, None] * along).T)
    nearest = int(gap_m.argmin())
    if gap_m[nearest] > rules.on_asset_m:
        return NO_LEGS
    nodes = graph.edge[edges[nearest]]
    here = np.broadcast_to(np.array(position), (2, 2))
    length_m = distance_m(here, graph.position[nodes])
    low_m, high_m = band_of_legs(graph, nodes, rules.heights, terminal.known_height_m)
    clear = ~zones.meets(here, graph.position[nodes], rules.zone_clearance_m, low_m, high_m)
    if (length_m == 0).any():
        clear &= length_m == 0  # the place is a node
    return Attachments(nodes[clear], length_m[clear], length_m[clear])


def tallest_support_m(network: Network, asset: int, course: Sequence[LonLat]) -> float:
    """The greatest tagged height among the supports of the spans along which a line's stretch runs; 0 if none is tagged."""
    spans = network.edge[network.edge_asset == asset]
    if not len(spans):
        return 0.0
    flown = shapely.linestrings(np.array(course)) if len(course) > 1 else shapely.points(course[0])
    start, end = network.position[spans[:, 0]], network.position[spans[:, 1]]
    inner = np.stack([start + END_SHARE * (end - start), end + END_SHARE * (start - end)], axis=1)  # a stretch may end where one begins
    touched = shapely.distance(shapely.linestrings(inner), flown) <= ON_SPAN_DEG
    heights_m = network.node_height_m[np.unique(spans[touched])]
    return float(heights_m[heights_m > 0].max(initial=0.0))


def direct_legs(sources: Sequence[Terminal], sinks: Sequence[Terminal], zones: ZoneIndex, rules: AccessRules) -> list[DirectLeg]:
    """Legs from place to place, no longer than the rule allows: straight where that is clear of zones, else round these.

    Ways round are looked for to the MAX_ROUND nearest sinks that zones stand before.
    """
    start = np.array([place.position for place in sources], dtype=np.float64).reshape(-1, 2)
    end = np.array([place.position for place in sinks], dtype=np.float64).reshape(-1, 2)
    source, sink, length_m = _near_pairs(start, end, float(rules.direct_leg_m), chord(float(rules.direct_leg_m)))
    if not len(source):
        return []
    start_band, end_band = _bands(sources, rules), _bands(sinks, rules)
    low_m, high_m = np.minimum(start_band[source, 0], end_band[sink, 0]), np.maximum(start_band[source, 1], end_band[sink, 1])
    clear = ~zones.meets(start[source], end[sink], rules.zone_clearance_m, low_m, high_m)
    straight = [
        DirectLeg(*leg, leg[2] * rules.off_network_factor)
        for leg in zip(source[clear].tolist(), sink[clear].tolist(), length_m[clear].tolist(), strict=True)
    ]
    if clear.all():
        return straight
    behind = np.flatnonzero(~clear)
    behind = behind[np.lexsort((length_m[behind], source[behind]))]
    first_of_source = np.searchsorted(source[behind], source[behind])
    behind = behind[np.arange(len(behind)) - first_of_source < MAX_ROUND]
    groups = np.split(behind, np.flatnonzero(np.diff(source[behind])) + 1)
    errands = [
        Errand(
            np.concatenate([start[source[legs[:1]]], end[sink[legs]]]),
            np.column_stack([np.zeros(len(legs), dtype=np.int64), np.arange(1, len(legs) + 1)]),
            float(low_m[legs].min()),
            float(high_m[legs].max()),
        )
        for legs in groups
    ]
    found = ways_round(zones, errands, rules.zone_clearance_m, rules.direct_leg_m)
    bent = [
        DirectLeg(
            int(source[leg]), int(sink[leg]), way.length_m, way.length_m * rules.off_network_factor, tuple(map(tuple, way.bend.tolist()))
        )
        for legs, ways in zip(groups, found, strict=True)
        for leg, way in zip(legs, ways, strict=True)
        if way is not None
    ]
    return straight + bent


def _bands(places: Sequence[Terminal], rules: AccessRules) -> FloatArray:
    """Lowest and highest above ground at which each place is come to or left, (n, 2)."""
    if rules.heights is None:
        return np.tile([-np.inf, np.inf], (len(places), 1))
    height_m = np.array([place.known_height_m for place in places], dtype=np.float64)  # None becomes NaN
    low_m, high_m = rules.heights.band_m(np.nan_to_num(height_m))
    return np.column_stack([low_m, np.where(np.isnan(height_m), np.inf, high_m)])


@njit(cache=True, nogil=True)
def _near_pairs(start: FloatArray, end: FloatArray, longest_m: float, within: float) -> tuple[IntArray, IntArray, FloatArray]:
    """Pairs of a start and an end that lie no more than the longest leg apart, on one side of the antimeridian, and their metres.

    `within` is a chord on the unit sphere in which all of them lie.
    """
    left, right = points_on_sphere(start), points_on_sphere(end)
    source, sink = np.empty(16, dtype=np.int64), np.empty(16, dtype=np.int64)
    length_m = np.empty(16)
    pairs = 0
    for one in range(len(start)):
        for other in range(len(end)):
            gap_2 = (left[one, 0] - right[other, 0]) ** 2 + (left[one, 1] - right[other, 1]) ** 2 + (left[one, 2] - right[other, 2]) ** 2
            if gap_2 > within * within or abs(start[one, 0] - end[other, 0]) > 180.0:
                continue
            metres = short_distance_m(start[one, 0], start[one, 1], end[other, 0], end[other, 1])
            if metres > longest_m:
                continue
            if pairs == len(source):
                source, sink, length_m = np.append(source, source), np.append(sink, sink), np.append(length_m, length_m)
            source[pairs], sink[pairs], length_m[pairs] = one, other, metres
            pairs += 1
    return source[:pairs].copy(), sink[:pairs].copy(), length_m[:pairs].copy()


@dataclass(frozen=True, eq=False)
class TargetPaths:
    """Metres and paths between u starts and v visits, and on to the bases: the ends of each are terminals."""

    travel: Travel
    uavs: int
    visits: int
    uav_legs: tuple[Attachments, ...]  # how each start meets the network; none: not at all
    entry_legs: tuple[Attachments, ...]  # how each visit's entry does, and its exit
    exit_legs: tuple[Attachments, ...]
    bases: int = 0

    @property
    def from_start_m(self) -> FloatArray:
        return self.travel.length_m[: self.uavs, : self.visits]

    @property
    def between_m(self) -> FloatArray:
        return self.travel.length_m[self.uavs :, : self.visits]

    @property
    def to_start_m(self) -> FloatArray:
        return self.travel.length_m[self.uavs :, self.visits : self.visits + self.uavs]

    @cached_property
    def nearest_base(self) -> NDArray[np.int64]:
        """The base to which the way from each visit's end costs least, (v,); any where none can be reached."""
        cost = self.travel.cost[self.uavs :, self.visits + self.uavs :]
        return cost.argmin(axis=1) if self.bases else np.zeros(self.visits, dtype=np.int64)

    @cached_property
    def to_base_m(self) -> FloatArray:
        """Metres from each visit's end to its nearest base, (v,); inf where none can be reached."""
        if not self.bases:
            return np.full(self.visits, np.inf)
        to_base_m: FloatArray = self.travel.length_m[self.uavs + np.arange(self.visits), self.visits + self.uavs + self.nearest_base]
        return to_base_m

    def of_route(self, uav: int, order: Sequence[int], end: End) -> list[tuple[int, int]]:
        """Source and sink, in `travel`, of each way of a route of visits, which are some, and on to where it ends."""
        ways = [(uav, order[0]), *((self.uavs + left, right) for left, right in pairwise(order))]
        if end is End.RETURN:
            ways.append((self.uavs + order[-1], self.visits + uav))
        elif end is End.ANY_BASE:
            ways.append((self.uavs + order[-1], self.visits + self.uavs + int(self.nearest_base[order[-1]])))
        return ways

    def out(self, uav: int, visit: int) -> NDArray[np.int64]:
        return self.travel.path(uav, visit)

    def onward(self, left: int, right: int) -> NDArray[np.int64]:
        return self.travel.path(self.uavs + left, right)

    def home(self, visit: int, uav: int) -> NDArray[np.int64]:
        return self.travel.path(self.uavs + visit, self.visits + uav)

    def to_base(self, visit: int) -> NDArray[np.int64]:
        return self.travel.path(self.uavs + visit, self.visits + self.uavs + int(self.nearest_base[visit]))


def paths_between(
    graph: InspectionGraph,
    zones: ZoneIndex,
    starts: Sequence[Terminal],
    entries: Sequence[Terminal],
    exits: Sequence[Terminal],
    rules: AccessRules,
    bases: Sequence[Terminal] = (),
    homes: Sequence[Terminal] | None = None,
) -> TargetPaths:
    """Least-cost ways from starts and exits to entries, homes and bases. Who is not in the air already has its home at its start.

    A target on a part of the network that no UAV gets to, such as a line that stands alone, is given access legs of its own.
    """
    sources, sinks = [*starts, *exits], [*entries, *(starts if homes is None else homes), *bases]
    number: dict[Terminal, int] = {}
    source = [number.setdefault(place, len(number)) for place in sources]
    sink = [number.setdefault(place, len(number)) for place in sinks]
    legs = [attachments(graph, zones, place, rules) for place in number]
    direct = direct_legs(sources, sinks, zones, rules)
    found = travel_between_places(graph, legs, source, sink, direct)
    uavs, visits = len(starts), len(entries)
    cut_off = np.flatnonzero(np.isinf(found.length_m[:uavs, :visits]).all(axis=0)).tolist() if starts else []
    if cut_off:
        alone = {number[place]: place for visit in cut_off for place in (entries[visit], exits[visit])}
        for at, place in alone.items():
            legs[at] = joined([legs[at], access_legs(graph, zones, place, rules)])
        found = travel_between_places(graph, legs, source, sink, direct)
    return TargetPaths(
        found,
        uavs,
        visits,
        uav_legs=tuple(legs[place] for place in source[:uavs]),
        entry_legs=tuple(legs[place] for place in sink[:visits]),
        exit_legs=tuple(legs[place] for place in source[uavs:]),
        bases=len(bases),
    )
