"""Rows of assets or zones, and their texts as CSV and GeoJSON."""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from inspection.exporters.text_pieces import Value, cell, collection_pieces, csv_pieces

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


def rows_as_csv(rows: Iterable[ExportRow], columns: Columns) -> Iterator[str]:
    """Yield a table with a position instead of the geometry."""
    return csv_pieces(
        ["id", *columns, "longitude_deg", "latitude_deg"],
        ([row.key, *(cell(row.values.get(name)) for name in columns), f"{row.longitude:.7f}", f"{row.latitude:.7f}"] for row in rows),
    )


def rows_as_geojson(rows: Iterable[ExportRow], columns: Columns) -> Iterator[str]:
    return collection_pieces(_feature(row, columns) for row in rows)


def _feature(row: ExportRow, columns: Columns) -> str:
    properties = json.dumps({name: row.values.get(name) for name in columns}, ensure_ascii=False)
    return f'{{"type":"Feature","id":{row.key},"geometry":{row.geometry},"properties":{properties}}}'
