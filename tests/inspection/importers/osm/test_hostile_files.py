"""Row S5 of the target table, as far as OSM files go: refused fast, and before a parser sees them."""

import bz2
import gzip
import random
import resource
import struct
import zlib

import pytest

from inspection.importers.osm.file_validator import MAX_BLOB_BYTES, OsmFileError, examine
from inspection.importers.osm.reader import read_osm
from tests.runaway import no_runaway


def varint(value):
    out = b""
    while value > 0x7F:
        out += bytes([value & 0x7F | 0x80])
        value >>= 7
    return out + bytes([value])


def field(number, data):
    return varint(number << 3 | 2) + varint(len(data)) + data


def blob(kind, data, raw_size=None, header_padding=b""):
    packed = zlib.compress(data)
    body = varint(2 << 3) + varint(len(data) if raw_size is None else raw_size) + field(3, packed)
    header = field(1, kind) + (field(2, header_padding) if header_padding else b"") + varint(3 << 3) + varint(len(body))
    return struct.pack(">I", len(header)) + header + body


def other_blob(packed):
    body = varint(2 << 3) + varint(100) + packed
    header = field(1, b"OSMData") + varint(3 << 3) + varint(len(body))
    return struct.pack(">I", len(header)) + header + body


def plain_blob(data):
    return other_blob(field(1, data))


HEADER = blob(b"OSMHeader", field(4, b"OsmSchema-V0.6") + field(4, b"DenseNodes"))

HOSTILE = {  # made by the test that needs it: some take seconds and hundreds of megabytes
    "blob that says it unpacks to 2 GiB": lambda: HEADER + blob(b"OSMData", b"x" * 100, raw_size=2 * 1024**3),
    "first blob that says it unpacks to 2 GiB": lambda: blob(b"OSMHeader", b"x" * 100, raw_size=2 * 1024**3),
    "blob header above 64 KiB": lambda: HEADER + blob(b"OSMData", b"x", header_padding=b"\0" * 65_536),
    "blob header of 4 GiB": lambda: b"\xff\xff\xff\xff" + b"A" * 100,
    "blob longer than the file": lambda: HEADER + blob(b"OSMData", b"x" * 1_000)[:-5],
    "blob that unpacks to more than it says": lambda: HEADER + blob(b"OSMData", b"\0" * 30_000_000, raw_size=1_000),
    "blob of noise": lambda: HEADER + blob(b"OSMData", bytes(range(256)) * 40),
    "tag with a null character": lambda: HEADER + blob(b"OSMData", field(1, field(1, b"") + field(1, b"po\0er") + field(1, b"tower"))),
    "blob packed with another method": lambda: HEADER + other_blob(field(4, b"lzma")),
    "30 kB of millions of empty fields": lambda: HEADER + blob(b"OSMData", b"\x0a\x00" * 15_000_000),
    "30 kB of one table of millions of empty texts": lambda: HEADER + blob(b"OSMData", field(1, b"\x0a\x00" * 15_000_000)),
    "millions of empty fields, not packed": lambda: HEADER + plain_blob(b"\x0a\x00" * 15_000_000),
    "one table of millions of empty texts, not packed": lambda: HEADER + plain_blob(field(1, b"\x0a\x00" * 15_000_000)),
    "blob of millions of fields": lambda: HEADER + other_blob(b"\x10\x00" * 15_000_000),
    "header alone cut off": lambda: HEADER[:10],
    "only nulls": lambda: b"\0" * 1_000_000,
    "gzip bomb": lambda: gzip.compress(b"<osm version='0.6'>" + b" " * 200_000_000),
    "bzip2 bomb": lambda: bz2.compress(b"<osm version='0.6'>" + b" " * 100_000_000),
    "gzip in gzip": lambda: gzip.compress(gzip.compress(b"<osm version='0.6'></osm>")),
    "gzip cut off": lambda: gzip.compress(b"<osm version='0.6'>" + bytes(range(33, 60)) * 1_000)[:-50],
    "endless tag": lambda: b"<osm version='0.6'><node id='1' " + b"a" * 5_000_000,
    "json of one endless element": lambda: b'{"elements": [{"a": "' + b"a" * 40_000_000,
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_before_it_costs_much(name, tmp_path):
    path = tmp_path / "hostile.osm.pbf"
    path.write_bytes(HOSTILE[name]())
    before_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with no_runaway(), pytest.raises(OsmFileError):
        read_osm(path)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kib < 150 * 1024
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.long
def test_an_honest_blob_of_the_largest_size_passes_the_gate(tmp_path):
    path = tmp_path / "large.osm.pbf"
    path.write_bytes(HEADER + blob(b"OSMData", field(2, random.Random(1).randbytes(MAX_BLOB_BYTES // 2 - 3).hex().encode())))
    assert examine(path) == "pbf"


@pytest.mark.parametrize("name", ["quillmoor.osm.pbf", "liechtenstein-2021-infra.osm.pbf"])
def test_a_file_cut_anywhere_is_refused(name, tmp_path, region_file):
    data = region_file(name).read_bytes()
    for length in range(1, len(data) - 1, len(data) // 40):
        path = tmp_path / "cut.osm.pbf"
        path.write_bytes(data[:length])
        with pytest.raises(OsmFileError):
            read_osm(path)
