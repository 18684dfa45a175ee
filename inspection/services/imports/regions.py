"""Regions of imports: each import joins the region that it overlaps, or makes one."""

import re
from collections.abc import Iterable

from django.contrib.gis.db.models import Extent
from django.contrib.gis.geos import Polygon

from inspection.demo_region import REGION_NAME
from inspection.models import Asset, DataImport, ImportKind, NoFlyZone, Region, TerrainTile
from inspection.selectors import Box

SAME_REGION_SHARE = 0.1  # of the smaller extent: extracts of neighbours overlap by less
MARGIN_DEG = 0.002  # around an extent, which of a single tower has no area
OF_ASSETS = (ImportKind.OSM, ImportKind.ASSETS)
_EXTENSIONS = re.compile(r"(\.(osm|pbf|xml|o5m|json|geojson|csv|gpkg|kml|kmz|shp|zip|gz|bz2|tiff?|hgt))+$", re.IGNORECASE)
_RELEASE = re.compile(r"[-_ ](latest|\d{4}-?\d{2}-?\d{2}|\d{6})$")


def join_region(data_import: DataImport) -> Region | None:
    """Put an import into the region that it overlaps most, else into a new one. None for an import without data. Under hold_ground."""
    extent = extent_of_import(data_import)
    if extent is None:
        return None
    region = _overlapped(extent, is_synthetic=data_import.is_synthetic)
    if region is None:
        region = Region.objects.create(name=_free_name(data_import, extent), extent=Polygon.from_bbox(extent))
    elif data_import.kind in OF_ASSETS and _has_name_of_zones_or_terrain(region):
        region.name = _free_name(data_import, extent, but=region)
        region.save(update_fields=["name"])
    _add(data_import, extent, region)
    return region


def put_into_region(data_import: DataImport, name: str) -> None:
    """Move an import into the region of this name, which is made if there is none. Under hold_ground.

    A region that it leaves without any import is deleted. Real data never join the demo region.
    """
    before, extent = data_import.region, extent_of_import(data_import)
    if extent is None or (before is not None and before.name == name):
        return
    region, _is_new = Region.objects.get_or_create(name=name, defaults={"extent": Polygon.from_bbox(extent)})
    if has_demo_data(region) and not data_import.is_synthetic:
        return
    _add(data_import, extent, region)
    if before is not None and before.imports.exists():
        fit_regions([before.pk])
    elif before is not None:
        before.delete()


def _add(data_import: DataImport, extent: Box, region: Region) -> None:
    """Put an import with data of this extent into a region, which grows by it or fits its assets."""
    data_import.region = region
    data_import.save(update_fields=["region"])
    region.extent = Polygon.from_bbox(_around(region.extent.extent, extent))
    region.save(update_fields=["extent"])
    fit_regions([region.pk])


def has_demo_data(region: Region) -> bool:
    return region.imports.filter(is_synthetic=True).exists()


def fit_regions(keys: Iterable[int]) -> None:
    """Set the extents of these regions to those of their assets. One without assets keeps its extent. Under hold_ground."""
    for region in Region.objects.filter(pk__in=list(keys)):
        extent = _grown(Asset.objects.filter(data_import__region=region, vanished_at=None).aggregate(found=Extent("centre"))["found"])
        if extent is not None and extent != region.extent.extent:
            region.extent = Polygon.from_bbox(extent)
            region.save(update_fields=["extent"])


def lies_within(data_import: DataImport, region: Region) -> bool:
    """Return whether all current data of an import lie within the extent of a region."""
    extent = extent_of_import(data_import)
    return extent is not None and _around(region.extent.extent, extent) == region.extent.extent


def _has_name_of_zones_or_terrain(region: Region) -> bool:
    """Return whether a region without assets still has the name that a file gave it."""
    names = [name_of_file(row.file_name) for row in region.imports.all()]
    return not region.imports.filter(kind__in=OF_ASSETS).exists() and region.name.startswith(tuple(name for name in names if name))


def extent_of_import(data_import: DataImport) -> Box | None:
    """Return the extent of the current data of an import."""
    if data_import.kind == ImportKind.ZONES:
        return _grown(NoFlyZone.objects.filter(zone_set__data_import=data_import).aggregate(found=Extent("geometry"))["found"])
    if data_import.kind == ImportKind.TERRAIN:
        return _grown(TerrainTile.objects.filter(data_import=data_import).aggregate(found=Extent("extent"))["found"])
    return _grown(Asset.objects.filter(data_import=data_import).aggregate(found=Extent("centre"))["found"])


def _overlapped(extent: Box, *, is_synthetic: bool) -> Region | None:
    """Return the region that shares most of its extent or of this one, whichever is smaller. Real data never join the demo region."""
    regions = Region.objects.filter(extent__bboverlaps=Polygon.from_bbox(extent), imports__is_synthetic=is_synthetic).distinct()
    shares = [(_shared(region.extent.extent, extent), region) for region in regions]
    share, found = max(shares, key=lambda entry: entry[0], default=(0.0, None))
    return found if share >= SAME_REGION_SHARE else None


def _shared(one: Box, other: Box) -> float:
    width, height = min(one[2], other[2]) - max(one[0], other[0]), min(one[3], other[3]) - max(one[1], other[1])
    return max(width, 0.0) * max(height, 0.0) / min(_area(one), _area(other))


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _grown(box: Box | None) -> Box | None:
    if box is None:
        return None
    west, south, east, north = box
    return max(west - MARGIN_DEG, -180.0), max(south - MARGIN_DEG, -90.0), min(east + MARGIN_DEG, 180.0), min(north + MARGIN_DEG, 90.0)


def _around(one: Box, other: Box) -> Box:
    return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])


def _free_name(data_import: DataImport, extent: Box, but: Region | None = None) -> str:
    name = REGION_NAME if data_import.is_synthetic else name_of_file(data_import.file_name) or _place(extent)
    named = Region.objects.filter(name__startswith=name).values_list("name", flat=True)
    others = set(named.exclude(pk=but.pk) if but else named)
    return next(
        candidate for number in range(1, len(others) + 2) if (candidate := name if number == 1 else f"{name} {number}") not in others
    )


def name_of_file(file_name: str) -> str:
    """Return the name of a region as its file states it: "rhone-alpes-latest.osm.pbf" is "Rhone Alpes". Empty for one of Overpass."""
    stem = _RELEASE.sub("", _EXTENSIONS.sub("", file_name))
    words = re.split(r"[-_\s]+", stem)[:12]
    name = " ".join(word[:1].upper() + word[1:] for word in words if word)[:180]
    return "" if name.lower() == "overpass" else name


def _place(extent: Box) -> str:
    longitude, latitude = (extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2
    return f"{abs(latitude):.1f}° {'N' if latitude >= 0 else 'S'}, {abs(longitude):.1f}° {'E' if longitude >= 0 else 'W'}"
