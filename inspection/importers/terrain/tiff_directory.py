"""The tags of a TIFF's first image, read with bounds. Source: Adobe TIFF 6.0; BigTIFF."""

from typing import IO, Any, Literal

import numpy as np
from numpy.typing import NDArray

from inspection.importers.terrain.errors import TerrainFileError

TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")  # classic and BigTIFF
MAX_ENTRIES = 1_000
MAX_DIRECTORIES = 64
MAX_TEXT = 64 * 1024
SUBFILE_TYPE = 254
_MASK = 4  # bit of SUBFILE_TYPE
_TYPES = {
    1: "u1",
    2: "S1",
    3: "u2",
    4: "u4",
    6: "i1",
    7: "u1",
    8: "i2",
    9: "i4",
    11: "f4",
    12: "f8",
    13: "u4",
    16: "u8",
    17: "i8",
    18: "u8",
}


class TiffDirectory:
    """Raises TerrainFileError for what is cut off or contradicts itself."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self.size_bytes = file.seek(0, 2)
        start = self.read(0, min(16, self.size_bytes))
        if not start.startswith(TIFF_STARTS):
            raise TerrainFileError("This is no TIFF.")
        self.order: Literal["<", ">"] = "<" if start.startswith(b"II") else ">"
        self._is_big = start[2:4] in (b"+\0", b"\0+")
        self._entries, following = self._read_directory(self._whole(8 if self._is_big else 4, self._is_big))
        self.has_mask = self._has_mask(following)

    def read(self, offset: int, count: int) -> bytes:
        if offset < 0 or count < 0 or offset + count > self.size_bytes:
            raise TerrainFileError("The TIFF is cut off.")
        self._file.seek(offset)
        data = self._file.read(count)
        if len(data) < count:
            raise TerrainFileError("The TIFF is cut off.")
        return data

    def has(self, tag: int) -> bool:
        return tag in self._entries

    def numbers(self, tag: int, most: int = 10_000) -> NDArray[Any]:
        """All values of a tag, none where the file has not got it."""
        return self._values(self._entries, tag, most)

    def number(self, tag: int, default: int) -> int:
        values = self.numbers(tag)
        return int(values[0]) if len(values) and values.dtype.kind in "iu" else default

    def text(self, tag: int) -> str:
        if tag not in self._entries or self._entries[tag][0] not in (1, 2, 7):
            return ""
        values = self._values(self._entries, tag, MAX_TEXT)
        return values.tobytes().split(b"\0")[0].decode("latin-1").strip()

    def _values(self, entries: dict[int, tuple[int, int, int]], tag: int, most: int) -> NDArray[Any]:
        if tag not in entries:
            return np.zeros(0, dtype=np.int64)
        kind, count, place = entries[tag]
        if kind not in _TYPES:
            return np.zeros(0, dtype=np.int64)
        if count > most:
            raise TerrainFileError(f"The TIFF's tag {tag} has {count} values; at most {most} are read.")
        dtype = np.dtype(_TYPES[kind]).newbyteorder(self.order)
        length, inline = dtype.itemsize * count, 8 if self._is_big else 4
        offset = place if length <= inline else self._whole(place, self._is_big)
        return np.frombuffer(self.read(offset, length), dtype=dtype).astype(dtype.newbyteorder("="))

    def _whole(self, offset: int, is_long: bool) -> int:
        size = 8 if is_long else 4
        return int.from_bytes(self.read(offset, size), "little" if self.order == "<" else "big")

    def _short(self, data: bytes) -> int:
        return int.from_bytes(data, "little" if self.order == "<" else "big")

    def _read_directory(self, offset: int) -> tuple[dict[int, tuple[int, int, int]], int]:
        """Tag → (type, count, where the value or its offset stands), and where the next directory begins; 0 for none."""
        count_size, entry_size, value_size = (8, 20, 8) if self._is_big else (2, 12, 4)
        number = self._short(self.read(offset, count_size))
        if not 0 < number <= MAX_ENTRIES:
            raise TerrainFileError("The TIFF's own directory is damaged.")
        first = offset + count_size
        data = self.read(first, number * entry_size)
        entries = {}
        for position in range(0, len(data), entry_size):
            tag, kind = self._short(data[position : position + 2]), self._short(data[position + 2 : position + 4])
            entries[tag] = (
                kind,
                self._short(data[position + 4 : position + entry_size - value_size]),
                first + position + entry_size - value_size,
            )
        return entries, self._whole(first + len(data), self._is_big)

    def _has_mask(self, offset: int) -> bool:
        """Whether a later directory is a mask, which would tell voids in a way that is not read."""
        for _ in range(MAX_DIRECTORIES):
            if offset == 0:
                return False
            entries, offset = self._read_directory(offset)
            kinds = self._values(entries, SUBFILE_TYPE, 1)
            if len(kinds) and int(kinds[0]) & _MASK:
                return True
        raise TerrainFileError(f"The TIFF has more than {MAX_DIRECTORIES} images.")
