"""Rows of asset files: plain values with a GeoJSON geometry, and the faults for which a file is refused."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from pyproj import CRS

from inspection.geodesy.geometry_validator import GeometryFault
from operation.reasons import Reason

MAX_ROWS = 200_000
MAX_COLUMNS = 200
MAX_COLUMN_NAME = 100
MAX_TEXT = 1_000  # characters of one value; longer ones are cut
MAX_ROW_CHARACTERS = 1024 * 1024  # of a row in a text file; 10,000 vertices need half of it

Cell = str | int | float | bool | None


class AssetFileError(ValueError):
    """Raised for a file that is refused as a whole; each fault has its place."""

    def __init__(self, faults: Iterable[GeometryFault]) -> None:
        self.faults = list(faults)
        super().__init__("; ".join(str(fault) for fault in self.faults))


class FaultyRows(AssetFileError):
    """Raised for a file that can be read without the rows that have these faults."""


def refused(place: str, message: Reason | str) -> AssetFileError:
    return AssetFileError([GeometryFault(place, message)])


@dataclass(frozen=True)
class RawRow:
    """One row of a file. geometry is an unvalidated GeoJSON geometry in the file's reference system, or the fault for which there is

    none.
    """

    place: str
    properties: dict[str, Cell]
    geometry: dict[str, Any] | GeometryFault | None


@dataclass
class RowSource:
    """An open file. rows may be called repeatedly; each call reads the file from its start."""

    file_format: str
    rows: Callable[[], Iterator[RawRow]]
    crs: CRS | None = None  # None: longitude and latitude in WGS84
    layer: str = ""
    layers: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)
    geometry_columns: dict[str, str] = field(default_factory=dict)  # of a table: {"lon", "lat"} or {"wkt"}
    columns: tuple[str, ...] = ()  # of a table: all of them, including the geometry's
    first_cells: dict[str, str] = field(default_factory=dict)  # of a table: its first row


def plain_cell(value: Any, place: str) -> Cell:
    """Return a value that the database can store: no null character, no unpaired surrogate, limited length, no NaN."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int):
        return value if abs(value) < 2**63 else str(value)[:MAX_TEXT] if abs(value) < 10**300 else None
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    text = str(value)[:MAX_TEXT]
    if "\0" in text:
        raise refused(place, "a text has a null character")
    if not text.isascii() and any("\ud800" <= character <= "\udfff" for character in text):
        raise refused(place, "a text has half of a character that takes two")
    return text.strip()


class Columns:
    """Validates the names of columns as rows arrive."""

    def __init__(self) -> None:
        self._known: set[str] = set()

    def check(self, names: Iterable[str], place: str) -> None:
        for name in names:
            if name in self._known:
                continue
            if len(name) > MAX_COLUMN_NAME or not name.isprintable():
                raise refused(
                    place, f"the column {name[:40]!r} has no usable name; at most {MAX_COLUMN_NAME} printable characters are taken"
                )
            if len(self._known) >= MAX_COLUMNS:
                raise refused(place, f"the file has more than {MAX_COLUMNS} columns")
            self._known.add(name)


def unique_names(names: Iterable[str]) -> tuple[str, ...]:
    """Return unique names: a second "type" becomes "type 2", an empty name its position."""
    found: list[str] = []
    for number, stated in enumerate(names, start=1):
        name = base = " ".join(stated.split()) or f"column {number}"
        again = 2
        while name in found:
            name = f"{base} {again}"
            again += 1
        found.append(name)
    return tuple(found)


MAX_FAULTS = 50


class TooManyFaults(Exception):
    pass


@dataclass
class FaultList:
    faults: list[GeometryFault] = field(default_factory=list)

    @contextmanager
    def gathering(self) -> Iterator[None]:
        """Store a fault of the block and continue after it. Raises TooManyFaults at the limit."""
        try:
            yield
        except GeometryFault as fault:
            self.faults.append(fault)
            if len(self.faults) >= MAX_FAULTS:
                raise TooManyFaults from fault
