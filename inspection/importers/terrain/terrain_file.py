"""Opens a terrain file: a GeoTIFF, an HGT file, or a zip of several of them as one model."""

import gzip
import re
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import IO

import numpy as np

from inspection.importers.archive import Archive, opened_archive
from inspection.importers.rows import AssetFileError
from inspection.importers.terrain.geotiff import GeoTiff, TiffReader
from inspection.importers.terrain.raster import DatumFault, Raster, TerrainFileError, Window, datum_named, window_of
from inspection.importers.terrain.resampling import DEGREE_M, placed
from inspection.importers.xml_root import leads_elsewhere, root_of
from operation.reasons import Reason

VERTICAL_DATUM = "EGM96"  # SRTM, and data distributed in its format
VOID = -32768
SIZES = {1201 * 1201 * 2: 1201, 3601 * 3601 * 2: 3601}  # 3 and 1 arc seconds
_NAME = re.compile(r"([NS])(\d{2})([EW])(\d{3})", re.IGNORECASE)
MAX_MEMBERS = 100
MAX_UNPACKED_BYTES = 512 * 1024 * 1024
DEFLATE_LIMIT = 1_032  # open sea compresses that much; the unpacked size is limited instead
MAX_TIFF_RATIO, FREE_TIFF_BYTES = 100, 16 * 1024 * 1024
NEEDS_DATUM = "The file does not say from where its heights count. Say it: EGM96, EGM2008, or the name of another vertical datum."
_TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")  # classic and BigTIFF
_ZIP_START, _GZIP_START = b"PK", b"\x1f\x8b"
_TIFF_ENDINGS, _HGT_ENDING, _TABLES = (".tif", ".tiff"), ".hgt", (".txt", ".xml", ".prj", ".tfw", ".md", ".html", ".pdf", ".png", ".jpg")
_CHUNK = 1024 * 1024


class HgtRaster:
    """Reads from an open file; see raster.Raster."""

    def __init__(self, file: IO[bytes], name: str) -> None:
        size = file.seek(0, 2)
        match, side = _NAME.match(name), SIZES.get(size)
        if match is None or side is None:
            raise TerrainFileError("An HGT file is named after its corner, such as N47E009.hgt, and has 1201 or 3601 posts a side.")
        south = float(match[2]) * (1 if match[1].upper() == "N" else -1)
        west = float(match[4]) * (1 if match[3].upper() == "E" else -1)
        if not (-90 <= south < 90 and -180 <= west < 180):
            raise TerrainFileError(f"{match[0]} is not on earth.")
        self._file = file
        self.width = self.height = side
        self.west_deg, self.north_deg = west, south + 1.0
        self.step_lon_deg = self.step_lat_deg = 1.0 / (side - 1)

    def window(self, row: int, column: int, rows: int, columns: int) -> Window:
        raw = np.empty((rows, columns), dtype=">i2")
        for line in range(rows):
            self._file.seek(((row + line) * self.width + column) * 2)
            raw[line] = np.frombuffer(self._file.read(columns * 2), dtype=">i2")
        return window_of(raw, VOID)


@dataclass
class TerrainFile:
    """An open terrain file. rasters are read while it is open. vertical_datum: from the file or its format; None where neither has one."""

    file_format: str
    rasters: list[Raster] = field(default_factory=list)
    vertical_datum: str | None = None
    reference_systems: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def resolution_m(self) -> float:
        """Return the distance between posts from north to south, of the finest raster [m]."""
        return min(raster.step_lat_deg for raster in self.rasters) * DEGREE_M


@contextmanager
def opened_terrain(path: Path) -> Iterator[TerrainFile]:
    """Open a terrain file. Raises TerrainFileError for an invalid one, here or during reading."""
    with ExitStack() as stack:
        file = stack.enter_context(path.open("rb"))
        reader = TiffReader()
        stack.callback(reader.close)
        start = file.read(4)
        try:
            if start.startswith(_ZIP_START):
                yield _several(stack, path, reader)
            elif start.startswith(_GZIP_START) and path.name.lower().endswith(".hgt.gz"):
                yield _one(stack.enter_context(_gunzipped(path)), path.name, reader)
            else:
                yield _one(file, path.name, reader)
        except AssetFileError as error:
            raise TerrainFileError(str(error)) from error


def datum_of(file: TerrainFile, stated: str) -> str:
    """Return the vertical datum of the heights: as the file states it, else as the user does. Raises TerrainFileError."""
    named = datum_named(stated) if stated.strip() else ""
    if file.vertical_datum is not None:
        return file.vertical_datum
    if not named:
        raise DatumFault(NEEDS_DATUM)
    return named


def _one(file: IO[bytes], name: str, reader: TiffReader) -> TerrainFile:
    file.seek(0)
    start = file.read(4096)
    if start.startswith(_TIFF_STARTS):
        tiff = GeoTiff(file, reader)
        raster, notes = placed(tiff)
        return TerrainFile("GeoTIFF", [raster], tiff.vertical_datum, [tiff.system.name], notes)
    if name.lower().removesuffix(".gz").endswith(_HGT_ENDING):
        return TerrainFile("HGT", [HgtRaster(file, name)], VERTICAL_DATUM, ["WGS 84"])
    raise TerrainFileError(leads_elsewhere(root_of(start)[0]) or Reason("no_terrain_format"))


def _several(stack: ExitStack, path: Path, reader: TiffReader) -> TerrainFile:
    archive = stack.enter_context(opened_archive(path, most_ratio=DEFLATE_LIMIT))
    names = _members(archive)
    whole = TerrainFile("zip")
    stated: dict[str | None, str] = {}
    for name in names:
        file = stack.enter_context(archive.unpacked(name))
        try:
            part = _one(file, PurePosixPath(name.replace("\\", "/")).name, reader)
        except TerrainFileError as error:
            raise TerrainFileError(f"{name}: {error}") from error
        stated.setdefault(part.vertical_datum, name)
        whole.rasters += part.rasters
        whole.reference_systems += [system for system in part.reference_systems if system not in whole.reference_systems]
        whole.notes += [note for note in part.notes if note not in whole.notes]
        whole.file_format = part.file_format
    if len(stated) > 1:
        words = ", ".join(f"{name}: {datum or 'not stated'}" for datum, name in stated.items())
        raise TerrainFileError(f"The files of the zip count their heights from different places ({words}). Send them one by one.")
    whole.vertical_datum = next(iter(stated))
    return whole


def _members(archive: Archive) -> list[str]:
    names = [name for name in archive.names if name.lower().endswith((*_TIFF_ENDINGS, _HGT_ENDING)) and not name.startswith("__MACOSX/")]
    strange = [
        name for name in archive.names if name not in names and not name.lower().endswith(_TABLES) and not name.startswith("__MACOSX/")
    ]
    if not names:
        found = f", but {strange[0][:60]}" if strange else ""
        raise TerrainFileError(f"There is no GeoTIFF or HGT file in the zip{found}.")
    if len(names) > MAX_MEMBERS:
        raise TerrainFileError(f"The zip has {len(names)} terrain files; at most {MAX_MEMBERS} are taken at once.")
    if sum(map(archive.size_of, names)) > MAX_UNPACKED_BYTES:
        raise TerrainFileError(f"The zip unpacks to more than {MAX_UNPACKED_BYTES // 2**20} MiB. Send its files in several.")
    tiff_bytes = sum(archive.size_of(name) for name in names if not name.lower().endswith(_HGT_ENDING))
    if tiff_bytes > max(FREE_TIFF_BYTES, MAX_TIFF_RATIO * archive.packed_bytes):
        raise TerrainFileError(f"The zip unpacks to more than {MAX_TIFF_RATIO} times its size; refused as a decompression bomb.")
    for name in names:
        if name.lower().endswith(_HGT_ENDING) and archive.size_of(name) not in SIZES:
            raise TerrainFileError(f"{name[:100]} has not 1201 or 3601 posts a side.")
    return sorted(names)


@contextmanager
def _gunzipped(path: Path) -> Iterator[IO[bytes]]:
    """Yield the content of a .hgt.gz as an unnamed file, at most as large as the largest HGT file."""
    left = max(SIZES)
    with tempfile.TemporaryFile() as target:
        try:
            with gzip.open(path) as packed:
                while chunk := packed.read(min(_CHUNK, left + 1)):
                    left -= len(chunk)
                    if left < 0:
                        raise TerrainFileError("The file unpacks to more than 3601 posts a side.")
                    target.write(chunk)
        except (gzip.BadGzipFile, zlib.error, EOFError) as error:
            raise TerrainFileError("The file cannot be unpacked: it is damaged or cut off.") from error
        yield target
