"""Quillmoor: a second made region, small and mapped as real regions are, with what Elme Valley is too tidy to have.

It lies in the same desert, 60 km west of Elme Valley. It is clipped to its box as `osmium extract --strategy=simple` does it: nodes
beyond the box are not in the file, and ways keep their references to them.
"""

from dataclasses import replace

import numpy as np

from inspection.demo_region.osm_objects import FIRST_ID, OsmDrawing
from inspection.demo_region.place import DEFAULT_SEED, Point
from inspection.demo_region.quillmoor_power import draw_power
from inspection.demo_region.quillmoor_transport import draw_transport

QUILLMOOR_NAME = "Quillmoor"
QUILLMOOR_CENTRE: Point = (-60_000.0, 0.0)  # east and north [m] of the centre of Elme Valley
QUILLMOOR_HALF_SIZE_M: Point = (12_000.0, 8_000.0)
QUILLMOOR_FIRST_ID = FIRST_ID + 1_000_000_000  # both regions can be in one database


def make_quillmoor(seed: int = DEFAULT_SEED) -> OsmDrawing:
    """Return the nodes and ways of Quillmoor; the seed moves supports along their lines and chooses those that are not tagged."""
    drawing = OsmDrawing(QUILLMOOR_CENTRE, QUILLMOOR_HALF_SIZE_M, QUILLMOOR_FIRST_ID)
    draw_power(drawing, np.random.default_rng(seed))
    draw_transport(drawing)
    return _clipped(drawing)


def _clipped(drawing: OsmDrawing) -> OsmDrawing:
    """Return the nodes inside the box and the ways that have at least one of them."""
    (west, south), (east, north) = drawing.corners()
    nodes = [node for node in drawing.nodes if west <= node.position.lon <= east and south <= node.position.lat <= north]
    inside = {node.id for node in nodes}
    return replace(drawing, nodes=nodes, ways=[way for way in drawing.ways if not inside.isdisjoint(way.node_ids)])
