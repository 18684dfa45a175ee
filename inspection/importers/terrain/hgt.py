"""SRTM height files (.hgt): a square of big-endian int16, named after its south-west corner, in metres above EGM96."""

import re
from typing import IO

import numpy as np

from inspection.importers.terrain.errors import TerrainFileError
from inspection.importers.terrain.raster import Window, window_of

VERTICAL_DATUM = "EGM96"  # SRTM, and what is handed out in its form
VOID = -32768
SIZES = {1201 * 1201 * 2: 1201, 3601 * 3601 * 2: 3601}  # 3 and 1 arc seconds
_NAME = re.compile(r"([NS])(\d{2})([EW])(\d{3})", re.IGNORECASE)


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
