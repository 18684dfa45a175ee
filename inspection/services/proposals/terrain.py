"""Terrain files as proposals."""

from pathlib import Path
from typing import Any

import numpy as np

from inspection.models import DataImport, ImportKind, TerrainTile
from inspection.services.proposals.reading import Fault, FileRefused, Progress, Provenance, Reading
from inspection.services.terrain_import import import_terrain, terrain_blocks
from inspection.terrain.errors import TerrainFileError
from workspace.models import User

DEFAULT_DATUM = "EGM96"
LONGEST_DATUM = 50


def read(*, path: Path | None, parameters: dict[str, Any], provenance: Provenance, progress: Progress) -> Reading:
    """What is in the file, and which model of the same name it takes the place of. Raises FileRefused."""
    datum = _datum(parameters)
    posts = voids = blocks = 0
    lowest, highest = np.inf, -np.inf
    extents: list[tuple[float, float, float, float]] = []
    step = (0.0, 0.0)
    try:
        with terrain_blocks(_file(path), progress) as (grids, stated_datum):
            for grid in grids:
                progress("reading the heights", 0.5)
                blocks += 1
                posts += grid.heights_m.size
                voids += int(np.isnan(grid.heights_m).sum())
                lowest, highest = min(lowest, float(np.nanmin(grid.heights_m))), max(highest, float(np.nanmax(grid.heights_m)))
                extents.append(grid.extent)
                step = (grid.step_lon_deg, grid.step_lat_deg)
    except TerrainFileError as error:
        raise FileRefused([Fault("", str(error))]) from error
    if not blocks:
        raise FileRefused([Fault("", "The file has no heights, only voids.")])
    bounds = np.array(extents)
    summary = {
        "blocks": blocks, "posts": posts, "voids": voids, "lowest_m": lowest, "highest_m": highest, "step_lon_deg": step[0],
        "step_lat_deg": step[1], "vertical_datum": stated_datum or datum, "datum_is_stated": stated_datum is not None,
        "extent": [*bounds[:, :2].min(axis=0).tolist(), *bounds[:, 2:].max(axis=0).tolist()],
    }  # fmt: skip
    held = TerrainTile.objects.filter(data_import__kind=ImportKind.TERRAIN, data_import__file_name=provenance.file_name[:255]).count()
    return Reading(
        summary, {"new": max(blocks - held, 0), "changed": min(blocks, held), "vanished": max(held - blocks, 0), "kept": 0, "unchanged": 0}
    )


def apply(
    *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, applied_by: User | None, progress: Progress
) -> DataImport:
    """Store the heights. Raises FileRefused."""
    try:
        return import_terrain(
            path=_file(path), imported_by=applied_by, vertical_datum=_datum(parameters), progress=progress, provenance=provenance
        )
    except TerrainFileError as error:
        raise FileRefused([Fault("", str(error))]) from error


def _file(path: Path | None) -> Path:
    if path is None:
        raise FileRefused([Fault("", "There is no file.")])
    return path


def _datum(parameters: dict[str, Any]) -> str:
    datum = parameters.get("vertical_datum") or DEFAULT_DATUM
    if not isinstance(datum, str) or len(datum) > LONGEST_DATUM or not datum.isprintable():
        raise FileRefused([Fault("vertical_datum", f"The vertical datum is a name of at most {LONGEST_DATUM} characters.")])
    if "ellipsoid" in datum.lower() or datum.upper() in {"WGS84", "EPSG:4979"}:
        raise FileRefused(
            [Fault("vertical_datum", "Heights above the ellipsoid cannot be compared with others: convert them to sea level.")]
        )
    return datum
