"""Terrain files as proposals: the file's content, and its changes block by block."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from django.contrib.gis.geos import MultiPolygon, Polygon

from inspection.importers.terrain.raster import DatumFault, PostSurvey, TerrainFileError, blocks_of
from inspection.importers.terrain.terrain_file import datum_of, opened_terrain
from inspection.models import ROW_ACTIONS, ChangeAction, DataImport, TerrainTile
from inspection.selectors.terrain import ground_truth
from inspection.services.imports.terrain import facts_of, import_terrain, imports_of_name, same_import, sha256_of
from inspection.services.proposals.reading import Change, Fault, FileRefused, Progress, Provenance, Reading
from inspection.terrain.heights import HeightGrid
from operation.reasons import Reason, reason_of
from workspace.models import User

SUBJECT = "terrain"
SAME_M = 0.01  # smaller differences of heights do not count
_AT_ONCE = 8  # blocks
_EDGE_DEG = 1e-7


def read(*, path: Path | None, parameters: dict[str, Any], provenance: Provenance, progress: Progress) -> Reading:
    """Return the file's content and the terrain that it would change. Raises FileRefused."""
    path = _file(path)
    try:
        with opened_terrain(path) as file:
            datum = datum_of(file, _stated_datum(parameters))
            survey, comparison = PostSurvey(), _Comparison(provenance.file_name, datum)
            for number, raster in enumerate(file.rasters):
                for block in blocks_of(raster):
                    progress(Reason("reading_heights"), (number + block.share) / len(file.rasters))
                    survey.add(block)
                    if block.grid is not None:
                        comparison.add(block.grid)
            summary = facts_of(file, survey, datum)
    except TerrainFileError as error:
        raise _refusal(error) from error
    if same_import(provenance.file_name, sha256_of(path), datum) is not None:
        return Reading(summary, dict.fromkeys([*ROW_ACTIONS, "unchanged"], 0) | {"unchanged": survey.blocks})
    comparison.finish()
    summary["notes"] = [*summary["notes"], *comparison.notes()]
    return Reading(summary, comparison.numbers, tuple(comparison.changes))


def apply(
    *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, applied_by: User | None, progress: Progress
) -> DataImport:
    """Store the heights. Raises FileRefused."""
    try:
        return import_terrain(
            path=_file(path), imported_by=applied_by, vertical_datum=_stated_datum(parameters), progress=progress, provenance=provenance
        )
    except TerrainFileError as error:
        raise _refusal(error) from error


class _Comparison:
    """Compares the posts of blocks with the current terrain."""

    def __init__(self, file_name: str, datum: str) -> None:
        self.numbers: dict[str, int] = dict.fromkeys([*ROW_ACTIONS, "unchanged"], 0)
        self.changes: list[Change] = []
        self._file_name = file_name
        self._datum = datum
        self._waiting: list[HeightGrid] = []
        self._extents: list[tuple[float, float, float, float]] = []
        self._met: set[int] = set()  # imports that provide the current terrain within the file

    def add(self, grid: HeightGrid) -> None:
        self._extents.append(grid.extent)
        self._waiting.append(grid)
        if len(self._waiting) == _AT_ONCE:
            self._compare()

    def finish(self) -> None:
        self._compare()
        for tile in self._given_up():
            self.numbers[ChangeAction.VANISHED] += 1
            self.changes.append(
                Change(ChangeAction.VANISHED, SUBJECT, _label(tile.extent.extent), tile.pk, tile.extent, before={"model": self._file_name})
            )

    def notes(self) -> Iterable[str]:
        others = DataImport.objects.filter(terrain_tiles__extent__bboverlaps=MultiPolygon([Polygon.from_bbox(self._whole())], srid=4326))
        datums = others.exclude(file_name=self._file_name[:255]).values_list("file_name", "terrain_tiles__vertical_datum").distinct()
        for name, datum in sorted(set(datums)):
            if datum != self._datum:
                yield f"{name} here counts its heights from {datum}, this file from {self._datum}: where they meet, heights may step."

    def _compare(self) -> None:
        grids, self._waiting = self._waiting, []
        posts = [_posts(grid) for grid in grids]
        if not posts:
            return
        truth = ground_truth(np.concatenate([positions for positions, _ in posts]))
        names = dict(DataImport.objects.filter(pk__in=np.unique(truth.imports).tolist()).values_list("pk", "file_name"))
        first = 0
        for grid, (_, heights) in zip(grids, posts, strict=True):
            part = slice(first, first + len(heights))
            first = part.stop
            self._take(
                grid, heights, truth.heights_m[part], [names[key] for key in np.unique(truth.imports[part]).tolist() if key in names]
            )

    def _take(self, grid: HeightGrid, heights: np.ndarray[Any, Any], now: np.ndarray[Any, Any], models: list[str]) -> None:
        both = ~np.isnan(heights) & ~np.isnan(now)
        change_m = float(np.abs(heights[both] - now[both]).max()) if both.any() else None
        after = {"model": self._file_name} | _span(grid.heights_m)
        extent = grid.extent
        if change_m is None:
            self._note(ChangeAction.NEW, extent, None, after)
        elif change_m < SAME_M and both.sum() == (~np.isnan(heights)).sum():
            self.numbers["unchanged"] += 1
        else:
            self._note(
                ChangeAction.CHANGED, extent, {"model": ", ".join(models)} | _span(now), after | {"largest_change_m": round(change_m, 1)}
            )

    def _note(
        self, action: ChangeAction, extent: tuple[float, float, float, float], before: dict[str, Any] | None, after: dict[str, Any]
    ) -> None:
        self.numbers[action] += 1
        shape = Polygon.from_bbox(extent)
        shape.srid = 4326
        self.changes.append(Change(action, SUBJECT, _label(extent), None, shape, before, after))

    def _given_up(self) -> list[TerrainTile]:
        """Return blocks of the earlier file of this name that the new one does not cover completely."""
        tiles = list(TerrainTile.objects.filter(data_import__in=imports_of_name(self._file_name)).defer("heights_amsl_m"))
        if not tiles:
            return []
        west, south, east, north = np.array(self._extents).T
        covered = shapely.unary_union(shapely.box(west - _EDGE_DEG, south - _EDGE_DEG, east + _EDGE_DEG, north + _EDGE_DEG))
        shapely.prepare(covered)
        return [tile for tile in tiles if not shapely.covers(covered, shapely.box(*tile.extent.extent))]

    def _whole(self) -> tuple[float, float, float, float]:
        west, south, east, north = np.array(self._extents).T
        return float(west.min()), float(south.min()), float(east.max()), float(north.max())


def _posts(grid: HeightGrid) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Return positions and heights."""
    rows, columns = (np.arange(count) for count in grid.heights_m.shape)
    lon, lat = np.meshgrid(grid.west_deg + columns * grid.step_lon_deg, grid.north_deg - rows * grid.step_lat_deg)
    return np.column_stack([lon.ravel(), lat.ravel()]), grid.heights_m.ravel().astype(np.float64)


def _span(heights: np.ndarray[Any, Any]) -> dict[str, float]:
    return {"lowest_m": round(float(np.nanmin(heights)), 1), "highest_m": round(float(np.nanmax(heights)), 1)}


def _label(extent: tuple[float, float, float, float]) -> str:
    lon, lat = (extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2
    return f"Block at {abs(lat):.3f}° {'S' if lat < 0 else 'N'}, {abs(lon):.3f}° {'W' if lon < 0 else 'E'}"


def _file(path: Path | None) -> Path:
    if path is None:
        raise FileRefused([Fault("", Reason("no_file"))])
    return path


def _stated_datum(parameters: dict[str, Any]) -> str:
    said = parameters.get("vertical_datum") or ""
    if not isinstance(said, str):
        raise FileRefused([Fault("vertical_datum", "The vertical datum is a name.")])
    return said


def _refusal(error: TerrainFileError) -> FileRefused:
    place = "vertical_datum" if isinstance(error, DatumFault) else ""
    return FileRefused([Fault(place, reason_of(error))])
