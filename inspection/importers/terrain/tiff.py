"""The parts of a TIFF file: its directory, and the unpacking of its strips and tiles."""

import zlib
from typing import IO, Any, Literal

import numpy as np
from numpy.typing import NDArray

from inspection.importers.terrain.raster import TerrainFileError

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
    """Directory of a TIFF file. Raises TerrainFileError for a truncated or contradictory one."""

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
        """Return all values of a tag, none if the file does not have it."""
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
        """Return tag → (type, count, position of the value or of its offset), and the position of the next directory; 0 for none."""
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
        """Whether a later directory is a mask, which would mark voids in an unsupported form."""
        for _ in range(MAX_DIRECTORIES):
            if offset == 0:
                return False
            entries, offset = self._read_directory(offset)
            kinds = self._values(entries, SUBFILE_TYPE, 1)
            if len(kinds) and int(kinds[0]) & _MASK:
                return True
        raise TerrainFileError(f"The TIFF has more than {MAX_DIRECTORIES} images.")


NONE, LZW, DEFLATE, PACKBITS, OLD_DEFLATE = 1, 5, 8, 32773, 32946
READ = (NONE, LZW, DEFLATE, PACKBITS, OLD_DEFLATE)
NAMES = {6: "JPEG", 7: "JPEG", 34887: "LERC", 34925: "LZMA", 50000: "ZSTD", 50001: "WebP"}
_CLEAR, _END = 256, 257
_SINGLE = [bytes((value,)) for value in range(256)] + [b"", b""]
_WIDEST = 12
_DAMAGED = "A part of the TIFF cannot be unpacked: it is damaged or cut off."


def unpacked_part(data: bytes, compression: int, size_bytes: int) -> bytes:
    """Return exactly size_bytes, or raise TerrainFileError. Surplus data of a bomb are not unpacked."""
    if compression == NONE:
        found = data[:size_bytes]
    elif compression == LZW:
        found = _unpacked_lzw(data, size_bytes)
    elif compression == PACKBITS:
        found = _unpacked_packbits(data, size_bytes)
    else:
        found = _inflated(data, size_bytes)
    if len(found) < size_bytes:
        raise TerrainFileError(_DAMAGED)
    return found


def _inflated(data: bytes, size_bytes: int) -> bytes:
    """Return the data with its checksum verified, unless there is more than requested."""
    stream = zlib.decompressobj()
    try:
        found = stream.decompress(data, size_bytes)
        more = b"" if stream.eof else stream.decompress(stream.unconsumed_tail, 1)
    except zlib.error as error:
        raise TerrainFileError(_DAMAGED) from error
    if not stream.eof and not more:
        raise TerrainFileError(_DAMAGED)
    return found


def _unpacked_lzw(data: bytes, size_bytes: int) -> bytes:
    """Return data of LZW codes of 9 to 12 bits, most significant bit first; the width grows one code early, as in TIFF."""
    out = bytearray()
    table = _SINGLE.copy()
    previous = b""
    buffer = held = 0
    width = 9
    for byte in data:
        buffer = (buffer << 8) | byte
        held += 8
        if held < width:
            continue
        held -= width
        code = buffer >> held
        buffer &= (1 << held) - 1
        if code == _CLEAR:
            table = _SINGLE.copy()
            previous, width = b"", 9
            continue
        if code == _END:
            break
        known = len(table)
        if code < known:
            entry = table[code]
            if previous:
                table.append(previous + entry[:1])
        elif code == known and previous:
            entry = previous + previous[:1]
            table.append(entry)
        else:
            raise TerrainFileError(_DAMAGED)
        out += entry
        if len(out) >= size_bytes:
            return bytes(out[:size_bytes])
        previous = entry
        if known + 2 >= 1 << width and width < _WIDEST:
            width += 1
        elif known > 1 << _WIDEST:
            raise TerrainFileError(_DAMAGED)
    return bytes(out)


def _unpacked_packbits(data: bytes, size_bytes: int) -> bytes:
    out = bytearray()
    place = 0
    while place < len(data) and len(out) < size_bytes:
        head = data[place]
        if head < 128:
            out += data[place + 1 : place + 2 + head]
            place += head + 2
        elif head > 128:
            out += data[place + 1 : place + 2] * (257 - head)
            place += 2
        else:
            place += 1
    return bytes(out[:size_bytes])


def without_predictor(data: bytes, predictor: int, dtype: np.dtype[np.generic], rows: int, columns: int) -> NDArray[np.generic]:
    """Return the values of a part of rows x columns; dtype has the file's byte order."""
    if predictor == 3:
        steps = np.frombuffer(data, dtype=np.uint8).reshape(rows, dtype.itemsize * columns)
        planes = np.add.accumulate(steps, axis=1, dtype=np.uint8).reshape(rows, dtype.itemsize, columns)
        return np.ascontiguousarray(planes.transpose(0, 2, 1)).view(dtype.newbyteorder(">")).reshape(rows, columns)
    values = np.frombuffer(data, dtype=dtype).reshape(rows, columns)
    if predictor == 2:
        native = values.astype(dtype.newbyteorder("="))
        whole = native.view(f"u{dtype.itemsize}")
        return np.add.accumulate(whole, axis=1, dtype=whole.dtype).view(native.dtype)
    return values
