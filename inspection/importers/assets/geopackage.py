"""GeoPackage: an SQLite file, opened read-only so that nothing in it runs: plain tables only, no views, functions or triggers."""

import sqlite3
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

from pyproj import CRS

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.assets.reference_systems import system_of_code, system_of_wkt
from inspection.importers.assets.wkb import geometry_of_wkb
from inspection.importers.rows import MAX_ROW_CHARACTERS, MAX_ROWS, Columns, RawRow, RowSource, plain_cell, refused

_STEPS_BETWEEN_LOOKS = 10_000
_MAX_STEPS = 50_000_000  # SQLite's virtual machine steps for one query; a real table of 200,000 rows needs a fifth
_CACHE_KIB = 4 * 1024
_ALLOWED = {sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ}
_ENVELOPE_BYTES = {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}
_UNDEFINED = {-1, 0}


@contextmanager
def geopackage_source(path: Path, layer: str, *, has_system: bool) -> Iterator[RowSource]:
    """Open a layer. has_system: the user names the reference system, so an undefined one is no fault. Raises AssetFileError."""
    _refuse_if_cut_off(path)
    database = sqlite3.connect(f"file:{quote(str(path))}?mode=ro&immutable=1", uri=True)
    try:
        _lock_down(database)
        layers = _layers(database)
        if not layers:
            raise refused("", "the GeoPackage has no layer with geometries")
        name = layer if layer in layers else next(iter(layers))
        geometry_column, system_id = layers[name]
        columns = _columns(database, name)
        if geometry_column not in columns:
            raise refused(name, f"the table has no column {geometry_column[:40]!r}")
        shown = tuple(column for column in columns if column != geometry_column)
        Columns().check(shown, name)
        system = None if has_system else _system(database, system_id, name)
        yield RowSource(
            "geopackage", lambda: _rows(database, name, geometry_column, shown), crs=system, layer=name, layers=tuple(layers)
        )  # fmt: skip
    except sqlite3.Error as error:
        raise refused("", f"the GeoPackage is damaged or does what it may not: {str(error)[:120]}") from error
    finally:
        database.close()


def _refuse_if_cut_off(path: Path) -> None:
    """Refuse a truncated file, which SQLite reads without an error (file format, 1.3.2 and 1.3.7: size and number of pages)."""
    with path.open("rb") as file:
        head = file.read(100)
    page_bytes, pages = (struct.unpack_from(">H", head, 16)[0], struct.unpack_from(">I", head, 28)[0]) if len(head) == 100 else (1, 2**32)
    if path.stat().st_size < (65_536 if page_bytes == 1 else page_bytes) * pages:
        raise refused("", "the GeoPackage is damaged or cut off: pages are missing")


def _lock_down(database: sqlite3.Connection) -> None:
    for pragma in (
        "trusted_schema=OFF",
        "query_only=ON",
        "cell_size_check=ON",
        "mmap_size=0",
        "temp_store=MEMORY",
        f"cache_size=-{_CACHE_KIB}",
    ):
        database.execute(f"PRAGMA {pragma}")
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, 4 * MAX_ROW_CHARACTERS)
    database.setlimit(sqlite3.SQLITE_LIMIT_COLUMN, 500)
    database.setlimit(sqlite3.SQLITE_LIMIT_EXPR_DEPTH, 20)
    database.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, 0)
    database.setlimit(sqlite3.SQLITE_LIMIT_TRIGGER_DEPTH, 0)
    database.text_factory = lambda data: data.decode("utf-8", errors="replace")
    database.set_authorizer(lambda action, *_: sqlite3.SQLITE_OK if action in _ALLOWED else sqlite3.SQLITE_DENY)


def _ask(database: sqlite3.Connection, query: str, values: tuple[Any, ...] = ()) -> sqlite3.Cursor:
    """Run a query that is stopped at _MAX_STEPS."""
    looks = 0

    def look() -> int:
        nonlocal looks
        looks += 1
        return int(looks * _STEPS_BETWEEN_LOOKS > _MAX_STEPS)

    database.set_progress_handler(look, _STEPS_BETWEEN_LOOKS)
    return database.execute(query, values)


def _check_plain(database: sqlite3.Connection, table: str) -> None:
    """Refuse a view or a virtual table, which would run its author's SQL."""
    found = _ask(
        database, "SELECT type, sql FROM sqlite_master WHERE name = ? COLLATE NOCASE AND type IN ('table', 'view')", (table,)
    ).fetchall()
    if not found:
        raise refused(table[:60], "the GeoPackage has no such table")
    kind, statement = found[0]
    words = str(statement or "").upper().split()[:2]
    if len(found) > 1 or kind != "table" or words != ["CREATE", "TABLE"]:
        raise refused(table[:60], "this is a view or a virtual table; export it as a plain table")


def _layers(database: sqlite3.Connection) -> dict[str, tuple[str, int]]:
    for table in ("gpkg_contents", "gpkg_geometry_columns", "gpkg_spatial_ref_sys"):
        _check_plain(database, table)
    rows = _ask(
        database,
        "SELECT c.table_name, g.column_name, g.srs_id FROM gpkg_contents c JOIN gpkg_geometry_columns g ON g.table_name = c.table_name "
        "WHERE c.data_type = 'features' ORDER BY c.rowid LIMIT 100",
    ).fetchall()
    layers = {str(table): (str(column), int(system)) for table, column, system in rows if isinstance(system, int)}
    for table in layers:
        _check_plain(database, table)
    return layers


def _columns(database: sqlite3.Connection, table: str) -> list[str]:
    """Return the columns without generated ones, which would have to be computed."""
    database.set_authorizer(None)
    try:
        rows = database.execute(f"PRAGMA table_xinfo({_quoted(table)})").fetchall()
    finally:
        database.set_authorizer(lambda action, *_: sqlite3.SQLITE_OK if action in _ALLOWED else sqlite3.SQLITE_DENY)
    return [str(row[1]) for row in rows if row[6] == 0]


def _system(database: sqlite3.Connection, system_id: int, table: str) -> CRS | None:
    row = None
    if system_id not in _UNDEFINED:
        row = _ask(
            database, "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?", (system_id,)
        ).fetchone()
    if row is None:
        raise refused(
            table[:60], "the layer does not say in which reference system it is: name it, such as EPSG:2056"
        )  # fmt: skip
    if str(row[0]).upper() == "EPSG":
        return system_of_code(f"EPSG:{row[1]}", table[:60])
    return system_of_wkt(str(row[2]), table[:60])


def _rows(database: sqlite3.Connection, table: str, geometry_column: str, columns: tuple[str, ...]) -> Iterator[RawRow]:
    wanted = ", ".join(_quoted(column) for column in (geometry_column, *columns))
    try:
        cursor = _ask(database, f"SELECT {wanted} FROM {_quoted(table)} LIMIT {MAX_ROWS + 1}")  # noqa: S608 -- names are quoted
        for number, row in enumerate(cursor, start=1):
            place = f"{table[:60]}, row {number}"
            if number > MAX_ROWS:
                raise refused(place, f"the layer has more than {MAX_ROWS} rows")
            properties = {
                column: plain_cell(value, place) for column, value in zip(columns, row[1:], strict=True) if not isinstance(value, bytes)
            }
            yield RawRow(place, properties, _geometry(row[0], place))
    except sqlite3.Error as error:
        raise refused(table[:60], f"the table is damaged or does what it may not: {str(error)[:120]}") from error


def _geometry(blob: Any, place: str) -> dict[str, Any] | GeometryFault | None:
    """Return the geometry of a blob. OGC 12-128r18, 2.1.3: "GP", version, flags, reference system, envelope, then WKB."""
    if blob is None:
        return None
    if not isinstance(blob, bytes) or len(blob) < 8 or blob[:2] != b"GP" or blob[2] != 0:
        return GeometryFault(place, "the geometry is none as GeoPackage has it")
    flags = blob[3]
    envelope = _ENVELOPE_BYTES.get(flags >> 1 & 0b111)
    if envelope is None or flags & 0b100000:
        return GeometryFault(place, "the geometry is of an extended kind that is not read")
    if flags & 0b10000:
        return None
    try:
        return geometry_of_wkb(blob[8 + envelope :], place)
    except GeometryFault as fault:
        return fault


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
