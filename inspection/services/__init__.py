"""Writes of the ground: what the other apps, commands and tasks call."""

from inspection.services.curation import WrongGeometry, delete_asset, delete_zone, geometry_fault, save_asset, save_zone
from inspection.services.graph import build_graph, refresh_graph
from inspection.services.ground import mark_ground_changed
from inspection.services.osm_import import import_osm

__all__ = [
    "WrongGeometry",
    "build_graph",
    "delete_asset",
    "delete_zone",
    "geometry_fault",
    "import_osm",
    "mark_ground_changed",
    "refresh_graph",
    "save_asset",
    "save_zone",
]
