"""Writes a terrain model in blocks: GeoTIFF through GDAL with its driver checked, SRTM's HGT by our own reader."""

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from django.contrib.gis.gdal import GDALException, GDALRaster
from django.contrib.gis.geos import Polygon
from django.db import transaction

from inspection.models import DataImport, ImportKind, TerrainTile
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.osm_import import SYNTHETIC_ATTRIBUTION
from inspection.services.proposals.reading import Provenance
from inspection.terrain.errors import TerrainFileError
from inspection.terrain.height_grid import BLOCK_SIZE, HeightGrid, packed, without_voids
from inspection.terrain.hgt import read_hgt
from inspection.terrain.packed_hgt import unpacked_hgt
from inspection.terrain.tiff_gate import examine
from workspace.models import User
from workspace.services import record_change

MAX_POSTS = 200_000_000
WGS84_SRID = 4326
_TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")  # classic and BigTIFF
_ZIP_START = b"PK"
_BATCH = 64

Progress = Callable[[str, float], None]


def import_terrain(
    *,
    path: Path,
    imported_by: User | None = None,
    is_synthetic: bool = False,
    vertical_datum: str = "EGM96",
    progress: Progress | None = None,
    provenance: Provenance | None = None,
) -> DataImport:
    """Store the heights of a GeoTIFF (EPSG:4326) or HGT file, zipped or not; raises TerrainFileError and changes nothing.

    The same file again changes nothing; a changed file of the same name takes the place of the earlier one. A datum that the file states
    wins over vertical_datum. It counts as a change of the ground: missions were planned with other heights.
    """
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    with terrain_blocks(path, progress) as (blocks, stated_datum), transaction.atomic():
        hold_ground()
        of_this_name = DataImport.objects.filter(kind=ImportKind.TERRAIN, file_name=path.name[:255])
        known = of_this_name.filter(sha256=sha256, terrain_tiles__isnull=False).first()
        if known is not None:
            return known
        data_import = DataImport.objects.create(
            kind=ImportKind.TERRAIN, file_name=path.name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
            attribution=SYNTHETIC_ATTRIBUTION if is_synthetic else "",
        )  # fmt: skip
        if provenance is not None:
            data_import.attribution, data_import.licence = provenance.attribution, provenance.licence
            data_import.source_address, data_import.fetched_at = provenance.source_address, provenance.fetched_at
        data_import.counts = _write(data_import, blocks, stated_datum or vertical_datum)
        data_import.save()
        TerrainTile.objects.filter(data_import__in=of_this_name.exclude(pk=data_import.pk)).delete()
        mark_ground_changed()
    return data_import


def remove_terrain(*, data_import: DataImport, actor: User) -> None:
    """Take a terrain model away; older models below it count again."""
    with transaction.atomic():
        hold_ground()
        deleted, _ = TerrainTile.objects.filter(data_import=data_import).delete()
        if deleted:
            record_change(
                organisation=actor.organisation, actor=actor, action="deleted", subject_type="terrain", subject_id=data_import.pk,
                before={"file_name": data_import.file_name, "counts": data_import.counts},
            )  # fmt: skip
            mark_ground_changed()


@contextmanager
def terrain_blocks(path: Path, progress: Progress | None) -> Iterator[tuple[Iterator[HeightGrid], str | None]]:
    """The blocks of a terrain file and the vertical datum that it states. Raises TerrainFileError."""
    with path.open("rb") as file:
        start = file.read(4)
    if start.startswith(_ZIP_START):
        with unpacked_hgt(path) as unpacked:
            yield _with_progress(read_hgt(unpacked).blocks(), 0, None), None
    elif path.suffix.lower() == ".hgt":
        yield _with_progress(read_hgt(path).blocks(), 0, None), None
    elif start in _TIFF_STARTS:
        facts = examine(path)
        yield _geotiff_blocks(path, progress), facts.vertical_datum
    else:
        raise TerrainFileError("This is neither a GeoTIFF nor an HGT file, zipped or not.")


def _write(data_import: DataImport, blocks: Iterator[HeightGrid], vertical_datum: str) -> dict[str, object]:
    tiles: list[TerrainTile] = []
    number = posts = voids = 0
    lowest, highest = np.inf, -np.inf
    extents = []
    for block in blocks:
        rows, columns = block.heights_m.shape
        tiles.append(
            TerrainTile(
                data_import=data_import, extent=Polygon.from_bbox(block.extent), west_deg=block.west_deg, north_deg=block.north_deg,
                step_lon_deg=block.step_lon_deg, step_lat_deg=block.step_lat_deg, columns=columns, rows=rows,
                heights_amsl_m=packed(block.heights_m), vertical_datum=vertical_datum,
            )
        )  # fmt: skip
        number += 1
        posts += rows * columns
        voids += int(np.isnan(block.heights_m).sum())
        lowest, highest = min(lowest, float(np.nanmin(block.heights_m))), max(highest, float(np.nanmax(block.heights_m)))
        extents.append(block.extent)
        if len(tiles) == _BATCH:
            TerrainTile.objects.bulk_create(tiles)
            tiles = []
    TerrainTile.objects.bulk_create(tiles)
    if number == 0:
        raise TerrainFileError("The file has no heights, only voids.")
    bounds = np.array(extents)
    extent = [*bounds[:, :2].min(axis=0).tolist(), *bounds[:, 2:].max(axis=0).tolist()]
    return {"blocks": number, "posts": posts, "voids": voids, "lowest_m": lowest, "highest_m": highest, "extent": extent}


def _geotiff_blocks(path: Path, progress: Progress | None) -> Iterator[HeightGrid]:
    """The blocks of the raster's only band; nothing is read before the file is known to be what we take."""
    try:
        raster = GDALRaster(str(path.resolve()))
        if raster.driver.name != "GTiff":
            raise TerrainFileError(f"GDAL takes the file for {raster.driver.name}, not for a GeoTIFF.")
        if raster.srs is None:
            raise TerrainFileError("The file cannot be read as a GeoTIFF with a reference system.")
        if raster.srs.srid != WGS84_SRID:
            raise TerrainFileError(
                "The GeoTIFF is not in longitude and latitude on WGS84 (EPSG:4326); convert it first: gdalwarp -t_srs EPSG:4326"
            )
    except GDALException as error:
        raise TerrainFileError("The file cannot be read as a GeoTIFF with a reference system.") from error
    west_edge, step_lon, skew_x, north_edge, skew_y, step_lat = raster.geotransform
    if skew_x or skew_y or step_lon <= 0 or step_lat >= 0:
        raise TerrainFileError("The GeoTIFF is rotated or upside down; convert it first: gdalwarp -t_srs EPSG:4326")
    if len(raster.bands) != 1:
        raise TerrainFileError(f"A terrain model has one band; this file has {len(raster.bands)}.")
    if raster.width * raster.height > MAX_POSTS:
        raise TerrainFileError(f"The GeoTIFF has {raster.width} × {raster.height} posts; at most {MAX_POSTS} are taken. Cut it into parts.")
    if raster.width < 2 or raster.height < 2:
        raise TerrainFileError("The GeoTIFF has fewer than two rows or columns.")
    west, north = west_edge + step_lon / 2, north_edge + step_lat / 2
    if not (west >= -181 and west + step_lon * raster.width <= 181 and north <= 91 and north + step_lat * raster.height >= -91):
        raise TerrainFileError("The GeoTIFF reaches beyond longitude ±180 or latitude ±90.")
    return _with_progress(_read_blocks(raster, west, north), raster.height, progress)


def _read_blocks(raster: GDALRaster, west: float, north: float) -> Iterator[HeightGrid]:
    band = raster.bands[0]
    step_lon, step_lat = raster.geotransform[1], -raster.geotransform[5]
    for row in range(0, raster.height - 1, BLOCK_SIZE - 1):
        rows = min(BLOCK_SIZE, raster.height - row)
        for column in range(0, raster.width - 1, BLOCK_SIZE - 1):
            columns = min(BLOCK_SIZE, raster.width - column)
            try:
                raw = band.data(offset=(column, row), size=(columns, rows))
            except GDALException as error:
                raise TerrainFileError(f"The GeoTIFF is damaged near row {row}, column {column}.") from error
            if raw is None or np.iscomplexobj(raw):
                raise TerrainFileError("The GeoTIFF has no heights that can be read.")
            heights = without_voids(np.asarray(raw).reshape(rows, columns), band.nodata_value)
            if not np.isnan(heights).all():
                yield HeightGrid(west + column * step_lon, north - row * step_lat, step_lon, step_lat, heights)


def _with_progress(blocks: Iterator[HeightGrid], rows: int, progress: Progress | None) -> Iterator[HeightGrid]:
    first: float | None = None
    for block in blocks:
        first = block.north_deg if first is None else first
        if progress is not None and rows:
            progress("terrain", min((first - block.north_deg) / block.step_lat_deg / rows, 1.0))
        yield block
