"""Terrain files for tests: GeoTIFFs by GDAL, and HGT files."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from django.contrib.gis.gdal import GDALRaster
from django.contrib.gis.gdal.libgdal import lgdal

from inspection.importers.terrain.geotiff import GeoTiff, TiffReader

DATATYPES = {"u1": 1, "u2": 2, "i2": 3, "u4": 4, "i4": 5, "f4": 6, "f8": 7}


def write_geotiff(
    path: Path,
    heights: np.ndarray,
    *,
    srid: int = 4326,
    origin: tuple[float, float] = (9.0, 47.0),
    step: float = 0.001,
    void: float | None = -9999.0,
    scale: float | None = None,
    unit: str = "",
    **options: Any,
) -> Path:
    """`origin` is the corner of the first cell; its post stands half a step inside."""
    rows, columns = heights.shape
    band = {"data": np.ascontiguousarray(heights).tobytes()} | ({} if void is None else {"nodata_value": void})
    raster = GDALRaster(
        {"driver": "GTiff", "name": str(path), "srid": srid, "width": columns, "height": rows, "origin": origin, "scale": (step, -step),
         "datatype": DATATYPES[heights.dtype.str[1:]], "bands": [band],
         "papsz_options": {name: str(value) for name, value in options.items()}}
    )  # fmt: skip
    pointer = raster.bands[0]._ptr
    if scale is not None:
        lgdal.GDALSetRasterScale(pointer, ctypes.c_double(scale))
    if unit:
        lgdal.GDALSetRasterUnitType(pointer, unit.encode())
    raster._flush()
    return path


@contextmanager
def opened_tiff(path: Path) -> Iterator[GeoTiff]:
    reader = TiffReader()
    with path.open("rb") as file:
        try:
            yield GeoTiff(file, reader)
        finally:
            reader.close()


def write_hgt(path: Path, heights: np.ndarray | int, side: int = 1201) -> Path:
    path.write_bytes(np.broadcast_to(np.asarray(heights, dtype=">i2"), (side, side)).tobytes())
    return path
