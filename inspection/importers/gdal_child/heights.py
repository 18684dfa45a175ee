"""The band of a GeoTIFF: first what the file says of itself, then windows of its values as they are asked for."""

import ctypes
import zlib
from ctypes import byref, c_double, c_int
from typing import Any

from inspection.importers.gdal_child.libgdal import FAILURE, WARNING, Gdal, Unreadable

TYPES = {1: ("u1", 1), 2: ("u2", 2), 3: ("i2", 2), 4: ("u4", 4), 5: ("i4", 4), 6: ("f4", 4), 7: ("f8", 8), 14: ("i1", 1)}  # GDALDataType
_READ = 0
_EMPTY = 0x04  # GDAL_DATA_COVERAGE_STATUS_EMPTY


def described(gdal: Gdal, data_set: Any) -> dict[str, Any]:
    """Return what the file says of itself."""
    band = gdal.GDALGetRasterBand(data_set, 1)
    place = (c_double * 6)()
    is_placed = gdal.GDALGetGeoTransform(data_set, place) == 0
    columns, rows = c_int(), c_int()
    gdal.GDALGetBlockSize(band, byref(columns), byref(rows))
    dtype = TYPES.get(gdal.GDALGetRasterDataType(band), ("", 0))[0]
    if dtype == "u1" and _item(gdal, band, "PIXELTYPE", "IMAGE_STRUCTURE") == "SIGNEDBYTE":
        dtype = "i1"
    return {
        "width": gdal.GDALGetRasterXSize(data_set), "height": gdal.GDALGetRasterYSize(data_set), "bands": gdal.GDALGetRasterCount(data_set),
        "dtype": dtype, "part": [columns.value, rows.value], "mask": gdal.GDALGetMaskFlags(band),
        "packing": _item(gdal, data_set, "COMPRESSION", "IMAGE_STRUCTURE"), "wkt": gdal.wkt(gdal.GDALGetSpatialRef(data_set)),
        "place": list(place) if is_placed else None, "void": gdal.number("GDALGetRasterNoDataValue", band),
        "scale": gdal.number("GDALGetRasterScale", band), "offset": gdal.number("GDALGetRasterOffset", band),
        "unit": (gdal.GDALGetRasterUnitType(band) or b"").decode("utf-8", "replace"),
        "warning": gdal.failure(WARNING),
    }  # fmt: skip


class Windows:
    """Reads windows. Parts (strips or tiles) that are not in the file are absent; a sparse file leaves them out."""

    def __init__(self, gdal: Gdal, data_set: Any, path: str) -> None:
        self._gdal = gdal
        self._band = gdal.GDALGetRasterBand(data_set, 1)
        self._type = gdal.GDALGetRasterDataType(self._band)
        self._size_bytes = TYPES[self._type][1]
        columns, rows = c_int(), c_int()
        gdal.GDALGetBlockSize(self._band, byref(columns), byref(rows))
        self._part = columns.value, rows.value
        self._has_void = gdal.number("GDALGetRasterNoDataValue", self._band) is not None
        is_deflated = _item(gdal, data_set, "COMPRESSION", "IMAGE_STRUCTURE") == "DEFLATE"
        self._file = open(path, "rb", buffering=0) if is_deflated else None  # noqa: PTH123, SIM115 -- until the process ends
        self._checked: set[tuple[int, int]] = set()

    def values(self, x: int, y: int, columns: int, rows: int) -> bytes:
        """Return the values of a window, row by row in this machine's byte order. Raises Unreadable."""
        self._check_sums(x, y, columns, rows)
        values = ctypes.create_string_buffer(columns * rows * self._size_bytes)
        self._gdal.messages.clear()
        fault = self._gdal.GDALRasterIO(self._band, _READ, x, y, columns, rows, values, columns, rows, self._type, 0, 0)
        if fault >= FAILURE or self._gdal.failure():
            raise Unreadable(self._gdal.failure() or "a part cannot be unpacked")
        return values.raw

    def absent(self, x: int, y: int, columns: int, rows: int) -> list[tuple[int, int, int, int]]:
        """Return x, y, columns and rows of the absent parts of a window; GDAL gives them the void value, or 0 if there is none."""
        if self._has_void or not self._covers(x, y, columns, rows) & _EMPTY:
            return []
        across, down = self._part
        found = []
        for column, row in self._parts(x, y, columns, rows):
            left, top = max(column * across, x), max(row * down, y)
            part = left, top, min((column + 1) * across, x + columns) - left, min((row + 1) * down, y + rows) - top
            if self._covers(*part) & _EMPTY:
                found.append(part)
        return found

    def _covers(self, x: int, y: int, columns: int, rows: int) -> int:
        return int(self._gdal.GDALGetDataCoverageStatus(self._band, x, y, columns, rows, 0, None))

    def _parts(self, x: int, y: int, columns: int, rows: int) -> list[tuple[int, int]]:
        """Return column and row of the parts under a window."""
        across, down = self._part
        return [
            (column, row)
            for row in range(y // down, (y + rows - 1) // down + 1)
            for column in range(x // across, (x + columns - 1) // across + 1)
        ]

    def _check_sums(self, x: int, y: int, columns: int, rows: int) -> None:
        """Check the checksums of deflated parts, which GDAL does not look at: it would read other heights. Raises Unreadable."""
        if self._file is None:
            return
        size_bytes = self._part[0] * self._part[1] * self._size_bytes
        for part in set(self._parts(x, y, columns, rows)) - self._checked:
            offset, length = (_item(self._gdal, self._band, f"BLOCK_{name}_{part[0]}_{part[1]}", "TIFF") for name in ("OFFSET", "SIZE"))
            if offset and length:
                self._file.seek(int(offset))
                _check_deflated(self._file.read(min(int(length), 2 * size_bytes + 4096)), size_bytes)
            self._checked.add(part)


def _check_deflated(data: bytes, size_bytes: int) -> None:
    """Check data that unpack to at most size_bytes; more are not unpacked. Raises Unreadable."""
    stream = zlib.decompressobj()
    try:
        stream.decompress(data, size_bytes)
        more = b"" if stream.eof else stream.decompress(stream.unconsumed_tail, 1)
    except zlib.error as error:
        raise Unreadable(f"a checksum is wrong: {error}") from error
    if more or not stream.eof:
        raise Unreadable("a part unpacks to more than it may" if more else "a part ends too early")


def _item(gdal: Gdal, major: Any, name: str, domain: str) -> str:
    return (gdal.GDALGetMetadataItem(major, name.encode(), domain.encode()) or b"").decode("utf-8", "replace")
