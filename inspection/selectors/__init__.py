"""Reads of map data for views, commands and other apps."""

from inspection.selectors.asset_names import asset_detail, asset_label, label_now, part_label, voltage_text
from inspection.selectors.assets import (
    UNREAD_OF_A_LINE,
    Box,
    asset_with_geometry,
    assets_near,
    assets_on_the_ground,
    references_of,
    with_external_id,
    zones,
)
from inspection.selectors.graph import NoGraph, current_graph, graph_of_version, zones_in_force
from inspection.selectors.ground import GroundSummary, ground_dataset_version, ground_extent, ground_revision, ground_summary
from inspection.selectors.terrain import ground_heights_m, has_terrain, terrain_dataset_version
from inspection.selectors.tiles import RECIPE as TILE_RECIPE
from inspection.selectors.tiles import NoSuchTile, map_data, tile_of_version, tiles_version, vector_tile

__all__ = [
    "TILE_RECIPE",
    "UNREAD_OF_A_LINE",
    "Box",
    "GroundSummary",
    "NoGraph",
    "NoSuchTile",
    "asset_detail",
    "asset_label",
    "asset_with_geometry",
    "assets_near",
    "assets_on_the_ground",
    "current_graph",
    "graph_of_version",
    "ground_dataset_version",
    "ground_extent",
    "ground_heights_m",
    "ground_revision",
    "ground_summary",
    "has_terrain",
    "label_now",
    "map_data",
    "part_label",
    "references_of",
    "terrain_dataset_version",
    "tile_of_version",
    "tiles_version",
    "vector_tile",
    "voltage_text",
    "with_external_id",
    "zones",
    "zones_in_force",
]
