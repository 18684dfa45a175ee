"""The band of a GeoTIFF: first what the file says of itself, then windows of its values as they are asked for."""

import ctypes
from ctypes import byref, c_double, c_int
from typing import Any

from inspection.importers.gdal_child.libgdal import FAILURE, WARNING, Gdal, Unreadable

TYPES = {1: ("u1", 1), 2: ("u2", 2), 3: ("i2", 2), 4: ("u4", 4), 5: ("i4", 4), 6: ("f4", 4), 7: ("f8", 8), 14: ("i1", 1)}  # GDALDataType
_READ = 0
_EMPTY, _DATA = 0x04, 0x02  # GDAL_DATA_COVERAGE_STATUS_*


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
    """Reads windows; `absent` are the parts that a sparse file without a void value leaves out."""

    def __init__(self, gdal: Gdal, data_set: Any) -> None:
        self._gdal = gdal
        self._band = gdal.GDALGetRasterBand(data_set, 1)
        self._type = gdal.GDALGetRasterDataType(self._band)
        self._size_bytes = TYPES[self._type][1]
        columns, rows = c_int(), c_int()
        gdal.GDALGetBlockSize(self._band, byref(columns), byref(rows))
        self._part = columns.value, rows.value
        self._has_void = gdal.number("GDALGetRasterNoDataValue", self._band) is not None

    def values(self, x: int, y: int, columns: int, rows: int) -> bytes:
        """Return the values of a window, row by row in this machine's byte order. Raises Unreadable."""
        values = ctypes.create_string_buffer(columns * rows * self._size_bytes)
        self._gdal.messages.clear()
        fault = self._gdal.GDALRasterIO(self._band, _READ, x, y, columns, rows, values, columns, rows, self._type, 0, 0)
        if fault >= FAILURE or self._gdal.failure():
            raise Unreadable(self._gdal.failure() or "a part cannot be unpacked")
        return values.raw

    def absent(self, x: int, y: int, columns: int, rows: int) -> list[tuple[int, int, int, int]]:
        """Return x, y, columns and rows of absent parts of the window."""
        if self._has_void or not self._covers(x, y, columns, rows) & _EMPTY:
            return []
        found = []
        across, down = self._part
        for top in range(y // down * down, y + rows, down):
            for left in range(x // across * across, x + columns, across):
                first_x, first_y = max(left, x), max(top, y)
                part = first_x, first_y, min(left + across, x + columns) - first_x, min(top + down, y + rows) - first_y
                if self._covers(*part) & _EMPTY:
                    found.append(part)
        return found

    def _covers(self, x: int, y: int, columns: int, rows: int) -> int:
        return int(self._gdal.GDALGetDataCoverageStatus(self._band, x, y, columns, rows, 0, None))


def _item(gdal: Gdal, major: Any, name: str, domain: str) -> str:
    return (gdal.GDALGetMetadataItem(major, name.encode(), domain.encode()) or b"").decode("utf-8", "replace")
