"""Writes of map data, called by other apps, commands and tasks."""

from inspection.importers.rows import AssetFileError
from inspection.importers.terrain.raster import TerrainFileError
from inspection.importers.zones.zone_file import ZoneFileError
from inspection.services.curation import StaleRevision, WrongGeometry, delete_asset, delete_zone, geometry_fault, save_asset, save_zone
from inspection.services.data_issues import find_issues
from inspection.services.graph import build_graph, refresh_graph
from inspection.services.ground import mark_ground_changed
from inspection.services.imports.assets import UnfinishedMapping, import_assets
from inspection.services.imports.osm import import_osm
from inspection.services.imports.terrain import import_terrain
from inspection.services.imports.zones import import_zones

__all__ = [
    "AssetFileError",
    "StaleRevision",
    "TerrainFileError",
    "UnfinishedMapping",
    "WrongGeometry",
    "ZoneFileError",
    "build_graph",
    "delete_asset",
    "delete_zone",
    "find_issues",
    "geometry_fault",
    "import_assets",
    "import_osm",
    "import_terrain",
    "import_zones",
    "mark_ground_changed",
    "refresh_graph",
    "save_asset",
    "save_zone",
]
