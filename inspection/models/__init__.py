"""Models of map data, their sources, and the graph made of them."""

from inspection.models.assets import Asset, AssetKind, AssetReference, AssetSet, Bridge, OsmType, PowerLine, PowerTower, Railway
from inspection.models.data_issues import DataIssue, DataIssueKind, DataIssueSearch, DataIssueState
from inspection.models.graph import GraphSnapshot, Ground, TerrainTile
from inspection.models.imports import (
    MAX_REMOVED_PERCENT,
    ROW_ACTIONS,
    ChangeAction,
    DataImport,
    ImportKind,
    ImportProposal,
    ProposalOrigin,
    ProposalState,
    ProposedChange,
    Upload,
    UploadPart,
)
from inspection.models.regions import Region
from inspection.models.zones import HeightReference, NoFlyZone, ZoneSet, ZoneSetVersion, ZoneSubscription

__all__ = [
    "MAX_REMOVED_PERCENT",
    "ROW_ACTIONS",
    "Asset",
    "AssetKind",
    "AssetReference",
    "AssetSet",
    "Bridge",
    "ChangeAction",
    "DataImport",
    "DataIssue",
    "DataIssueKind",
    "DataIssueSearch",
    "DataIssueState",
    "GraphSnapshot",
    "Ground",
    "HeightReference",
    "ImportKind",
    "ImportProposal",
    "NoFlyZone",
    "OsmType",
    "PowerLine",
    "PowerTower",
    "ProposalOrigin",
    "ProposalState",
    "ProposedChange",
    "Railway",
    "Region",
    "TerrainTile",
    "Upload",
    "UploadPart",
    "ZoneSet",
    "ZoneSetVersion",
    "ZoneSubscription",
]
