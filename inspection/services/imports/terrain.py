"""Stores terrain models in blocks, and removes them."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from django.contrib.gis.geos import Polygon
from django.db import transaction

from inspection.importers.terrain.raster import PostSurvey, TerrainFileError, blocks_of
from inspection.importers.terrain.terrain_file import TerrainFile, datum_of, opened_terrain
from inspection.models import DataImport, ImportKind, TerrainTile
from inspection.reasons import notes_json
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.imports.osm import SYNTHETIC_ATTRIBUTION
from inspection.services.imports.regions import join_region
from inspection.services.proposals.reading import Provenance
from inspection.terrain.heights import HeightGrid, packed
from operation.reasons import Reason
from workspace.audit import record_change
from workspace.models import User

ONLY_VOIDS = "The file has no heights, only voids."
_BATCH = 64

Progress = Callable[[Reason, float], None]


def import_terrain(
    *,
    path: Path,
    imported_by: User | None = None,
    is_synthetic: bool = False,
    vertical_datum: str = "",
    progress: Progress | None = None,
    provenance: Provenance | None = None,
) -> DataImport:
    """Store the heights of a GeoTIFF or HGT file, or of a zip of several. Raises TerrainFileError and changes nothing.

    Importing the same file again changes nothing; a changed file of the same name replaces the earlier one. vertical_datum is for a file
    that does not state one. It counts as a change of the map data, as missions were planned with other heights.
    """
    origin = provenance or Provenance(file_name=path.name)
    with opened_terrain(path) as file, transaction.atomic():
        datum = datum_of(file, vertical_datum)
        hold_ground()
        sha256 = sha256_of(path)
        known = same_import(origin.file_name, sha256, datum)
        if known is not None:
            return known
        data_import = DataImport.objects.create(
            kind=ImportKind.TERRAIN, file_name=origin.file_name[:255], sha256=sha256, is_synthetic=is_synthetic, imported_by=imported_by,
            attribution=origin.attribution or (SYNTHETIC_ATTRIBUTION if is_synthetic else ""), licence=origin.licence,
            source_address=origin.source_address, fetched_at=origin.fetched_at,
        )  # fmt: skip
        data_import.counts = _write(data_import, file, datum, progress)
        data_import.save(update_fields=["counts"])
        TerrainTile.objects.filter(data_import__in=imports_of_name(origin.file_name).exclude(pk=data_import.pk)).delete()
        join_region(data_import)
        mark_ground_changed()
    return data_import


def remove_terrain(*, data_import: DataImport, actor: User) -> None:
    """Remove a terrain model; older models below it count again."""
    with transaction.atomic():
        hold_ground()
        deleted, _ = TerrainTile.objects.filter(data_import=data_import).delete()
        if deleted:
            record_change(
                organisation=actor.organisation, actor=actor, action="deleted", subject_type="terrain", subject_id=data_import.pk,
                before={"file_name": data_import.file_name, "counts": data_import.counts},
            )  # fmt: skip
            mark_ground_changed()


def imports_of_name(file_name: str) -> Any:
    return DataImport.objects.filter(kind=ImportKind.TERRAIN, file_name=file_name[:255])


def same_import(file_name: str, sha256: str, datum: str) -> DataImport | None:
    """Return the import of exactly the same heights, or None."""
    return imports_of_name(file_name).filter(sha256=sha256, terrain_tiles__vertical_datum=datum).first()


def sha256_of(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def facts_of(file: TerrainFile, survey: PostSurvey, datum: str) -> dict[str, Any]:
    """Return the content of a file, for users and the list of models. Raises TerrainFileError for one without heights."""
    if survey.blocks == 0:
        raise TerrainFileError(ONLY_VOIDS)
    return survey.counts() | {
        "format": file.file_format,
        "reference_system": ", ".join(file.reference_systems),
        "resolution_m": round(file.resolution_m, 2),
        "vertical_datum": datum,
        "datum_is_stated": file.vertical_datum is not None,
        **notes_json([*file.notes, *survey.notes()]),
    }


def _write(data_import: DataImport, file: TerrainFile, datum: str, progress: Progress | None) -> dict[str, Any]:
    survey = PostSurvey()
    tiles: list[TerrainTile] = []
    for number, raster in enumerate(file.rasters):
        for block in blocks_of(raster):
            survey.add(block)
            if progress is not None:
                progress(Reason("writing_heights"), (number + block.share) / len(file.rasters))
            if block.grid is not None:
                tiles.append(_tile(data_import, block.grid, datum))
            if len(tiles) == _BATCH:
                TerrainTile.objects.bulk_create(tiles)
                tiles = []
    TerrainTile.objects.bulk_create(tiles)
    return facts_of(file, survey, datum)


def _tile(data_import: DataImport, grid: HeightGrid, datum: str) -> TerrainTile:
    rows, columns = grid.heights_m.shape
    return TerrainTile(
        data_import=data_import, extent=Polygon.from_bbox(grid.extent), west_deg=grid.west_deg, north_deg=grid.north_deg,
        step_lon_deg=grid.step_lon_deg, step_lat_deg=grid.step_lat_deg, columns=columns, rows=rows,
        heights_amsl_m=packed(grid.heights_m), vertical_datum=datum,
    )  # fmt: skip
