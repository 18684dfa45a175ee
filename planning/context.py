"""Everything that a plan is made from, as one value: the map, the rules, the targets on the ground, the fleet, other flights."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from inspection.geodesy import LonLat
from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex
from inspection.terrain.profile import profile_under
from inspection.terrain.tiled_terrain import TiledTerrain
from inspection.zones.reach import BoolArray, ZoneTable
from inspection.zones.schedule import ZoneRules
from operation.reasons import Reason
from planning.clearance.zone_clearance import Margins
from planning.rules import FlightRules, RoutingRules, SeparationRules
from planning.separation.separation import TimedRoute
from planning.task import Task
from planning.trajectory.heights import FloatArray, GroundHeights, GroundModel
from planning.views.photo_flight import PhotoFlight

Box = tuple[float, float, float, float]

CLEARANCE_KEPT = 0.99  # routes keep their clearance; what they come short of it by is rounding


@dataclass(frozen=True)
class PlanningRules:
    """All limits of the settings that a plan keeps."""

    linking: LinkingRules
    routing: RoutingRules
    flight: FlightRules
    zones: ZoneRules
    heights: FlownHeights  # what flights have over the network: follows from flight and zones
    separation: SeparationRules

    @property
    def margins(self) -> Margins:
        """What finished routes keep from zones."""
        return Margins(
            lateral_m=CLEARANCE_KEPT * self.linking.zone_clearance_m,
            height_m=self.zones.height_margin_m,
            time_s=self.zones.time_margin_s,
            terrain_tolerance_m=self.flight.terrain_tolerance_m,
        )


@dataclass(frozen=True)
class ResolvedTarget:
    """A target of the request on the ground; `target` is its place in the request.

    `course` has one position for a point and the vertices in the line's direction for a stretch. photos: the flight through the photos of
    a task with views; no_photos: why there is none.
    """

    target: int
    course: tuple[LonLat, ...]
    task: Task
    height_m: float
    asset: int | None = None
    kind: str | None = None
    photos: PhotoFlight | None = None
    no_photos: Reason | None = None

    @property
    def stays_s(self) -> float:
        """How long a UAV is at the target, flown along a stretch not counted."""
        return self.task.hold_s if self.photos is None else self.photos.seconds

    @property
    def is_stretch(self) -> bool:
        return len(self.course) > 1


@dataclass(frozen=True)
class OtherFlights:
    """Routes of other missions, and those of which nobody knows when they are where: mission and UAV."""

    routes: tuple[TimedRoute, ...] = ()
    untimed: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Terrain:
    """The terrain models. heights_m: of positions (n, 2), lon lat [deg]; of_nodes_m: of all nodes of a graph. Both above sea level [m],
    NaN where no model reaches. around: the tiles that touch west, south, east, north [deg]."""

    heights_m: GroundHeights
    of_nodes_m: Callable[[InspectionGraph], FloatArray]
    around: Callable[[Box], TiledTerrain]

    @property
    def ground(self) -> GroundModel:
        return GroundModel(self.heights_m, lambda start, end: profile_under(start, end, self.around))


def _no_other_flights(window_s: float) -> OtherFlights:
    return OtherFlights()


@dataclass(frozen=True, eq=False)
class PlanningContext:
    """network: free of zones; zones: all of them, whenever they are in force. terrain: None without a terrain model.

    cleared: the network cleared of zones at the heights flown; zone_index: all zones, or those of a mask (z,). Both may keep what they
    have made. targets: those of the request that are still there, deleted_targets the others, by their places in it.

    out_of_service: of stored UAVs by key the state ("retired", "maintenance", "without_type", "without_range"); in_air: the keys of those
    reported to fly. other_flights: those in the air within so many seconds of the departure. graph_version: of the network; map_version: of
    assets and zones together.
    """

    rules: PlanningRules
    network: Network
    zones: ZoneTable
    cleared: Callable[[ZoneIndex], InspectionGraph]
    zone_index: Callable[[BoolArray | None], ZoneIndex]
    terrain: Terrain | None
    graph_version: int
    map_version: int
    targets: Sequence[ResolvedTarget]
    deleted_targets: Sequence[int] = ()
    out_of_service: Mapping[int, str] = field(default_factory=dict)
    in_air: frozenset[int] = frozenset()
    other_flights: Callable[[float], OtherFlights] = _no_other_flights

    @property
    def ground(self) -> GroundModel | None:
        """The terrain under routes; None without a model."""
        return None if self.terrain is None else self.terrain.ground

    @property
    def heights_m(self) -> GroundHeights | None:
        """Heights of the terrain; None without a model."""
        return None if self.terrain is None else self.terrain.heights_m
