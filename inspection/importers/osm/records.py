"""Records of an OSM file: one per asset, and counts."""

import hashlib
import json
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from shapely.geometry.base import BaseGeometry

from inspection.geodesy import LonLat

RECORD_VERSION = 1  # incremented when record rules change, so that a re-import refreshes the rows

Extent = tuple[float, float, float, float]  # west, south, east, north [deg]


@dataclass(frozen=True)
class OsmAssetRecord:
    """An asset as OSM describes it. geometry is in WGS84, lon lat; lengths and heights in metres; None means "not stated"."""

    kind: str  # tower, line, railway, bridge
    subtype: str
    osm_type: str  # n, w, r
    osm_id: int
    geometry: BaseGeometry
    centre: LonLat
    tags: dict[str, str]
    voltages_v: tuple[int, ...] = ()
    circuits: int | None = None
    height_m: float | None = None
    length_m: float | None = None
    is_flyable: bool = True
    node_osm_ids: tuple[int, ...] = ()
    parts: tuple[dict[str, Any], ...] = ()  # the ways on a bridge's area: {"osm_id", "tags"}

    @property
    def key(self) -> tuple[str, str, int]:
        return (self.kind, self.osm_type, self.osm_id)

    @property
    def name(self) -> str:
        return self._stated("name")

    @property
    def ref(self) -> str:
        return self._stated("ref")

    @property
    def operator(self) -> str:
        return self._stated("operator")

    def _stated(self, key: str) -> str:
        """Return the record's own tag, else that of its parts if they agree."""
        if key in self.tags:
            return self.tags[key]
        stated = {part["tags"][key] for part in self.parts if key in part["tags"]}
        return stated.pop() if len(stated) == 1 else ""

    @cached_property
    def content_hash(self) -> str:
        """Return a hash of the whole record, equal for equal content in every run."""
        facts = [
            RECORD_VERSION, self.key, self.subtype, self.geometry.wkb_hex, self.tags, self.voltages_v, self.circuits, self.height_m,
            self.is_flyable, self.node_osm_ids, self.parts,
        ]  # fmt: skip
        return hashlib.sha256(json.dumps(facts, sort_keys=True, ensure_ascii=True).encode()).hexdigest()


@dataclass(frozen=True)
class OsmContent:
    """The assets of one file. extent is None for an empty file; stated_extent comes from the file's header.

    records is empty if they were passed on in batches; kinds counts all of them by kind and subtype.
    """

    records: list[OsmAssetRecord]
    kinds: Counter[tuple[str, str]]
    is_unsorted: bool  # an object may have been passed twice
    counts: dict[str, Any]
    extent: Extent | None
    stated_extent: Extent | None
    data_timestamp: str | None
    attribution: str = field(default="© OpenStreetMap contributors, ODbL 1.0")
