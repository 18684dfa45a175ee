"""A synthetic region as an .osm.pbf file: the same region gives the same bytes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import osmium

from inspection.demo_region.place import HALF_HEIGHT_M, HALF_WIDTH_M, FloatArray, Point, lon_lat
from inspection.geodesy import LonLat

# OSM counts its ids upward and had reached about 1.4e10 for nodes in 2026. Synthetic objects start far above, so that they never collide
# with a real id, and stay below 2**53, the limit of JavaScript's integers.
FIRST_ID = 4_000_000_000_000

Tags = Mapping[str, str]


@dataclass(frozen=True)
class OsmNode:
    id: int
    position: LonLat
    tags: Tags


@dataclass(frozen=True)
class OsmWay:
    id: int
    node_ids: tuple[int, ...]
    tags: Tags


@dataclass
class OsmDrawing:
    """Collects nodes and ways and numbers them in the order in which they are drawn.

    Points are east and north [m] of `centre`, which itself is east and north [m] of the centre of Elme Valley.
    """

    centre: Point = (0.0, 0.0)
    half_size_m: Point = (HALF_WIDTH_M, HALF_HEIGHT_M)
    first_id: int = FIRST_ID
    nodes: list[OsmNode] = field(default_factory=list)
    ways: list[OsmWay] = field(default_factory=list)

    def position(self, east_m: float, north_m: float) -> LonLat:
        return lon_lat(self.centre[0] + east_m, self.centre[1] + north_m)

    def corners(self) -> tuple[LonLat, LonLat]:
        """Return the south-west and the north-east corner of the region's box."""
        east_m, north_m = self.half_size_m
        return self.position(-east_m, -north_m), self.position(east_m, north_m)

    def add_node(self, at: Sequence[float] | FloatArray, tags: Tags | None = None) -> int:
        node = OsmNode(self.first_id + len(self.nodes), self.position(float(at[0]), float(at[1])), dict(tags or {}))
        self.nodes.append(node)
        return node.id

    def add_way(self, node_ids: Iterable[int], tags: Tags) -> int:
        way = OsmWay(self.first_id + len(self.ways), tuple(node_ids), dict(tags))
        self.ways.append(way)
        return way.id

    def add_path(self, path: Iterable[FloatArray], tags: Tags) -> int:
        return self.add_way([self.add_node(point) for point in path], tags)

    def add_area(self, ring: Iterable[FloatArray], tags: Tags) -> int:
        """Add a closed way and return its id; the ring has no repeated last point."""
        node_ids = [self.add_node(point) for point in ring]
        return self.add_way([*node_ids, node_ids[0]], tags)


GENERATOR = "Spanwise synthetic demo region"
TIMESTAMP = "2026-01-01T00:00:00Z"  # fixed, or two files of one region would differ


def write_osm_file(path: Path, drawing: OsmDrawing) -> None:
    """Write nodes, then ways, each by ascending id, as OSM's own extracts do; an existing file is replaced."""
    header = osmium.io.Header()
    header.set("generator", GENERATOR)
    header.set("osmosis_replication_timestamp", TIMESTAMP)
    header.add_box(osmium.osm.Box(*(osmium.osm.Location(*corner) for corner in drawing.corners())))
    with osmium.SimpleWriter(str(path), header=header, overwrite=True) as writer:
        for node in drawing.nodes:
            writer.add_node(
                osmium.osm.mutable.Node(
                    id=node.id, version=1, visible=True, timestamp=TIMESTAMP, location=node.position, tags=dict(node.tags)
                )
            )
        for way in drawing.ways:
            writer.add_way(
                osmium.osm.mutable.Way(
                    id=way.id, version=1, visible=True, timestamp=TIMESTAMP, nodes=list(way.node_ids), tags=dict(way.tags)
                )
            )
