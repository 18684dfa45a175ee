"""Unpacks the strips and tiles of a TIFF, never to more than they may have. Source: Adobe TIFF 6.0 and its Technical Note 3."""

import zlib

import numpy as np
from numpy.typing import NDArray

from inspection.importers.terrain.errors import TerrainFileError

NONE, LZW, DEFLATE, PACKBITS, OLD_DEFLATE = 1, 5, 8, 32773, 32946
READ = (NONE, LZW, DEFLATE, PACKBITS, OLD_DEFLATE)
NAMES = {6: "JPEG", 7: "JPEG", 34887: "LERC", 34925: "LZMA", 50000: "ZSTD", 50001: "WebP"}
_CLEAR, _END = 256, 257
_SINGLE = [bytes((value,)) for value in range(256)] + [b"", b""]
_WIDEST = 12
_DAMAGED = "A part of the TIFF cannot be unpacked: it is damaged or cut off."


def unpacked_part(data: bytes, compression: int, size_bytes: int) -> bytes:
    """Exactly size_bytes, or TerrainFileError. What a bomb has besides is not unpacked."""
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
    """With the checksum behind it verified, unless there is more than was asked for."""
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
    """Codes of 9 to 12 bits, the highest bit first; the width grows one code early, as TIFF has it."""
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
    """The values of a part of rows x columns; dtype has the file's byte order."""
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
