"""Data for a plan, read in one statement: the newest graph, the dataset version, and the assets that it visits."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from operator import itemgetter
from typing import NamedTuple

from django.db import DEFAULT_DB_ALIAS

from inspection.geodesy import LonLat
from inspection.models import Asset, AssetKind
from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.snapshot_file import LAYOUT
from inspection.network.zones.zone_index import ZoneIndex
from inspection.selectors.graph import SnapshotRow, graph_for, network_for, zones_of_table
from inspection.selectors.ground import DatasetVersion
from inspection.selectors.terrain import FloatArray, ground_heights_m, has_terrain, terrain_dataset_version
from inspection.selectors.zone_table import zone_table_of_version
from inspection.zones.reach import BoolArray, ZoneTable
from workspace.prepared_statements import prepared_rows

_GROUND = "(SELECT revision, changed_at FROM inspection_ground ORDER BY id LIMIT 1)"
_EDITION = f"SELECT revision, changed_at FROM {_GROUND} AS ground"  # noqa: S608 - constant texts only
_SNAPSHOT = f"""(SELECT version, ground_revision, arrays_sha256 FROM inspection_graphsnapshot WHERE rules @> '{{"layout": {LAYOUT}}}'
    ORDER BY version DESC LIMIT 1)"""  # noqa: S608 - constant texts only
# Columns of a whole tower or bridge for planning and for its name; in the model's own order, in which `from_db` takes them.
_ASKED = {
    "id",
    "kind",
    "subtype",
    "height_m",
    "max_voltage_v",
    "ref",
    "name",
    "operator",
    "line_id",
    "place_on_line",
    "places_on_line",
    "osm_type",
    "osm_id",
}
_COLUMNS = tuple(field.attname for field in Asset._meta.concrete_fields if field.attname in _ASKED)
_plain = itemgetter(*map(_COLUMNS.index, ("id", "kind", "subtype", "height_m", "max_voltage_v")))
_ASSET_COLUMNS = ", ".join(f"asset.{column}" for column in _COLUMNS)
_WANTED = f"asset.id = ANY(%s::bigint[]) AND asset.kind IN ('{AssetKind.TOWER}', '{AssetKind.BRIDGE}')"
_ALL = f"""
    SELECT snapshot.version, snapshot.ground_revision, snapshot.arrays_sha256, ground.revision, ground.changed_at,
        ST_X(asset.centre), ST_Y(asset.centre), {_ASSET_COLUMNS}
    FROM (SELECT 1) AS one LEFT JOIN {_SNAPSHOT} AS snapshot ON true LEFT JOIN {_GROUND} AS ground ON true
    LEFT JOIN inspection_asset AS asset ON {_WANTED}"""  # noqa: S608 - constant texts only
_GROUND_COLUMNS = 5  # of _ALL; longitude, latitude and the columns of an asset follow


class PointAsset(NamedTuple):
    """A whole tower or bridge for planning."""

    position: LonLat
    key: int
    kind: str
    subtype: str
    height_m: float | None  # as tagged
    max_voltage_v: int | None
    columns: tuple[object, ...]

    def as_asset(self) -> Asset:
        """Return the asset with the columns of its name."""
        asset: Asset = Asset.from_db(DEFAULT_DB_ALIAS, _COLUMNS, self.columns)
        return asset


@dataclass(frozen=True, eq=False)
class PlanningGround:
    """The newest network, all zones, and the dataset version with which they were read: they are at least as new."""

    snapshot: SnapshotRow | None
    table: ZoneTable
    dataset_version: DatasetVersion

    def zones(self, chosen: BoolArray | None = None) -> ZoneIndex:
        """Return all zones, or those where the mask (z,) is true."""
        return zones_of_table(self.table, chosen)

    def graph(self, zones: ZoneIndex) -> InspectionGraph:
        """Return the network cleared of these zones. Costs nothing more until the network or the zones change. Raises NoGraph."""
        return graph_for(self.snapshot, zones)

    def network(self) -> Network:
        """Return the network without regard to zones. Raises NoGraph."""
        return network_for(self.snapshot)


class PlanningRead(NamedTuple):
    """Result of one statement."""

    snapshot: SnapshotRow | None
    dataset_version: DatasetVersion
    points: Mapping[int, PointAsset]

    def ground(self) -> PlanningGround:
        return PlanningGround(self.snapshot, zone_table_of_version(self.dataset_version), self.dataset_version)


def planning_read(points: Sequence[int] = ()) -> PlanningRead:
    """Return the current graph and map data, and the towers and bridges among the assets with these keys, in one small query."""
    rows = prepared_rows(_ALL, [list(points)])
    version, ground_revision, digest, revision, changed_at = rows[0][:_GROUND_COLUMNS]
    found = {}
    for row in rows:
        (lon, lat), columns = row[_GROUND_COLUMNS : _GROUND_COLUMNS + 2], row[_GROUND_COLUMNS + 2 :]
        key, kind, subtype, height_m, max_voltage_v = _plain(columns)
        if key is not None:
            found[key] = PointAsset(LonLat(lon, lat), key, kind, subtype, height_m, max_voltage_v, columns)
    return PlanningRead(None if version is None else (version, ground_revision, digest), (revision or 0, changed_at), found)


def current_dataset_version() -> DatasetVersion:
    return next(((revision, changed_at) for revision, changed_at in prepared_rows(_EDITION)), (0, None))


def has_terrain_at(dataset_version: DatasetVersion) -> bool:
    """Whether there is any terrain model. Adding or removing one makes a new dataset version."""
    # Map data never marked as changed have no version.
    return has_terrain() if dataset_version[1] is None else _had_terrain(dataset_version)


def heights_at(dataset_version: DatasetVersion) -> Callable[[FloatArray], FloatArray] | None:
    """Return ground_heights_m over this dataset version, without a query for a newer one; None without a terrain model."""
    return partial(ground_heights_m, dataset_version=dataset_version) if has_terrain_at(dataset_version) else None


def terrain_at(dataset_version: DatasetVersion) -> tuple[int | None, int]:
    """Return the terrain version when this dataset version was first read, or a later one."""
    return terrain_dataset_version() if dataset_version[1] is None else _terrain_of(dataset_version)


@lru_cache(maxsize=4)
def _had_terrain(dataset_version: DatasetVersion) -> bool:
    return has_terrain()


@lru_cache(maxsize=4)
def _terrain_of(dataset_version: DatasetVersion) -> tuple[int | None, int]:
    return terrain_dataset_version()
