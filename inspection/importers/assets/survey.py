"""What is in an asset file, for somebody who has to say what its columns mean: columns with samples, kinds of geometry, a first look."""

import json
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import shapely

from inspection.importers.assets.asset_file import Row, Shape
from inspection.importers.assets.delimited import number_of
from inspection.importers.rows import Cell

MAX_SAMPLES = 5
MAX_VALUES = 50  # different values that are counted of a column; one with more tells no kinds apart
PREVIEW_ROWS = 500
PREVIEW_VERTICES = 20_000
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}([T ].*)?|\d{1,2}\.\d{1,2}\.\d{4}")
_FAMILIES = {"Point": "points", "LineString": "lines", "MultiLineString": "lines", "MultiPolygon": "areas"}


@dataclass
class ColumnSurvey:
    name: str
    samples: list[Cell] = field(default_factory=list)
    types: Counter[str] = field(default_factory=Counter)
    values: Counter[str] | None = field(default_factory=Counter)  # None once there are too many
    filled: int = 0

    def see(self, value: Cell) -> None:
        if value is None or value == "":
            return
        self.filled += 1
        self.types[_type_of(value)] += 1
        if len(self.samples) < MAX_SAMPLES and value not in self.samples:
            self.samples.append(value)
        if self.values is not None:
            self.values[str(value)] += 1
            if len(self.values) > MAX_VALUES:
                self.values = None

    @property
    def type(self) -> str:
        if not self.types:
            return "empty"
        if set(self.types) <= {"whole number", "number"}:
            return "number" if self.types["number"] else "whole number"
        return next(iter(self.types)) if len(self.types) == 1 else "text"


@dataclass
class Survey:
    columns: dict[str, ColumnSurvey]
    rows: int = 0
    without_geometry: int = 0
    geometries: Counter[str] = field(default_factory=Counter)  # points, lines, areas
    preview: list[dict[str, Any]] = field(default_factory=list)  # GeoJSON features
    extent: tuple[float, float, float, float] | None = None


def survey_of(rows: Iterable[Row], columns: Iterable[str] = ()) -> Survey:
    """Look at every row once, keeping next to nothing."""
    found = Survey({name: ColumnSurvey(name) for name in columns})
    vertices = 0
    for row in rows:
        found.rows += 1
        for name, value in row.properties.items():
            if name not in found.columns:
                found.columns[name] = ColumnSurvey(name)
            found.columns[name].see(value)
        if row.geometry is None:
            found.without_geometry += 1
            continue
        found.geometries[_FAMILIES[row.geometry.geom_type]] += 1
        found.extent = _grown(found.extent, row.geometry.bounds)
        if len(found.preview) < PREVIEW_ROWS and vertices < PREVIEW_VERTICES:
            vertices += int(shapely.get_num_coordinates(row.geometry))
            found.preview.append(_feature(row, row.geometry))
    return found


def _feature(row: Row, shape: Shape) -> dict[str, Any]:
    geometry = json.loads(shapely.to_geojson(shape))
    return {"type": "Feature", "properties": {"place": row.place, **row.properties}, "geometry": geometry}


def _grown(extent: tuple[float, float, float, float] | None, bounds: Any) -> tuple[float, float, float, float]:
    west, south, east, north = (float(bound) for bound in bounds)
    if extent is None:
        return west, south, east, north
    return min(extent[0], west), min(extent[1], south), max(extent[2], east), max(extent[3], north)


def _type_of(value: Cell) -> str:
    if isinstance(value, bool):
        return "yes or no"
    if isinstance(value, int):
        return "whole number"
    if isinstance(value, float):
        return "whole number" if value.is_integer() else "number"
    text = str(value)
    if _DATE.fullmatch(text):
        return "date"
    number = number_of(text)
    if number is None:
        return "text"
    return "whole number" if number.is_integer() else "number"
