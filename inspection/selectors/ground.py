"""The map data as a whole: counts, extent, sources, and whether the graph is current."""

from dataclasses import dataclass
from datetime import datetime

from django.contrib.gis.db.models import Extent
from django.db import connection
from django.db.models import Count, Exists, OuterRef, Q

from inspection.models import Asset, AssetKind, DataImport, GraphSnapshot, Ground, NoFlyZone, Region, TerrainTile, ZoneSet
from inspection.network.snapshot_file import LAYOUT

Extent_deg = tuple[float, float, float, float]  # west, south, east, north
DatasetVersion = tuple[int, datetime | None]  # of the map data: revision, and time of the change

_extent: tuple[DatasetVersion, Extent_deg | None] | None = None
_by_region: tuple[DatasetVersion, dict[int, dict[str, int]]] | None = None  # assets by region and kind


@dataclass(frozen=True)
class GroundSummary:
    revision: int
    graph: GraphSnapshot | None  # the newest one, without its arrays
    extent: Extent_deg | None  # of all assets
    counts: dict[str, int]  # by asset kind, and of zones
    attribution: list[str]
    is_synthetic: bool
    has_terrain: bool

    @property
    def graph_is_current(self) -> bool:
        """Whether the graph shows the current map data; planners do not read one of an earlier layout."""
        graph = self.graph
        return graph is not None and graph.ground_revision == self.revision and graph.rules.get("layout") == LAYOUT


@dataclass(frozen=True)
class RegionSummary:
    """A region with current data."""

    id: int
    name: str
    extent: Extent_deg
    counts: dict[str, int]  # by asset kind
    is_synthetic: bool
    attribution: list[str]
    newest_import: int


def ground_revision() -> int:
    return Ground.objects.values_list("revision", flat=True).first() or 0


def held_ground_revision() -> int:
    """Return the dataset revision and lock it until the caller's transaction ends; no other change of map data commits before."""
    with connection.cursor() as cursor:
        cursor.execute(f"SELECT revision FROM {Ground._meta.db_table} WHERE id = %s FOR SHARE", [Ground.SINGLE_ID])  # noqa: S608 - a table
        row = cursor.fetchone()
    return 0 if row is None else int(row[0])


def ground_dataset_version() -> DatasetVersion:
    """Return the revision and its time. Two databases may have the same revision, and a restored one repeats it."""
    return Ground.objects.values_list("revision", "changed_at").first() or (0, None)


def ground_extent() -> Extent_deg | None:
    """Return west, south, east, north of all assets. Costs one small query until the map data change."""
    global _extent
    dataset_version = ground_dataset_version()
    remembered = _extent
    if (
        remembered is None or remembered[0] != dataset_version or dataset_version[1] is None
    ):  # map data without a version were never marked as changed
        extent = Asset.objects.filter(vanished_at=None).aggregate(extent=Extent("centre"))["extent"]
        _extent = remembered = dataset_version, extent
    return remembered[1]


def ground_summary() -> GroundSummary:
    assets = Asset.objects.filter(vanished_at=None)
    by_kind = dict(assets.order_by().values_list("kind").annotate(Count("pk")))
    sources = imports_in_use()
    return GroundSummary(
        revision=ground_revision(),
        graph=GraphSnapshot.objects.defer("arrays").first(),
        extent=ground_extent(),
        counts={kind.value: by_kind.get(kind.value, 0) for kind in AssetKind} | {"zone": NoFlyZone.objects.count()},
        attribution=sorted({source.attribution for source in sources if source.attribution}),
        is_synthetic=any(source.is_synthetic for source in sources),
        has_terrain=TerrainTile.objects.exists(),
    )


def imports_in_use() -> list[DataImport]:
    """Return the imports from which current map data come."""
    used = Q(Exists(Asset.objects.filter(data_import=OuterRef("pk"), vanished_at=None)))
    used |= Q(Exists(ZoneSet.objects.filter(data_import=OuterRef("pk"))))
    used |= Q(Exists(TerrainTile.objects.filter(data_import=OuterRef("pk"))))
    return list(DataImport.objects.filter(used))


def regions_in_use() -> list[RegionSummary]:
    """Return the regions with current data, by name."""
    sources: dict[int, list[DataImport]] = {}
    for source in imports_in_use():
        if source.region_id is not None:
            sources.setdefault(source.region_id, []).append(source)
    counts = _assets_by_region() if sources else {}
    return [
        RegionSummary(
            id=region.pk,
            name=region.name,
            extent=region.extent.extent,
            counts=counts.get(region.pk, {}),
            is_synthetic=any(source.is_synthetic for source in sources[region.pk]),
            attribution=sorted({source.attribution for source in sources[region.pk] if source.attribution}),
            newest_import=max(source.pk for source in sources[region.pk]),
        )
        for region in Region.objects.filter(pk__in=sources)
    ]


def _assets_by_region() -> dict[int, dict[str, int]]:
    """Return the numbers of assets by region and kind. Costs one query over all assets when the map data have changed."""
    global _by_region
    dataset_version = ground_dataset_version()
    remembered = _by_region
    if remembered is None or remembered[0] != dataset_version or dataset_version[1] is None:
        rows = Asset.objects.filter(vanished_at=None, data_import__region__isnull=False).order_by()
        found: dict[int, dict[str, int]] = {}
        for region, kind, number in rows.values_list("data_import__region", "kind").annotate(Count("pk")):
            found.setdefault(region, {})[kind] = number
        _by_region = remembered = dataset_version, found
    return remembered[1]
