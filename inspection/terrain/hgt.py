"""SRTM height files (.hgt): a square of big-endian int16, named after its south-west corner."""

import re
from pathlib import Path

import numpy as np

from inspection.terrain.errors import TerrainFileError
from inspection.terrain.height_grid import HeightGrid, without_voids

VOID = -32768
_SIDES = {1201 * 1201 * 2: 1201, 3601 * 3601 * 2: 3601}  # 3 and 1 arc seconds
_NAME = re.compile(r"([NS])(\d{2})([EW])(\d{3})", re.IGNORECASE)


def read_hgt(path: Path) -> HeightGrid:
    match = _NAME.match(path.name)
    side = _SIDES.get(path.stat().st_size)
    if match is None or side is None:
        raise TerrainFileError("An HGT file is named after its corner, such as N47E009.hgt, and has 1201 or 3601 posts a side.")
    south = float(match[2]) * (1 if match[1].upper() == "N" else -1)
    west = float(match[4]) * (1 if match[3].upper() == "E" else -1)
    if not (-90 <= south < 90 and -180 <= west < 180):
        raise TerrainFileError(f"{match[0]} is not on earth.")
    raw = np.frombuffer(path.read_bytes(), dtype=">i2").reshape(side, side)
    return HeightGrid(west, south + 1.0, 1.0 / (side - 1), 1.0 / (side - 1), without_voids(raw, VOID))
