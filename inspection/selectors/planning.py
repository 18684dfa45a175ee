"""What a plan stands on, read at once: the newest graph, the edition of the ground, and the assets that it visits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from typing import NamedTuple

from django.db import DEFAULT_DB_ALIAS

from inspection.geodesy import LonLat
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.snapshot_file import LAYOUT
from inspection.graph.zone_index import ZoneIndex
from inspection.models import Asset, AssetKind
from inspection.selectors.graph import SnapshotRow, graph_for, zones_of_edition
from inspection.selectors.terrain import has_terrain
from workspace.prepared import prepared_rows

_GROUND = "(SELECT revision, changed_at FROM inspection_ground ORDER BY id LIMIT 1)"
_EDITION = f"SELECT revision, changed_at FROM {_GROUND} AS ground"  # noqa: S608 - no value of anybody's
_SNAPSHOT = f"""(SELECT version, ground_revision, arrays_sha256 FROM inspection_graphsnapshot WHERE rules @> '{{"layout": {LAYOUT}}}'
    ORDER BY version DESC LIMIT 1)"""  # noqa: S608 - no value of anybody's
_POINT_COLUMNS = ("id", "kind", "subtype", "height_m", "max_voltage_v")
_ON_LINE = {"line_id", "place_on_line", "places_on_line"}
# What the name of a whole tower or bridge is made of; in the model's own order, in which `from_db` takes the values.
_NAMING = {
    "id",
    "kind",
    "subtype",
    "ref",
    "name",
    "operator",
    "max_voltage_v",
    "line_id",
    "place_on_line",
    "places_on_line",
    "osm_type",
    "osm_id",
}
_NAMING_COLUMNS = tuple(field.attname for field in Asset._meta.concrete_fields if field.attname in _NAMING)
_ASSET_COLUMNS = ", ".join(f"asset.{column}" for column in (*_POINT_COLUMNS, *_NAMING_COLUMNS))
_WANTED = f"asset.id = ANY(%s::bigint[]) AND asset.kind IN ('{AssetKind.TOWER}', '{AssetKind.BRIDGE}')"
_ALL = f"""
    SELECT snapshot.version, snapshot.ground_revision, snapshot.arrays_sha256, ground.revision, ground.changed_at,
        ST_X(asset.centre), ST_Y(asset.centre), {_ASSET_COLUMNS}
    FROM (SELECT 1) AS one LEFT JOIN {_SNAPSHOT} AS snapshot ON true LEFT JOIN {_GROUND} AS ground ON true
    LEFT JOIN inspection_asset AS asset ON {_WANTED}"""  # noqa: S608 - no value of anybody's
_ASSETS_FROM = 5  # the first column of _ALL that is an asset's

Edition = tuple[int, datetime | None]


class PointAsset(NamedTuple):
    """A whole tower or bridge, as planning sees it."""

    position: LonLat
    key: int
    kind: str
    subtype: str
    height_m: float | None  # as tagged
    max_voltage_v: int | None
    naming: tuple[object, ...]

    def as_asset(self) -> Asset:
        """With what its name is made of."""
        asset: Asset = Asset.from_db(DEFAULT_DB_ALIAS, _NAMING_COLUMNS, self.naming)
        return asset


@dataclass(frozen=True, eq=False)
class PlanningGround:
    """The newest network cleared of the zones in force, these zones, and the edition of the ground that they were read with: they are
    at least as new as it."""

    graph: InspectionGraph
    zones: ZoneIndex
    edition: Edition


class PlanningRead(NamedTuple):
    """What one statement has told."""

    snapshot: SnapshotRow | None
    edition: Edition
    points: Mapping[int, PointAsset]

    def ground(self) -> PlanningGround:
        """Costs nothing more until the network or the ground change. Raises NoGraph."""
        zones = zones_of_edition(self.edition)
        return PlanningGround(graph_for(self.snapshot, zones), zones, self.edition)


def planning_read(points: Sequence[int] = ()) -> PlanningRead:
    """Graph and ground of now, and of the assets with these keys those that are towers or bridges, by key, in one small query."""
    rows = prepared_rows(_ALL, [list(points)])
    version, ground_revision, digest, revision, changed_at = rows[0][:_ASSETS_FROM]
    named_from = _ASSETS_FROM + 2 + len(_POINT_COLUMNS)
    found = {}
    for row in rows:
        lon, lat, key = row[_ASSETS_FROM : _ASSETS_FROM + 3]
        if key is not None:
            found[key] = PointAsset(LonLat(lon, lat), *row[_ASSETS_FROM + 2 : named_from], row[named_from:])
    return PlanningRead(None if version is None else (version, ground_revision, digest), (revision or 0, changed_at), found)


def edition_now() -> Edition:
    return next(((revision, changed_at) for revision, changed_at in prepared_rows(_EDITION)), (0, None))


def has_terrain_at(edition: Edition) -> bool:
    """Whether there is any terrain model. What brings one in, or takes it out, makes a new edition."""
    return has_terrain() if edition[1] is None else _had_terrain(edition)  # a ground never marked as changed has no edition


@lru_cache(maxsize=4)
def _had_terrain(edition: Edition) -> bool:
    return has_terrain()
