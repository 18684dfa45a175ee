"""GeoTIFF heights: one band, read window by window by GDAL in a process with limits. Source: OGC GeoTIFF 1.1, OGC 19-008r4."""

from typing import IO, Any

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS
from pyproj.exceptions import CRSError

from inspection.importers.gdal_process import GdalProcess, GdalRefusal, started
from inspection.importers.terrain.raster import (
    PostKind,
    TerrainFileError,
    Window,
    datum_of_system,
    metres_of_system,
    refuse_if_ellipsoidal,
    window_of,
)
from operation.reasons import Reason

MAX_POSTS = 200_000_000
MAX_PARTS = 1_000_000
MAX_PART_BYTES = 16 * 1024 * 1024  # unpacked
MAX_PLAIN_PART_BYTES = 128 * 1024 * 1024  # of a part that is not packed
POSTS_PER_PROCESSOR_S = 4_000_000  # a third of what is measured, as posts are read several times where they are sampled anew
_READ = {"", "LZW", "DEFLATE", "PACKBITS", "ZSTD", "LZMA", "LERC", "LERC_DEFLATE", "LERC_ZSTD"}
_PER_DATASET_MASK = 0x02  # GMF_PER_DATASET
_UNITS = {
    "m": 1.0, "metre": 1.0, "meter": 1.0, "metres": 1.0, "meters": 1.0, "ft": 0.3048, "foot": 0.3048, "feet": 0.3048,
    "us-ft": 1200 / 3937, "us survey foot": 1200 / 3937, "ftus": 1200 / 3937,
}  # fmt: skip
_TO_WGS84 = "gdalwarp -t_srs EPSG:4326"


class TiffReader:
    """The child of the GeoTIFF that was read last, so that an archive of a hundred takes the memory of one."""

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None
        self._process: GdalProcess | None = None
        self._head: dict[str, Any] = {}

    def head(self, file: IO[bytes]) -> dict[str, Any]:
        self._turn_to(file)
        return self._head

    def window(self, file: IO[bytes], window: tuple[int, int, int, int], size_bytes: int) -> tuple[list[list[int]], bytes]:
        """Return the absent parts and the values of a window: column, row, columns, rows. Raises TerrainFileError."""
        process = self._turn_to(file)
        try:
            process.ask(window)
            return process.line()["absent"], process.data(size_bytes)
        except GdalRefusal as refusal:
            raise _refused("A part of the TIFF cannot be unpacked: it is damaged or cut off", refusal) from refusal

    def close(self) -> None:
        if self._process is not None:
            self._process.close()
        self._file = self._process = None

    def _turn_to(self, file: IO[bytes]) -> GdalProcess:
        if self._process is not None and self._file is file:
            return self._process
        self.close()
        self._process, self._file = started("GTiff", {"file.tif": file}), file
        try:
            self._head = self._process.line()
        except GdalRefusal as refusal:
            raise _refused("The TIFF is damaged or cut off", refusal) from refusal
        posts = min(self._head["width"] * self._head["height"], MAX_POSTS)
        self._process.allow_processor(posts // POSTS_PER_PROCESSOR_S)
        return self._process


class GeoTiff:
    """A GeoTIFF. Coordinates are those of `system`; see raster.Raster for windows.

    x, y of a post: (x + column * step_x, y - row * step_y).
    """

    def __init__(self, file: IO[bytes], reader: TiffReader) -> None:
        self._file, self._reader = file, reader
        head = reader.head(file)
        self.width, self.height = int(head["width"]), int(head["height"])
        self._check_size(head)
        self._dtype = _sample_type(head)
        self._check_packing(head)
        self.system, vertical = _reference_systems(head)
        self.x, self.y, self.step_x, self.step_y = _place(head)
        self.vertical_datum = datum_of_system(vertical)
        self._void: float | None = head["void"]
        self._factor, self._offset_m = _to_metres(head, metres_of_system(vertical))

    def window(self, row: int, column: int, rows: int, columns: int) -> Window:
        size_bytes = rows * columns * self._dtype.itemsize
        absent, values = self._reader.window(self._file, (column, row, columns, rows), size_bytes)
        raw: NDArray[Any] = np.frombuffer(values, dtype=self._dtype).reshape(rows, columns)
        window = window_of(raw, self._void, scale=self._factor, offset_m=self._offset_m)
        for left, top, across, down in absent:  # not in the file: a sparse one omits empty parts
            part = slice(top - row, top - row + down), slice(left - column, left - column + across)
            window.heights_m[part] = np.nan
            window.kinds[part] = PostKind.DECLARED_VOID
        return window

    def _check_size(self, head: dict[str, Any]) -> None:
        if self.width < 2 or self.height < 2:
            raise TerrainFileError("The GeoTIFF has fewer than two rows or columns.")
        if self.width * self.height > MAX_POSTS:
            raise TerrainFileError(f"The GeoTIFF has {self.width} × {self.height} posts; at most {MAX_POSTS} are taken. Cut it into parts.")
        if head["bands"] != 1:
            raise TerrainFileError(f"A terrain model has one band; this file has {head['bands']}.")
        if head["mask"] & _PER_DATASET_MASK:
            raise TerrainFileError(
                "The GeoTIFF tells its voids by a mask. Write them as a value first: gdal_translate -mask none -a_nodata -9999"
            )

    def _check_packing(self, head: dict[str, Any]) -> None:
        packing = head["packing"]
        if packing not in _READ:
            raise TerrainFileError(
                f"The GeoTIFF is packed with {packing}, which is not read. Pack it with deflate: gdal_translate -co COMPRESS=DEFLATE"
            )
        columns, rows = head["part"]
        parts = -(-self.width // columns) * -(-self.height // rows)
        if parts > MAX_PARTS:
            raise TerrainFileError(f"The GeoTIFF is cut into {parts} parts; at most {MAX_PARTS} are read.")
        part_bytes, most_bytes = columns * rows * self._dtype.itemsize, MAX_PART_BYTES if packing else MAX_PLAIN_PART_BYTES
        if part_bytes > most_bytes:
            raise TerrainFileError(
                f"The GeoTIFF is packed in parts of {part_bytes / 2**20:.0f} MiB; at most {most_bytes // 2**20} MiB are unpacked at once. "
                "Write it in tiles first: gdal_translate -co TILED=YES"
            )


def _sample_type(head: dict[str, Any]) -> np.dtype[Any]:
    if not head["dtype"]:
        raise TerrainFileError("The GeoTIFF's values are no heights: whole numbers of 8 to 32 bits or floats of 32 or 64 bits are read.")
    return np.dtype(str(head["dtype"]))


def _reference_systems(head: dict[str, Any]) -> tuple[CRS, CRS | None]:
    """Return the system of places and that of heights, if it states one."""
    try:
        stated = CRS.from_wkt(head["wkt"]) if head["wkt"] else None
    except CRSError:
        stated = None
    parts = [] if stated is None else stated.sub_crs_list if stated.is_compound else [stated]
    if not parts or not (parts[0].is_geographic or parts[0].is_projected):
        raise TerrainFileError(f"The GeoTIFF names no reference system that is known; one by its EPSG code is needed. {_convert()}")
    refuse_if_ellipsoidal(parts[0])
    code = parts[0].to_json_dict().get("id", {})
    if code.get("authority") != "EPSG":
        words = "names a reference system that is not known" if head["warning"] else "describes its reference system in its own words"
        raise TerrainFileError(f"The GeoTIFF {words}; one by its EPSG code is needed. {_convert()}")
    return CRS.from_epsg(code["code"]), parts[1] if len(parts) > 1 else None


def _convert() -> str:
    return f"Convert it first: {_TO_WGS84}"


def _place(head: dict[str, Any]) -> tuple[float, float, float, float]:
    """Return the position of the first post (row and column 0), in the middle of its cell, and the steps."""
    if head["place"] is None:
        raise TerrainFileError(f"The GeoTIFF does not say where its first post stands. {_convert()}")
    x, step_x, turned_x, y, turned_y, minus_step_y = head["place"]
    if turned_x or turned_y:
        raise TerrainFileError(f"The GeoTIFF is rotated. Turn it first: {_TO_WGS84}")
    if not (np.isfinite([x, y, step_x, minus_step_y]).all() and step_x > 0 and minus_step_y < 0):
        raise TerrainFileError(f"The GeoTIFF is upside down or mirrored. Turn it first: {_TO_WGS84}")
    return x + 0.5 * step_x, y + 0.5 * minus_step_y, step_x, -minus_step_y


def _to_metres(head: dict[str, Any], unit_m: float) -> tuple[float, float]:
    """Return factor and offset that convert the file's numbers to metres. unit_m: of the system of heights."""
    unit = head["unit"].strip()
    if unit and unit.lower() not in _UNITS:
        raise TerrainFileError(f"The heights are in {unit[:20]!r}, a unit that is not known. Convert them to metres first.")
    unit_m = _UNITS[unit.lower()] if unit else unit_m
    scale, offset = (1.0 if head["scale"] is None else head["scale"]), head["offset"] or 0.0
    if not np.isfinite([scale, offset]).all() or scale == 0.0:  # GDAL takes a word for 0
        raise TerrainFileError("The GeoTIFF's heights are scaled by what is no number.")
    return scale * unit_m, offset * unit_m


def _refused(words: str, refusal: GdalRefusal) -> TerrainFileError:
    reason = refusal.reason
    return TerrainFileError(reason if isinstance(reason, Reason) else f"{words}: {reason}")
