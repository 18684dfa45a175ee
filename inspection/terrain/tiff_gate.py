"""What a TIFF says of itself, read before any library unpacks it: how large its blocks are, and from where its heights count.

Source: Adobe TIFF 6.0; BigTIFF; OGC GeoTIFF 1.1 (tags 34735, key 4096).
"""

import struct
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import BinaryIO

from inspection.terrain.errors import TerrainFileError

MOST_BLOCK_BYTES = 16 * 1024 * 1024  # unpacked; one block is in memory at a time
MOST_ENTRIES = 1_000
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4, 16: 8, 17: 8, 18: 8}
_CODES = {1: "B", 3: "H", 4: "I", 16: "Q"}
_WIDTH, _LENGTH, _BITS, _SAMPLES, _ROWS_PER_STRIP, _TILE_WIDTH, _TILE_LENGTH, _GEO_KEYS = 256, 257, 258, 277, 278, 322, 323, 34735
_VERTICAL_KEY = 4096
_DATUMS = {5773: "EGM96", 5798: "EGM84", 3855: "EGM2008", 5703: "NAVD88", 5621: "EVRF2007", 7837: "DHHN2016"}
_ELLIPSOIDAL = {4979, 5019, 5030}


@dataclass(frozen=True)
class TiffFacts:
    width: int
    height: int
    vertical_datum: str | None  # as the file states it; None where it does not


def examine(path: Path) -> TiffFacts:
    """Raises TerrainFileError for what is no TIFF, is cut off, or is packed in blocks that do not fit into memory."""
    try:
        with path.open("rb") as file:
            return _facts(file)
    except (struct.error, OSError, OverflowError, KeyError, IndexError) as error:
        raise TerrainFileError("The TIFF's own directory is damaged or cut off.") from error


def _facts(file: BinaryIO) -> TiffFacts:
    start = file.read(16)
    order = {b"II": "<", b"MM": ">"}.get(start[:2])
    if order is None:
        raise TerrainFileError("This is no TIFF.")
    is_big = struct.unpack(f"{order}H", start[2:4])[0] == 43
    tags = _directory(file, order, is_big, struct.unpack(f"{order}{'Q' if is_big else 'I'}", start[8:16] if is_big else start[4:8])[0])
    width, height = tags[_WIDTH][0], tags[_LENGTH][0]
    sample_bytes = max(tags.get(_BITS, [1])) / 8 * tags.get(_SAMPLES, [1])[0]
    block = [tags.get(_TILE_WIDTH, [width])[0], (tags.get(_TILE_LENGTH) or tags.get(_ROWS_PER_STRIP) or [height])[0]]
    block[1] = min(block[1], height) if _TILE_LENGTH not in tags else block[1]
    if prod(block) * sample_bytes > MOST_BLOCK_BYTES:
        raise TerrainFileError(
            f"The GeoTIFF is packed in blocks of {prod(block) * sample_bytes / 2**20:.0f} MiB; at most {MOST_BLOCK_BYTES // 2**20} MiB are "
            "unpacked at once. Write it in tiles first: gdal_translate -co TILED=YES"
        )
    return TiffFacts(width, height, _datum(tags.get(_GEO_KEYS, [])))


def _directory(file: BinaryIO, order: str, is_big: bool, offset: int) -> dict[int, list[int]]:
    """The first directory's tags of whole numbers."""
    count_code, entry_size, inline = ("Q", 20, 8) if is_big else ("H", 12, 4)
    file.seek(offset)
    number = struct.unpack(f"{order}{count_code}", file.read(struct.calcsize(count_code)))[0]
    if number > MOST_ENTRIES:
        raise TerrainFileError("The TIFF's own directory is damaged.")
    entries = file.read(number * entry_size)
    if len(entries) < number * entry_size:
        raise TerrainFileError("The TIFF's own directory is cut off.")
    tags: dict[int, list[int]] = {}
    for position in range(0, len(entries), entry_size):
        tag, kind = struct.unpack(f"{order}HH", entries[position : position + 4])
        count = struct.unpack(f"{order}{'Q' if is_big else 'I'}", entries[position + 4 : position + entry_size - inline])[0]
        if kind not in _CODES or count > 10_000:
            continue
        value = entries[position + entry_size - inline : position + entry_size]
        size = _SIZES[kind] * count
        if size > inline:
            file.seek(struct.unpack(f"{order}{'Q' if is_big else 'I'}", value)[0])
            value = file.read(size)
        tags[tag] = list(struct.unpack(f"{order}{count}{_CODES[kind]}", value[:size]))
    return tags


def _datum(keys: list[int]) -> str | None:
    for position in range(4, len(keys) - 3, 4):
        if keys[position] == _VERTICAL_KEY and keys[position + 1] == 0:
            code = keys[position + 3]
            if code in _ELLIPSOIDAL:
                raise TerrainFileError(
                    "The heights are counted from the ellipsoid. Convert them to sea level first: gdalwarp -t_srs EPSG:4326+5773"
                )
            return _DATUMS.get(code, f"EPSG:{code}")
    return None
