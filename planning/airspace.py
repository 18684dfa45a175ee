"""The zones that a plan keeps clear of, and the network cleared of them."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from inspection.geodesy import LonLat
from inspection.network.build.flyable import flyable_part
from inspection.network.build.network import Network
from inspection.network.build.obstacles import WALL, too_tall_obstacles, with_obstacles
from inspection.network.export import by_length
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.zones.zone_index import ZoneIndex
from inspection.zones.reach import BoolArray, ZoneTable
from operation.reasons import Reason
from planning.connection_points import AccessRules
from planning.context import Box, PlanningContext
from planning.rules import FlightRules

NEAR_SHARE = 0.5  # of what a plan extends over, on each side; paths lead farther round only where nothing nearer is left
NEAR_DEG = 0.15  # some 15 km


@dataclass(frozen=True, eq=False)
class ZoneChoice:
    """widest, narrowest (z,): the zones that are in force at any moment of the flight, and those that are so all the time.

    Zones that do not reach the heights of a flight are in both: they bar nothing.
    """

    table: ZoneTable
    widest: BoolArray
    narrowest: BoolArray

    @property
    def changes(self) -> bool:
        """Whether a zone comes into force, or goes out of it, while the plan is flown."""
        return bool((self.widest != self.narrowest).any())

    def with_zones(self, chosen: BoolArray, ids: Collection[int]) -> BoolArray:
        """The mask, and the zones with these primary keys."""
        mask: BoolArray = chosen | np.isin(self.table.ids, list(ids))
        return mask


def zone_choice(
    table: ZoneTable, departs_at: datetime | None, flight: FlightRules, positions: Sequence[LonLat] | None = None
) -> ZoneChoice:
    """Without a departure every zone counts as in force at any time; with positions, so does a zone far from all of them.

    A network that is cleared of one more zone far away is most often there already, for others, or for another departure.
    """
    if departs_at is None:
        always = np.ones(len(table), dtype=bool)
        return ZoneChoice(table, always, always)
    from_s = departs_at.timestamp()
    to_s = from_s + flight.longest_flight_s
    no_matter = ~table.reaching(0.0, flight.max_agl_m)
    if positions is not None:
        no_matter |= ~near_positions(table, positions)
    some = ~no_matter
    widest, narrowest = no_matter.copy(), no_matter.copy()
    asked = table.only(some)
    widest[some] = asked.active_within(from_s, to_s)
    narrowest[some] = asked.active_throughout(from_s, to_s)
    return ZoneChoice(table, widest, narrowest)


def near_positions(table: ZoneTable, positions: Sequence[LonLat]) -> BoolArray:
    """Which zones come near the box of the positions, (z,)."""
    west, south, east, north = box_near(positions)
    box = table.box
    near: BoolArray = (box[:, 0] <= east) & (box[:, 2] >= west) & (box[:, 1] <= north) & (box[:, 3] >= south)
    return near


def box_near(positions: Sequence[LonLat]) -> Box:
    """Return west, south, east, north [deg] of what counts as near the positions."""
    at = np.array(positions, dtype=np.float64).reshape(-1, 2)
    low, high = at.min(axis=0), at.max(axis=0)
    about = np.maximum(NEAR_SHARE * (high - low), NEAR_DEG)
    (west, south), (east, north) = (low - about).tolist(), (high + about).tolist()
    return west, south, east, north


@dataclass(frozen=True, eq=False)
class Airspace:
    """The network of a context cleared of some zones. `graph` is the part of `whole_graph` that can be flown over.

    `zones` are all that are kept clear of, `leg_zones` those of them that reach the heights between targets; both with what is too tall
    to be flown over. is_by_length: the shortest paths are the best, near infrastructure or not.
    """

    context: PlanningContext
    whole_graph: InspectionGraph
    graph: InspectionGraph
    zones: ZoneIndex
    leg_zones: ZoneIndex
    access: AccessRules
    is_by_length: bool = False

    @property
    def network(self) -> Network:
        return self.context.network

    @property
    def flight(self) -> FlightRules:
        return self.context.rules.flight


def airspace_on(
    context: PlanningContext, chosen: BoolArray | None, obstacles: ZoneIndex | None = None, *, is_by_length: bool = False
) -> Airspace:
    """Return the airspace with all zones, or with those where the mask (z,) is true.

    What cannot be flown over is kept clear of like a zone; `obstacles` is what candidate plans have shown to be so. With is_by_length
    the shortest paths are the best, near infrastructure or not.
    """
    rules, flight = context.rules, context.rules.flight
    access = AccessRules(
        access_leg_m=rules.routing.access_leg_m,
        direct_leg_m=rules.routing.direct_leg_m,
        on_asset_m=rules.linking.railway_spacing_m,
        off_network_factor=1.0 if is_by_length else rules.linking.off_network_factor,
        zone_clearance_m=rules.linking.zone_clearance_m,
    )
    zones = context.zone_index(chosen)
    walls = too_tall_obstacles(context.network, rules.heights)
    graph = context.cleared(zones if obstacles is None else with_obstacles(zones, obstacles))
    graph = by_length(graph) if is_by_length else graph
    walls = walls if obstacles is None else with_obstacles(walls, obstacles)
    in_transit = context.zones.reaching(flight.transit_agl_m - flight.terrain_tolerance_m, flight.max_agl_m + flight.terrain_tolerance_m)
    leg_zones = with_obstacles(context.zone_index(in_transit if chosen is None else chosen & in_transit), walls)
    flyable = flyable_part(graph, flight.tallest_m)
    return Airspace(context, graph, flyable, with_obstacles(zones, walls), leg_zones, access, is_by_length)


@dataclass(frozen=True)
class NamedZone:
    """A zone with its name as stated, or what stands for one; then there is no id."""

    name: str | Reason
    id: int | None = None

    @property
    def params(self) -> dict[str, object]:
        """Return the params with which a reason names it."""
        return {"zone": self.name} if self.id is None else {"zone": self.name, "zone_id": self.id}


def zone_at(position: LonLat, airspace: Airspace, agl_m: float = 0.0) -> NamedZone | None:
    """Return the zone that holds the position between this height above ground and that of the flight to it.

    A place nearer to a zone than the clearance counts as inside it.
    """
    zones, clearance_m = airspace.zones, airspace.access.zone_clearance_m
    if not len(zones):
        return None
    low_m, high_m = column_m(agl_m, airspace)
    if not zones.contains([position], clearance_m, low_m, high_m)[0]:
        return None
    found = zones.zone_at(position, low_m, high_m)
    return named_zone(*found) if found else _margin(airspace)


def zone_along(course: Sequence[LonLat], agl_m: tuple[float, float], airspace: Airspace) -> NamedZone | None:
    """Return the first zone that a course meets at the heights, from and to, of its inspection and of the flight to it."""
    line = np.array(course)
    low_m, high_m = column_m(agl_m[0], airspace)[0], column_m(agl_m[1], airspace)[1]
    met = np.flatnonzero(airspace.zones.meets(line[:-1], line[1:], airspace.access.zone_clearance_m, low_m, high_m))
    if not len(met):
        return None
    for leg in met.tolist():
        found = airspace.zones.first_met(course[leg], course[leg + 1], low_m, high_m)
        if found is not None:
            return named_zone(*found)
    return _margin(airspace)


def named_zone(key: int, name: str) -> NamedZone:
    """Return a zone as an index describes it."""
    return NamedZone(Reason("obstacle_margin")) if name == WALL else NamedZone(name, key)


def _margin(airspace: Airspace) -> NamedZone:
    return NamedZone(Reason("zone_margin", {"margin_m": airspace.access.zone_clearance_m}))


def column_m(agl_m: float, airspace: Airspace) -> tuple[float, float]:
    """From this height to that of the flight to it, with all that a height may stray and that is kept from a zone's limits."""
    heights = airspace.context.rules.heights
    return min(agl_m, airspace.flight.transit_agl_m) - heights.below_m, max(agl_m, airspace.flight.transit_agl_m) + heights.above_m
