"""GeoTIFF heights without GDAL: one band in strips or tiles, read window by window. Source: OGC GeoTIFF 1.1, OGC 19-008r4."""

import re
from collections import OrderedDict
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS
from pyproj.exceptions import CRSError

from inspection.importers.terrain.raster import (
    Kind,
    TerrainFileError,
    Window,
    datum_of_codes,
    metres_of_unit,
    refuse_if_ellipsoidal,
    window_of,
)
from inspection.importers.terrain.tiff import NAMES, NONE, READ, TiffDirectory, unpacked_part, without_predictor

MAX_POSTS = 200_000_000
MAX_PARTS = 1_000_000
MAX_PART_BYTES = 16 * 1024 * 1024  # unpacked
KEPT_BYTES = 48 * 1024 * 1024  # of unpacked parts
_WIDTH, _LENGTH, _BITS, _COMPRESSION, _OFFSETS, _SAMPLES, _ROWS_PER_STRIP, _COUNTS = 256, 257, 258, 259, 273, 277, 278, 279
_PREDICTOR, _TILE_WIDTH, _TILE_LENGTH, _TILE_OFFSETS, _TILE_COUNTS, _FORMAT = 317, 322, 323, 324, 325, 339
_SCALE, _TIEPOINTS, _TRANSFORMATION, _GEO_KEYS, _GEO_DOUBLES, _GEO_TEXT, _METADATA, _NODATA = (
    33550,
    33922,
    34264,
    34735,
    34736,
    34737,
    42112,
    42113,
)
_DTYPES = {(8, 1): "u1", (8, 2): "i1", (16, 1): "u2", (16, 2): "i2", (32, 1): "u4", (32, 2): "i4", (32, 3): "f4", (64, 3): "f8"}
_MODEL, _RASTER, _GEOGRAPHIC, _PROJECTED, _VERTICAL, _VERTICAL_CITATION, _VERTICAL_DATUM, _VERTICAL_UNIT = (
    1024, 1025, 2048, 3072, 4096, 4097, 4098, 4099,
)  # fmt: skip
_PIXEL_IS_POINT = 2
_ITEM = re.compile(r'<Item name="[^"]{1,40}"(?: sample="0")? role="(scale|offset|unittype)">([^<]{1,40})</Item>')
_UNITS = {
    "m": 1.0,
    "metre": 1.0,
    "meter": 1.0,
    "metres": 1.0,
    "meters": 1.0,
    "ft": 0.3048,
    "foot": 0.3048,
    "feet": 0.3048,
    "us-ft": 1200 / 3937,
}
_TO_WGS84 = "gdalwarp -t_srs EPSG:4326"


class GeoTiff:
    """A GeoTIFF. Coordinates are those of `system`; see raster.Raster for windows.

    x, y of a post: (x + column * step_x, y - row * step_y).
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._tags = TiffDirectory(file)
        self.width, self.height = self._tags.number(_WIDTH, 0), self._tags.number(_LENGTH, 0)
        self._check_size()
        self._dtype = self._sample_type()
        self._compression, self._predictor = self._packing()
        self._lay_out_parts()
        self._keys = self._geo_keys()
        self.system = self._reference_system()
        self.x, self.y, self.step_x, self.step_y = self._place()
        system_code, datum_code = self._key(_VERTICAL), self._key(_VERTICAL_DATUM)
        self.vertical_datum = datum_of_codes(system_code, datum_code, self._text_key(_VERTICAL_CITATION))
        self._void = self._declared_void()
        self._factor, self._offset_m = self._to_metres(metres_of_unit(self._key(_VERTICAL_UNIT), system_code))
        self._kept: OrderedDict[int, NDArray[Any] | None] = OrderedDict()

    def window(self, row: int, column: int, rows: int, columns: int) -> Window:
        raw = np.zeros((rows, columns), dtype=self._dtype.newbyteorder("="))
        absent = np.zeros((rows, columns), dtype=bool)
        for down in range(row // self._part_rows, (row + rows - 1) // self._part_rows + 1):
            for across in range(column // self._part_columns, (column + columns - 1) // self._part_columns + 1):
                top, left = down * self._part_rows, across * self._part_columns
                part = self._part(down * self._parts_across + across, min(self._part_rows, self.height - top))
                here = slice(max(top, row), min(top + self._part_rows, row + rows, self.height))
                there = slice(max(left, column), min(left + self._part_columns, column + columns))
                target = slice(here.start - row, here.stop - row), slice(there.start - column, there.stop - column)
                if part is None:
                    absent[target] = True
                else:
                    raw[target] = part[here.start - top : here.stop - top, there.start - left : there.stop - left]
        window = window_of(raw, self._void, scale=self._factor, offset_m=self._offset_m)
        if absent.any():  # a sparse file omits empty parts
            window.heights_m[absent] = np.nan
            window.kinds[absent] = Kind.DECLARED_VOID
        return window

    def _part(self, number: int, rows: int) -> NDArray[Any] | None:
        """Return an unpacked strip or tile, cached by last use."""
        if number in self._kept:
            self._kept.move_to_end(number)
            return self._kept[number]
        offset, count = int(self._offsets[number]), int(self._counts[number])
        part: NDArray[Any] | None = None
        if count:
            rows = self._part_rows if self._is_tiled else rows
            size = rows * self._part_columns * self._dtype.itemsize
            packed = self._tags.read(offset, min(count, 2 * size + 4096))
            data = unpacked_part(packed, self._compression, size)
            part = without_predictor(data, self._predictor, self._dtype, rows, self._part_columns)
        self._kept[number] = part
        while sum(kept.nbytes for kept in self._kept.values() if kept is not None) > KEPT_BYTES:
            self._kept.popitem(last=False)
        return part

    def _check_size(self) -> None:
        if self.width < 2 or self.height < 2:
            raise TerrainFileError("The GeoTIFF has fewer than two rows or columns.")
        if self.width * self.height > MAX_POSTS:
            raise TerrainFileError(f"The GeoTIFF has {self.width} × {self.height} posts; at most {MAX_POSTS} are taken. Cut it into parts.")
        bands = self._tags.number(_SAMPLES, 1)
        if bands != 1:
            raise TerrainFileError(f"A terrain model has one band; this file has {bands}.")
        if self._tags.has_mask:
            raise TerrainFileError(
                "The GeoTIFF tells its voids by a mask. Write them as a value first: gdal_translate -mask none -a_nodata -9999"
            )

    def _sample_type(self) -> np.dtype[Any]:
        bits, form = self._tags.number(_BITS, 1), self._tags.number(_FORMAT, 1)
        if (bits, form) not in _DTYPES:
            raise TerrainFileError(
                "The GeoTIFF's values are no heights: whole numbers of 8 to 32 bits or floats of 32 or 64 bits are read."
            )
        return np.dtype(_DTYPES[bits, form]).newbyteorder(self._tags.order)

    def _packing(self) -> tuple[int, int]:
        compression, predictor = self._tags.number(_COMPRESSION, 1), self._tags.number(_PREDICTOR, 1)
        if compression not in READ:
            name = NAMES.get(compression, f"method {compression}")
            raise TerrainFileError(
                f"The GeoTIFF is packed with {name}, which is not read. Pack it with deflate: gdal_translate -co COMPRESS=DEFLATE"
            )
        if predictor not in (1, 2, 3) or (predictor == 3 and self._dtype.kind != "f") or (predictor == 2 and self._dtype.itemsize > 4):
            raise TerrainFileError("The GeoTIFF is packed in a way that is not known.")
        return compression, predictor if compression != NONE else 1

    def _lay_out_parts(self) -> None:
        tags = self._tags
        self._is_tiled = tags.has(_TILE_OFFSETS)
        if self._is_tiled:
            self._part_columns, self._part_rows = tags.number(_TILE_WIDTH, 0), tags.number(_TILE_LENGTH, 0)
            if self._part_columns < 16 or self._part_rows < 16:
                raise TerrainFileError("The GeoTIFF's tiles are smaller than TIFF allows.")
        else:
            self._part_columns, self._part_rows = self.width, min(tags.number(_ROWS_PER_STRIP, self.height), self.height)
            if self._part_rows < 1:
                raise TerrainFileError("The GeoTIFF's strips have no rows.")
        row_bytes = self._part_columns * self._dtype.itemsize
        self._parts_across = -(-self.width // self._part_columns)
        number = self._parts_across * -(-self.height // self._part_rows)
        if number > MAX_PARTS:
            raise TerrainFileError(f"The GeoTIFF is cut into {number} parts; at most {MAX_PARTS} are read.")
        self._offsets = tags.numbers(_TILE_OFFSETS if self._is_tiled else _OFFSETS, MAX_PARTS).astype(np.int64)
        self._counts = tags.numbers(_TILE_COUNTS if self._is_tiled else _COUNTS, MAX_PARTS).astype(np.int64)
        if len(self._offsets) != number or len(self._counts) != number:
            raise TerrainFileError(f"The GeoTIFF should have {number} parts and lists {min(len(self._offsets), len(self._counts))}.")
        if row_bytes * self._part_rows > MAX_PART_BYTES:
            if self._is_tiled or self._compression != NONE or row_bytes > MAX_PART_BYTES:
                size_mib = row_bytes * self._part_rows / 2**20
                raise TerrainFileError(
                    f"The GeoTIFF is packed in parts of {size_mib:.0f} MiB; at most {MAX_PART_BYTES // 2**20} MiB are unpacked at once. "
                    "Write it in tiles first: gdal_translate -co TILED=YES"
                )
            self._cut_strips(row_bytes)

    def _cut_strips(self, row_bytes: int) -> None:
        """Split uncompressed strips into smaller ones."""
        starts = self._offsets[np.arange(self.height) // self._part_rows] + np.arange(self.height) % self._part_rows * row_bytes
        if (self._counts < row_bytes * np.minimum(self._part_rows, self.height - np.arange(len(self._counts)) * self._part_rows)).any():
            raise TerrainFileError("The TIFF is cut off.")
        self._offsets, self._counts, self._part_rows = starts, np.full(self.height, row_bytes), 1

    def _geo_keys(self) -> dict[int, tuple[int, int, int]]:
        values = self._tags.numbers(_GEO_KEYS).tolist()
        return {key: (tag, count, value) for key, tag, count, value in zip(*(values[4 + part :: 4] for part in range(4)), strict=False)}

    def _key(self, key: int) -> int:
        tag, _, value = self._keys.get(key, (0, 0, 0))
        return value if tag == 0 else 0

    def _text_key(self, key: int) -> str:
        tag, count, first = self._keys.get(key, (0, 0, 0))
        return self._tags.text(_GEO_TEXT)[first : first + count].strip("| \0") if tag == _GEO_TEXT else ""

    def _reference_system(self) -> CRS:
        model = self._key(_MODEL)
        code = self._key(_PROJECTED if model == 1 else _GEOGRAPHIC)
        if model not in (1, 2) or not 1024 <= code < 32767:
            words = "describes its reference system in its own words" if model in (1, 2) else "names no reference system"
            raise TerrainFileError(f"The GeoTIFF {words}; one by its EPSG code is needed. Convert it first: {_TO_WGS84}")
        try:
            system = CRS.from_epsg(code)
        except CRSError as error:
            raise TerrainFileError(f"The GeoTIFF names EPSG:{code}, which is no reference system that is known.") from error
        refuse_if_ellipsoidal(system)
        if not (system.is_geographic or system.is_projected):
            raise TerrainFileError(f"{system.name} is no system of places on earth.")
        return system

    def _place(self) -> tuple[float, float, float, float]:
        """Return the position of the first post (row and column 0), and the steps."""
        scale, ties, matrix = (self._tags.numbers(tag).astype(np.float64) for tag in (_SCALE, _TIEPOINTS, _TRANSFORMATION))
        if len(matrix) == 16:
            if matrix[1] or matrix[4]:
                raise TerrainFileError(f"The GeoTIFF is rotated. Turn it first: {_TO_WGS84}")
            x, y, step_x, step_y = matrix[3], matrix[7], matrix[0], -matrix[5]
        elif len(scale) >= 2 and len(ties) == 6:
            step_x, step_y = scale[0], scale[1]
            x, y = ties[3] - ties[0] * step_x, ties[4] + ties[1] * step_y
        else:
            raise TerrainFileError(f"The GeoTIFF does not say where its first post stands. Convert it first: {_TO_WGS84}")
        if not (np.isfinite([x, y, step_x, step_y]).all() and step_x > 0 and step_y > 0):
            raise TerrainFileError(f"The GeoTIFF is upside down or mirrored. Turn it first: {_TO_WGS84}")
        shift = 0.0 if self._key(_RASTER) == _PIXEL_IS_POINT else 0.5
        return float(x + shift * step_x), float(y - shift * step_y), float(step_x), float(step_y)

    def _declared_void(self) -> float | None:
        text = self._tags.text(_NODATA)
        try:
            return float(text) if text else None
        except ValueError as error:
            raise TerrainFileError(f"The GeoTIFF declares {text[:20]!r} as its void value, which is no number.") from error

    def _to_metres(self, unit_m: float) -> tuple[float, float]:
        """Return factor and offset that convert the file's numbers to metres."""
        scale, offset = 1.0, 0.0
        for role, text in _ITEM.findall(self._tags.text(_METADATA)):
            if role == "unittype":
                if text.strip().lower() not in _UNITS:
                    raise TerrainFileError(
                        f"The heights are in {text.strip()[:20]!r}, a unit that is not known. Convert them to metres first."
                    )
                unit_m = _UNITS[text.strip().lower()]
                continue
            try:
                number = float(text)
            except ValueError as error:
                raise TerrainFileError(f"The GeoTIFF states {text[:20]!r} as the {role} of its values, which is no number.") from error
            scale, offset = (number, offset) if role == "scale" else (scale, number)
        if not np.isfinite([scale, offset]).all():
            raise TerrainFileError("The GeoTIFF's heights are scaled by what is no number.")
        return scale * unit_m, offset * unit_m
