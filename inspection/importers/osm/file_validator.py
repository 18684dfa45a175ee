"""Validates an OSM file before a parser reads it: its format, and that it is no decompression bomb."""

import bz2
import gzip
import re
import zlib
from collections.abc import Callable, Iterator
from enum import StrEnum
from pathlib import Path
from typing import BinaryIO

from operation.reasons import Reason

MAX_BLOB_HEADER_BYTES = 64 * 1024  # OSM wiki, PBF format: "should be less than 32 KiB and must be less than 64 KiB"
MAX_BLOB_BYTES = 32 * 1024 * 1024  # same page, for the uncompressed size
MAX_BLOB_FIELDS = 100  # a Blob and its header have a handful
MAX_BLOCK_FIELDS = 10_000  # the groups of a block, which holds some 8,000 objects
MAX_BLOCK_STRINGS = 500_000  # in one block's table: 60 per object
MAX_UNPACKED_BYTES = 64 * 1024**3
MAX_RATIO = 100  # OSM XML compresses about 10:1, bzip2 up to 20:1; a bomb 1,000:1 and more
FREE_UNPACKED_BYTES = 4 * 1024 * 1024  # below this size any ratio is accepted
BOMB = f"The file unpacks to more than {MAX_RATIO} times its size; refused as a decompression bomb."
_CHUNK = 1024 * 1024
_BLOB_TYPES = {b"OSMHeader", b"OSMData"}

Progress = Callable[[Reason, float], None]


class OsmFileError(ValueError):
    """Raised for a file that is no valid OSM data; the message is a sentence for its user."""


class OsmFormat(StrEnum):
    """File formats. The values are libosmium's names, except for JSON, which it does not read."""

    PBF = "pbf"
    XML = "osm"
    XML_GZIP = "osm.gz"
    XML_BZIP2 = "osm.bz2"
    JSON = "json"
    JSON_GZIP = "json.gz"
    JSON_BZIP2 = "json.bz2"


def open_unpacked(path: Path, file_format: OsmFormat) -> BinaryIO:
    if file_format in {OsmFormat.XML_GZIP, OsmFormat.JSON_GZIP}:
        return gzip.open(path)  # type: ignore[return-value]
    if file_format in {OsmFormat.XML_BZIP2, OsmFormat.JSON_BZIP2}:
        return bz2.open(path)  # type: ignore[return-value]
    return path.open("rb")


def examine(path: Path, progress: Progress | None = None) -> OsmFormat:
    """Return the file's format, detected from its content, and scan it once. Raises OsmFileError for content of no ordinary file."""
    try:
        file_format = _format_of(path)
        if file_format is OsmFormat.PBF:
            _examine_pbf(path)
        else:
            _examine_stream(path, file_format, progress)
    except (OSError, EOFError, zlib.error) as error:
        raise OsmFileError(Reason("file_unreadable", {"error": str(error)})) from error
    return file_format


def _format_of(path: Path) -> OsmFormat:
    with path.open("rb") as file:
        start = file.read(16)
    if not start:
        raise OsmFileError(Reason("file_empty"))
    if start[:2] == b"\x1f\x8b":
        return _format_inside(path, OsmFormat.XML_GZIP, OsmFormat.JSON_GZIP)
    if start[:3] == b"BZh":
        return _format_inside(path, OsmFormat.XML_BZIP2, OsmFormat.JSON_BZIP2)
    if start[:2] == b"\x00\x00" or b"OSMHeader" in start:
        return OsmFormat.PBF
    return _format_inside(path, OsmFormat.XML, OsmFormat.JSON)


def _format_inside(path: Path, xml: OsmFormat, json: OsmFormat) -> OsmFormat:
    with open_unpacked(path, xml) as file:
        text = file.read(256).removeprefix(b"\xef\xbb\xbf").lstrip()
    if text.startswith(b"<"):
        return xml
    if text.startswith(b"{"):
        return json
    raise OsmFileError(Reason("no_osm_format"))


def _examine_stream(path: Path, file_format: OsmFormat, progress: Progress | None) -> None:
    """Unpack the text once without storing it: check its size, and that no XML token is endless."""
    packed_bytes = path.stat().st_size
    is_packed = file_format not in {OsmFormat.XML, OsmFormat.JSON}
    is_xml = file_format in {OsmFormat.XML, OsmFormat.XML_GZIP, OsmFormat.XML_BZIP2}
    if not is_packed and not is_xml:
        return  # the JSON reader limits each element itself
    unpacked = 0
    with open_unpacked(path, file_format) as file:
        while chunk := file.read(_CHUNK):
            unpacked += len(chunk)
            if is_packed and unpacked > FREE_UNPACKED_BYTES and unpacked > MAX_RATIO * packed_bytes:
                raise OsmFileError(BOMB)
            if unpacked > MAX_UNPACKED_BYTES:
                raise OsmFileError(f"The file unpacks to more than {MAX_UNPACKED_BYTES // 1024**3} GiB.")
            if is_xml and len(chunk) == _CHUNK and b">" not in chunk:
                raise OsmFileError("The XML has a tag of more than 1 MiB.")
            if progress is not None and unpacked % (64 * _CHUNK) < _CHUNK:
                progress(Reason("looking_file_over", {"size": unpacked // 1024**2}), 0.0)


def _examine_pbf(path: Path) -> None:
    """Scan all blobs, one in memory at a time."""
    size, unpacked = path.stat().st_size, 0
    with path.open("rb") as file:
        offset = 0
        while offset < size:
            file.seek(offset)
            prefix = file.read(4)
            header_bytes = int.from_bytes(prefix, "big")
            if len(prefix) < 4 or header_bytes == 0:
                raise OsmFileError(Reason("pbf_damaged", {"byte": offset}))
            if header_bytes > MAX_BLOB_HEADER_BYTES:
                raise OsmFileError(f"The PBF has a blob header of {header_bytes} bytes at byte {offset}; the format allows 64 KiB.")
            blob_type, blob_bytes = _blob_header(file.read(header_bytes), offset)
            if offset == 0 and blob_type != b"OSMHeader":
                raise OsmFileError("The PBF does not begin with an OSM header.")
            if blob_type not in _BLOB_TYPES and not re.fullmatch(rb"[\x20-\x7e]{1,64}", blob_type):
                raise OsmFileError(f"The PBF has a blob of no known type at byte {offset}.")
            start = offset + 4 + header_bytes
            if not 0 < blob_bytes <= MAX_BLOB_BYTES:
                raise OsmFileError(f"The PBF has a blob of {blob_bytes} bytes at byte {offset}; the format allows 32 MiB.")
            if start + blob_bytes > size:
                raise OsmFileError(f"The PBF is cut off: the blob at byte {offset} goes past the end of the file.")
            unpacked += _examine_blob(file, start, start + blob_bytes)
            if unpacked > FREE_UNPACKED_BYTES and unpacked > MAX_RATIO * size:
                raise OsmFileError(BOMB)
            offset = start + blob_bytes


def _blob_header(data: bytes, offset: int) -> tuple[bytes, int]:
    """Return the type (field 1) and datasize (field 3) of a BlobHeader message."""
    blob_type, blob_bytes = b"", -1
    try:
        for number, value in _fields(data, MAX_BLOB_FIELDS):
            if number == 1 and isinstance(value, memoryview):
                blob_type = bytes(value)
            elif number == 3 and isinstance(value, int):
                blob_bytes = value
    except (IndexError, _TooManyFields) as error:
        raise OsmFileError(f"The PBF is damaged: no blob header can be read at byte {offset}.") from error
    return blob_type, blob_bytes


def _examine_blob(file: BinaryIO, start: int, end: int) -> int:
    """Check a Blob message: raw_size (field 2), and the strings of its data, plain (field 1) or zlib (field 3).

    Returns the unpacked size of its data [bytes].
    """
    file.seek(start)
    raw_size: int | None = None
    packed = plain = None
    try:
        for number, value in _fields(file.read(end - start), MAX_BLOB_FIELDS):
            if number == 2 and isinstance(value, int):
                raw_size = value
            elif number == 1 and isinstance(value, memoryview):
                plain = value
            elif number == 3 and isinstance(value, memoryview):
                packed = value
        if raw_size is not None and raw_size > MAX_BLOB_BYTES:
            raise OsmFileError(f"The PBF has a blob that unpacks to {raw_size} bytes at byte {start}; the format allows 32 MiB.")
        if packed is not None:
            unpacked = zlib.decompressobj().decompress(packed, MAX_BLOB_BYTES + 1)
            if raw_size is None or len(unpacked) != raw_size:
                raise OsmFileError(f"The PBF is damaged: the blob at byte {start} does not unpack to the size that it states.")
            plain = memoryview(unpacked)
        if plain is None:
            raise OsmFileError("The PBF is packed with another method than zlib, which is not read; write it anew with zlib.")
        if _has_string_with_null(plain):
            raise OsmFileError(f"The PBF has a text with a null character in the blob at byte {start}.")
        return len(plain)
    except IndexError as error:
        raise OsmFileError(f"The PBF is damaged: no blob can be read at byte {start}.") from error
    except _TooManyFields as error:
        raise OsmFileError(f"The PBF has more parts than a file of its kind may have, in the blob at byte {start}.") from error


def _has_string_with_null(block: memoryview) -> bool:
    """Whether the string table (field 1) of a PrimitiveBlock has a null character, at which libosmium reads past its buffer."""
    for number, table in _fields(block, MAX_BLOCK_FIELDS):
        if number == 1 and isinstance(table, memoryview):
            text = bytes(table)
            if text.count(0) == text.startswith(b"\x0a\x00"):  # every table begins with the empty string
                continue
            if any(isinstance(string, memoryview) and 0 in string for _, string in _fields(table, MAX_BLOCK_STRINGS)):
                return True
    return False


class _TooManyFields(Exception):
    """Raised for a message with more fields than its kind may have."""


def _fields(data: bytes | memoryview, max_fields: int) -> Iterator[tuple[int, int | memoryview]]:
    """Yield the fields of a protobuf message, numbers and byte strings. Raises IndexError if invalid, _TooManyFields beyond max_fields."""
    view, at, number = memoryview(data), 0, 0
    while at < len(view):
        if (number := number + 1) > max_fields:
            raise _TooManyFields
        key, at = _varint(view, at)
        if key & 7 == 0:
            value, at = _varint(view, at)
            yield key >> 3, value
        elif key & 7 == 2:
            length, at = _varint(view, at)
            if at + length > len(view):
                raise IndexError
            yield key >> 3, view[at : at + length]
            at += length
        else:
            raise IndexError


def _varint(data: memoryview, at: int) -> tuple[int, int]:
    """Return a protobuf varint and the offset after it. Raises IndexError if there is none."""
    value = 0
    for shift in range(0, 70, 7):
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
    raise IndexError
