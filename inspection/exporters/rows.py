"""Rows of assets or zones that are written to a file."""

from collections.abc import Mapping
from dataclasses import dataclass

Value = str | int | float | bool | None
Columns = Mapping[str, str]  # name to SQL type


@dataclass(frozen=True, slots=True)
class ExportRow:
    """layer: the table of a GeoPackage. geometry: GeoJSON, WGS84. values: by column; missing ones are not stated."""

    layer: str
    key: int
    geometry: str
    longitude: float
    latitude: float
    values: Mapping[str, Value]
