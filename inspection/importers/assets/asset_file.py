"""Opens asset files of every format, which it detects from the content, and validates the geometry of each row."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import shapely
from shapely import LineString, MultiLineString, MultiPolygon, Point

from inspection.geodesy.geometry_validator import MAX_LINE_VERTICES, GeometryFault, VertexBudget, checked_geometry, checked_line
from inspection.importers.archive import Archive, opened_archive
from inspection.importers.assets.delimited import delimited_source
from inspection.importers.assets.gdal_formats import format_of_start, gdal_file_source, geodatabase_source, has_geodatabase
from inspection.importers.assets.geojson import geojson_source
from inspection.importers.assets.geopackage import geopackage_source
from inspection.importers.assets.kml import kml_source
from inspection.importers.assets.reference_systems import ROUGH_M, ToWgs84, name_of_system, system_of_code
from inspection.importers.assets.shapefiles import shapefile_source
from inspection.importers.rows import MAX_FAULTS, MAX_ROWS, Cell, FaultyRows, RawRow, RowSource, refused

MAX_VERTICES = 2_000_000
MAX_PARTS = 5_000  # lines of one row
_START_BYTES = 64 * 1024  # with the first element of an XML document

Shape = Point | LineString | MultiLineString | MultiPolygon


@dataclass(frozen=True)
class Row:
    """A row. geometry is in WGS84, lon lat, validated; None where the file has none."""

    place: str
    properties: dict[str, Cell]
    geometry: Shape | None


@dataclass
class RowFaults:
    """Collects the faults of rows. With permission faulty rows are skipped and counted; otherwise they refuse the file."""

    leave_out: bool = False
    faults: list[GeometryFault] = field(default_factory=list)
    number: int = 0

    def add(self, fault: GeometryFault) -> None:
        self.number += 1
        if len(self.faults) < MAX_FAULTS:
            self.faults.append(fault)
        elif not self.leave_out:
            raise FaultyRows(self.faults)

    def refuse_if_any(self) -> None:
        if self.faults and not self.leave_out:
            raise FaultyRows(self.faults)


class AssetFile:
    """An open file whose rows can be read repeatedly, each time from the start."""

    def __init__(self, source: RowSource, crs_name: str, to_wgs84: ToWgs84 | None) -> None:
        self.source = source
        self.crs_name = crs_name
        self._to_wgs84 = to_wgs84
        self.notes = list(source.notes)
        if to_wgs84 is not None and to_wgs84.accuracy_m is not None and to_wgs84.accuracy_m > ROUGH_M:
            self.notes.append(f"Positions may be off by {to_wgs84.accuracy_m:.0f} m: the exact grid of {crs_name} is not installed.")

    def rows(self, faults: RowFaults) -> Iterator[Row]:
        """Yield each row with its validated geometry; rows with a fault are skipped. Raises AssetFileError for faults of the whole file."""
        budget = VertexBudget(MAX_VERTICES, MAX_ROWS)
        for number, raw in enumerate(self.source.rows(), start=1):
            if number > MAX_ROWS:
                raise refused(raw.place, f"the file has more than {MAX_ROWS} rows")
            try:
                yield Row(raw.place, raw.properties, self._shape(raw, budget))
            except GeometryFault as fault:
                faults.add(fault)

    def _shape(self, raw: RawRow, budget: VertexBudget) -> Shape | None:
        geometry = raw.geometry
        if geometry is None:
            return None
        if isinstance(geometry, GeometryFault):
            raise geometry
        is_json = self.source.file_format == "geojson"
        place = f"{raw.place}.geometry" if is_json else raw.place
        try:
            if self._to_wgs84 is not None:
                geometry = self._to_wgs84.geometry(geometry, place)
            shape = checked_shape(geometry, place)
            budget.take(int(shapely.get_num_coordinates(shape)), place)
        except GeometryFault as fault:
            if is_json:
                raise
            where = fault.place.removesuffix(".coordinates").replace(".coordinates", ", coordinates ")
            raise GeometryFault(where, fault.why, fault.position) from fault
        return shape


@contextmanager
def opened_asset_file(path: Path, *, crs: Any = None, geometry_columns: Any = None, layer: str = "") -> Iterator[AssetFile]:
    """Open a file. crs, such as EPSG:2056, overrides the file's own. Raises AssetFileError."""
    stated = system_of_code(crs, "crs") if crs else None
    with ExitStack() as stack:
        source = stack.enter_context(_source(path, geometry_columns, layer, has_system=bool(crs)))
        if crs:
            source.crs = stated
        to_wgs84 = ToWgs84(source.crs) if source.crs is not None else None
        file = AssetFile(source, name_of_system(source.crs), to_wgs84)
        if source.file_format == "csv" and not crs:
            _refuse_if_no_degrees(source)
        yield file


def checked_shape(value: dict[str, Any], place: str) -> Shape:
    """Return the validated geometry; a line in several parts is joined where they meet. Raises GeometryFault."""
    kind = value.get("type")
    members = value.get("geometries") if kind == "GeometryCollection" else None
    if isinstance(members, list) and len(members) == 1 and isinstance(members[0], dict) and "geometries" not in members[0]:
        return checked_shape(members[0], place)
    coordinates = value.get("coordinates")
    if kind == "MultiPoint" and isinstance(coordinates, list) and len(coordinates) == 1:
        return checked_geometry({"type": "Point", "coordinates": coordinates[0]}, place)
    if kind != "MultiLineString":
        return checked_geometry(value, place)
    if not isinstance(coordinates, list) or not coordinates:
        raise GeometryFault(f"{place}.coordinates", "the geometry is empty")
    if len(coordinates) > MAX_PARTS:
        raise GeometryFault(place, f"the line has {len(coordinates)} parts; at most {MAX_PARTS} are taken")
    parts = MultiLineString([checked_line(part, f"{place}.coordinates[{index}]") for index, part in enumerate(coordinates)])
    joined = shapely.line_merge(parts)
    if isinstance(joined, LineString) and len(joined.coords) <= MAX_LINE_VERTICES:
        return joined
    if isinstance(joined, MultiLineString) and all(len(part.coords) <= MAX_LINE_VERTICES for part in joined.geoms):
        return joined
    return parts


def _source(path: Path, geometry_columns: Any, layer: str, *, has_system: bool) -> Any:
    with path.open("rb") as file:
        start = file.read(_START_BYTES)
    if not start.strip():
        raise refused("", "the file is empty")
    if start.startswith(b"SQLite format 3\0"):
        return geopackage_source(path, layer, has_system=has_system)
    if start.startswith(b"PK"):
        return _zipped(path, layer, has_system=has_system)
    if file_format := format_of_start(start):
        return gdal_file_source(path, file_format, layer, has_system=has_system)
    text = start.removeprefix(b"\xef\xbb\xbf").lstrip()
    if text.startswith((b"{", b"[")):
        return _plain(lambda: geojson_source(path))
    if text.startswith(b"<") or start.startswith((b"\xff\xfe<", b"\xfe\xff\x00<")):
        return _plain(lambda: kml_source(lambda: path.open("rb")))
    return _plain(lambda: delimited_source(path, geometry_columns))


@contextmanager
def _plain(make: Callable[[], RowSource]) -> Iterator[RowSource]:
    yield make()


@contextmanager
def _zipped(path: Path, layer: str, *, has_system: bool) -> Iterator[RowSource]:
    with opened_archive(path) as archive:
        if any(name.lower().endswith(".shp") for name in archive.names):
            with shapefile_source(archive, layer, has_system=has_system) as source:
                yield source
        elif has_geodatabase(archive):
            with geodatabase_source(archive, layer, has_system=has_system) as source:
                yield source
        elif name := _kml_of(archive):
            with archive.unpacked(name) as file:
                yield kml_source(lambda: _again(file), "kmz")
        else:
            raise refused("", "the archive holds neither a shapefile nor a KML document nor a File Geodatabase")


@contextmanager
def _again(file: Any) -> Iterator[Any]:
    file.seek(0)
    yield file


def _kml_of(archive: Archive) -> str | None:
    """Return the document of a KMZ file: doc.kml, or the first one at the top level."""
    names = sorted(
        (name for name in archive.names if name.lower().endswith(".kml")), key=lambda name: (len(PurePosixPath(name).parts), name)
    )
    return next((name for name in names if name.lower() == "doc.kml"), names[0] if names else None)


def _refuse_if_no_degrees(source: RowSource) -> None:
    """Refuse coordinates that are not degrees, judged by the first position, instead of reporting a fault for each row."""
    row = next(source.rows(), None)
    if row is None or not isinstance(row.geometry, dict) or row.geometry["type"] != "Point":
        return
    x, y = row.geometry["coordinates"][:2]
    if abs(x) > 360 and abs(y) > 360:
        raise refused(row.place, f"{x:.10g}, {y:.10g} are no degrees: name the reference system of the columns, such as EPSG:2056")
