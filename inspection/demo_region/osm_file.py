"""A made region as an .osm.pbf file: the same region gives the same bytes."""

from pathlib import Path

import osmium

from inspection.demo_region.osm_objects import OsmDrawing

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
