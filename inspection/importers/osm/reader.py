"""Reads an OSM file into asset records in a few streaming passes, so that memory depends on the infrastructure, not on the file."""

from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import osmium
from numpy.typing import NDArray
from osmium.filter import KeyFilter
from shapely import LineString, Point

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.wgs84 import FloatArray
from inspection.importers.osm import tags as meaning
from inspection.importers.osm.bridges import BridgeArea, BridgeWay, BrokenArea, bridges_of, polygon_of_relation, polygon_of_ring
from inspection.importers.osm.file_validator import OsmFileError, OsmFormat, Progress, examine
from inspection.importers.osm.overpass import rewrite_as_pbf
from inspection.importers.osm.records import Extent, OsmAssetRecord, OsmContent
from operation.reasons import Reason

MAX_NODES_KEPT = 50_000_000  # four times the nodes of all the world's power lines; more is not infrastructure
MAX_NODES_PER_WAY = 10_000  # OSM's own limit is 2,000
_LENGTH_DECIMALS = 6
BATCH = 5_000
_CHUNK = 20_000
_NOWHERE = (float("nan"), float("nan"))

Take = Callable[[list[OsmAssetRecord]], None]
"""Is given records, some thousand at a time, and keeps none of them."""


@dataclass(frozen=True)
class _Way:
    osm_id: int
    tags: dict[str, str]
    refs: NDArray[np.int64]


@dataclass(frozen=True)
class _Relation:
    osm_id: int
    tags: dict[str, str]
    outer: tuple[int, ...]
    inner: tuple[int, ...]


def read_osm(path: Path, progress: Progress | None = None, take: Take | None = None) -> OsmContent:
    """Return the assets of an .osm.pbf, .osm, .osm.gz, .osm.bz2 or Overpass JSON file. Raises OsmFileError if it is not readable.

    With `take` the records are passed to it in batches and not stored, so that memory does not grow with their number. A duplicate object
    in an unsorted file is then passed twice, the valid one last.
    """
    file_format = examine(path, progress)
    try:
        if file_format not in {OsmFormat.JSON, OsmFormat.JSON_GZIP, OsmFormat.JSON_BZIP2}:
            return _OsmReader(osmium.io.File(str(path), file_format.value), progress, take).content(None)
        with TemporaryDirectory() as folder:
            rewritten = Path(folder) / "overpass.osm.pbf"
            timestamp = rewrite_as_pbf(path, file_format, rewritten)
            return _OsmReader(osmium.io.File(str(rewritten), "pbf"), progress, take).content(timestamp)
    except (RuntimeError, ValueError, OSError, EOFError, IndexError, OverflowError, osmium.InvalidLocationError) as error:
        if isinstance(error, OsmFileError):
            raise
        raise OsmFileError(f"The file is damaged: {error}") from error


class _Batch:
    """Collects records, or passes them on in batches of some thousand; totals are counted on the way."""

    def __init__(self, take: Take | None) -> None:
        self._take = take
        self.kept: list[OsmAssetRecord] = []
        self.kinds: Counter[tuple[str, str]] = Counter()
        self.is_unsorted = False
        self._row_of: dict[int, int] = {}  # of stored supports: the last one of a number counts
        self._last_id = 0
        self._bounds: list[tuple[float, float, float, float]] = []
        self.extent: Extent | None = None

    def add_sorted(self, record: OsmAssetRecord) -> None:
        """Add a support; files have supports in the order of their numbers, without duplicates."""
        self.is_unsorted |= record.osm_id <= self._last_id
        self._last_id = record.osm_id
        if self._take is None and record.osm_id in self._row_of:
            row = self._row_of[record.osm_id]
            self.kinds[self.kept[row].kind, self.kept[row].subtype] -= 1
            self.kinds[record.kind, record.subtype] += 1
            self.kept[row] = record
            return
        if self._take is None:
            self._row_of[record.osm_id] = len(self.kept)
        self.add(record)

    def add(self, record: OsmAssetRecord) -> None:
        self.kinds[record.kind, record.subtype] += 1
        self._bounds.append(record.geometry.bounds)
        self.kept.append(record)
        if len(self._bounds) == BATCH:
            self._widen()
            if self._take is not None:
                self.give()

    def give(self) -> None:
        """Pass on the rest."""
        self._widen()
        if self._take is not None and self.kept:
            self._take(self.kept)
            self.kept = []

    def _widen(self) -> None:
        if not self._bounds:
            return
        bounds = np.array(self._bounds if self.extent is None else [*self._bounds, self.extent])
        self.extent = (*map(float, bounds[:, :2].min(axis=0)), *map(float, bounds[:, 2:].max(axis=0)))  # type: ignore[assignment]
        self._bounds = []


class _OsmReader:
    """The passes over one file, in order; each stores only what a later one or a record needs."""

    def __init__(self, file: Any, progress: Progress | None, take: Take | None) -> None:
        self.file = file
        self.batch = _Batch(take)
        self.progress = progress or (lambda stage, share: None)
        self.counts: Counter[str] = Counter()
        self.skipped: Counter[str] = Counter()
        self.node_ids: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self.positions: FloatArray = np.zeros((0, 2))

    def content(self, timestamp: str | None) -> OsmContent:
        header = osmium.FileProcessor(self.file, osmium.osm.NOTHING).header
        self.progress(Reason("reading_relations"), 0.05)
        relations = self._read_relations()
        self.progress(Reason("reading_ways"), 0.15)
        ways = self._read_ways()
        members = self._read_members(relations, ways)
        self.progress(Reason("reading_way_nodes"), 0.4)
        self._read_positions([way.refs for way in (*ways.values(), *members.values())])
        self.progress(Reason("reading_towers"), 0.7)
        self._supports()
        self.progress(Reason("making_geometry"), 0.8)
        self._ways_and_bridges(ways, relations, members)
        self.progress(Reason("osm_read"), 1.0)
        batch = self.batch
        batch.give()
        stated = header.get("osmosis_replication_timestamp") or header.get("timestamp") or None
        return OsmContent(
            records=batch.kept, kinds=batch.kinds, is_unsorted=batch.is_unsorted, counts=self._counts(), extent=batch.extent,
            stated_extent=_stated_extent(header.box()), data_timestamp=timestamp or stated,
        )  # fmt: skip

    def _tagged(self, entities: Any, *keys: str) -> Iterator[Any]:
        """Yield the objects with one of the keys; the others are skipped in C++."""
        items: Iterable[Any] = osmium.FileProcessor(self.file, entities).with_filter(KeyFilter(*keys))
        for item in items:
            if item.deleted:
                self.skipped["deleted"] += 1
            elif item.id <= 0:
                self.skipped["without_osm_id"] += 1
            else:
                yield item

    def _numbered(self, entities: Any, ids: Container[int]) -> Iterator[Any]:
        """Yield the objects with these ids. osmium's IdFilter would use 4 MiB for every 2^25 ids, however few are needed."""
        items: Iterable[Any] = osmium.FileProcessor(self.file, entities)
        for item in items:
            if item.id in ids and not item.deleted:
                yield item

    def _read_relations(self) -> list[_Relation]:
        relations = []
        for item in self._tagged(osmium.osm.RELATION, "man_made"):
            tags = dict(item.tags)
            if tags.get("man_made") != "bridge" or tags.get("type") != "multipolygon":
                continue
            members = [(member.ref, member.role) for member in item.members if member.type == "w" and member.ref > 0]
            outer = tuple(ref for ref, role in members if role != "inner")
            relations.append(_Relation(item.id, tags, outer, tuple(ref for ref, role in members if role == "inner")))
        return relations

    def _read_ways(self) -> dict[int, _Way]:
        ways: dict[int, _Way] = {}
        total = 0
        for item in self._tagged(osmium.osm.WAY, "power", "railway", "bridge", "man_made"):
            tags = dict(item.tags)
            if not (
                meaning.power_way_kind(tags) or meaning.railway_kind(tags) or meaning.is_bridge(tags) or tags.get("man_made") == "bridge"
            ):
                continue
            way = _way(item, tags)
            total += len(way.refs)
            if total > MAX_NODES_KEPT:
                raise OsmFileError(f"The file has lines, railways and bridges of more than {MAX_NODES_KEPT} nodes.")
            ways[way.osm_id] = way
        return ways

    def _read_members(self, relations: Sequence[_Relation], ways: dict[int, _Way]) -> dict[int, _Way]:
        """Return the ways that outline bridge areas, including untagged ones."""
        wanted = {ref for relation in relations for ref in relation.outer + relation.inner}
        found = {ref: ways[ref] for ref in wanted if ref in ways}
        if missing := wanted - found.keys():
            found.update((item.id, _way(item, dict(item.tags))) for item in self._numbered(osmium.osm.WAY, missing))
        return found

    def _read_positions(self, refs: list[NDArray[np.int64]]) -> None:
        if not refs:
            return
        wanted = np.unique(np.concatenate(refs))
        wanted = wanted[wanted > 0]
        positions = np.full((len(wanted), 2), np.nan)
        if len(wanted):
            for ids, places in self._nodes_in_chunks():
                rows = np.minimum(np.searchsorted(wanted, ids), len(wanted) - 1)
                is_wanted = wanted[rows] == ids
                self.skipped["node_not_on_earth"] += int(np.isnan(places[is_wanted, 0]).sum())
                is_wanted &= ~np.isnan(places[:, 0])
                positions[rows[is_wanted]] = places[is_wanted]
        if not self.skipped["node_not_on_earth"]:
            del self.skipped["node_not_on_earth"]
        found = ~np.isnan(positions[:, 0])
        self.node_ids, self.positions = wanted[found], positions[found]

    def _nodes_in_chunks(self) -> Iterator[tuple[NDArray[np.int64], FloatArray]]:
        """Yield ids and positions of all nodes in chunks of some ten thousand; NaN for invalid positions."""
        ids: list[int] = []
        places: list[tuple[float, float]] = []
        nodes: Iterable[Any] = osmium.FileProcessor(self.file, osmium.osm.NODE)
        for node in nodes:
            if node.deleted:
                continue
            location = node.location
            ids.append(node.id)
            places.append((location.lon, location.lat) if location.valid() else _NOWHERE)
            if len(ids) == _CHUNK:
                yield np.array(ids, dtype=np.int64), np.array(places, dtype=np.float64)
                ids, places = [], []
        if ids:
            yield np.array(ids, dtype=np.int64), np.array(places, dtype=np.float64)

    def _located(self, way: _Way) -> tuple[NDArray[np.int64], FloatArray, int]:
        """Return the way's nodes in the file, their positions, and the number of missing ones."""
        if len(self.node_ids) == 0:
            return way.refs[:0], np.zeros((0, 2)), len(way.refs)
        places = np.minimum(np.searchsorted(self.node_ids, way.refs), len(self.node_ids) - 1)
        found = self.node_ids[places] == way.refs
        return way.refs[found], self.positions[places[found]], int(len(way.refs) - found.sum())

    def _supports(self) -> None:
        for node in self._tagged(osmium.osm.NODE, "power"):
            tags = dict(node.tags)
            kind = tags["power"]
            if kind not in meaning.SUPPORT_KINDS:
                continue
            if not node.location.valid():
                self.skipped["node_not_on_earth"] += 1
                continue
            place = LonLat(node.location.lon, node.location.lat)
            record = OsmAssetRecord(
                kind="tower", subtype=kind, osm_type="n", osm_id=node.id, geometry=Point(place), centre=place, tags=tags,
                voltages_v=meaning.voltages_v(tags.get("voltage")), circuits=meaning.circuits(tags.get("circuits")),
                height_m=meaning.height_m(tags),
            )  # fmt: skip
            self.batch.add_sorted(record)

    def _ways_and_bridges(self, ways: dict[int, _Way], relations: Sequence[_Relation], members: dict[int, _Way]) -> None:
        located = [self._located(way) for way in ways.values()]
        lengths = _lengths_m([points for _, points, _ in located])
        bridge_ways: list[BridgeWay] = []
        areas: list[BridgeArea] = []
        for way, (refs, points, missing), length_m in zip(ways.values(), located, lengths, strict=True):
            line, railway = meaning.power_way_kind(way.tags), meaning.railway_kind(way.tags)
            is_bridge = meaning.is_bridge(way.tags)
            self._count(line, railway, is_bridge, length_m)
            self.counts["missing_nodes"] += missing
            if way.tags.get("man_made") == "bridge":
                self._add_closed_area(way, missing, points, areas)
            reason = _why_no_line(points, length_m)
            for wanted, name in ((line, "line"), (railway, "railway"), (is_bridge, "bridge")):
                if wanted and reason:
                    self.skipped[f"{name}_{reason}"] += 1
            if reason:
                continue
            length_m = round(length_m, _LENGTH_DECIMALS)
            node_ids = tuple(refs.tolist())
            if line:
                self.batch.add(_line_record(way, line, points, length_m, node_ids))
            if railway:
                self.batch.add(_railway_record(way, railway, points, length_m, node_ids))
            if is_bridge and np.abs(np.diff(points[:, 0])).max() <= 180.0:
                bridge_ways.append(BridgeWay(way.osm_id, way.tags, points, node_ids, length_m))
            elif is_bridge:
                self.skipped["bridge_across_antimeridian"] += 1
        self._add_relation_areas(relations, members, areas)
        for record in bridges_of(bridge_ways, areas):
            self.batch.add(record)

    def _count(self, line: str | None, railway: str | None, is_bridge: bool, length_m: float) -> None:
        if line:
            self.counts[line] += 1
            self.counts[f"{line}_km"] += length_m / 1_000  # type: ignore[assignment]
        if railway:
            own = "railway" if railway == "rail" else railway if railway in meaning.RAILWAYS_IN_USE else f"railway_{railway}"
            self.counts[own] += 1
            self.counts[f"{own}_km"] += length_m / 1_000  # type: ignore[assignment]
        if is_bridge:
            self.counts["bridge_ways"] += 1
            self.counts["railway_bridge_ways"] += railway == "rail"

    def _add_closed_area(self, way: _Way, missing: int, points: FloatArray, areas: list[BridgeArea]) -> None:
        if len(way.refs) < 4 or way.refs[0] != way.refs[-1]:
            self.skipped["bridge_area_not_closed"] += 1
            return
        self.counts["bridge_areas"] += 1
        if missing:
            self.skipped["bridge_area_incomplete"] += 1
            return
        try:
            areas.append(BridgeArea("w", way.osm_id, way.tags, polygon_of_ring(points)))
        except BrokenArea:
            self.skipped["bridge_area_invalid"] += 1

    def _add_relation_areas(self, relations: Sequence[_Relation], members: dict[int, _Way], areas: list[BridgeArea]) -> None:
        for relation in relations:
            self.counts["bridge_areas"] += 1
            lines: list[list[FloatArray]] = []
            missing = 0
            for refs in (relation.outer, relation.inner):
                located = [self._located(members[ref]) if ref in members else None for ref in refs]
                missing += sum(1 for item in located if item is None or item[2])
                lines.append([item[1] for item in located if item is not None])
            if missing:
                self.skipped["bridge_area_incomplete"] += 1
                continue
            try:
                areas.append(BridgeArea("r", relation.osm_id, relation.tags, polygon_of_relation(*lines)))
            except BrokenArea:
                self.skipped["bridge_area_invalid"] += 1

    def _counts(self) -> dict[str, Any]:
        counts: dict[str, Any] = dict.fromkeys(
            ("tower", "pole", "portal", "line", "minor_line", "cable", "railway", "bridge_ways", "railway_bridge_ways", "bridge_areas"), 0
        )
        kinds = self.batch.kinds
        counts |= {"bridge": sum(number for (kind, _), number in kinds.items() if kind == "bridge"), "missing_nodes": 0}
        counts |= {subtype: number for (kind, subtype), number in kinds.items() if kind == "tower"}
        counts |= dict.fromkeys(("line_km", "minor_line_km", "railway_km"), 0.0)
        counts |= {key: round(float(value), 3) if key.endswith("_km") else int(value) for key, value in sorted(self.counts.items())}
        return counts | {"skipped": dict(sorted(self.skipped.items()))}


def _way(item: Any, tags: dict[str, str]) -> _Way:
    nodes = item.nodes
    return _Way(item.id, tags, np.fromiter((node.ref for node in nodes), dtype=np.int64, count=len(nodes)))


def _lengths_m(paths: Sequence[FloatArray]) -> FloatArray:
    """Return the geodesic length of each path, measured in one call."""
    if not paths:
        return np.zeros(0)
    points = np.concatenate(paths)
    owner = np.repeat(np.arange(len(paths)), [len(path) for path in paths])
    same = owner[1:] == owner[:-1]
    steps = distance_m(points[:-1][same], points[1:][same])
    return np.bincount(owner[1:][same], weights=steps, minlength=len(paths)).astype(np.float64)


def _why_no_line(points: FloatArray, length_m: float) -> str | None:
    if len(points) < 2:
        return "too_few_nodes"
    if len(points) > MAX_NODES_PER_WAY:
        return "too_many_nodes"
    return "without_length" if length_m <= 0.0 else None


def _middle(points: FloatArray) -> LonLat:
    """Return the midpoint along the path; on a step across the antimeridian, the vertex before it."""
    steps = distance_m(points[:-1], points[1:])
    along = np.concatenate([[0.0], np.cumsum(steps)])
    index = min(int(np.searchsorted(along, along[-1] / 2, side="right")) - 1, len(steps) - 1)
    step = points[index + 1] - points[index]
    if abs(step[0]) > 180.0 or steps[index] == 0.0:
        return LonLat(*map(float, points[index]))
    return LonLat(*map(float, points[index] + step * (along[-1] / 2 - along[index]) / steps[index]))


def _line_record(way: _Way, kind: str, points: FloatArray, length_m: float, node_ids: tuple[int, ...]) -> OsmAssetRecord:
    return OsmAssetRecord(
        kind="line", subtype=kind, osm_type="w", osm_id=way.osm_id, geometry=LineString(points), centre=_middle(points), tags=way.tags,
        voltages_v=meaning.voltages_v(way.tags.get("voltage")), circuits=meaning.circuits(way.tags.get("circuits")),
        height_m=meaning.height_m(way.tags), length_m=length_m, is_flyable=meaning.is_flyable_line(way.tags), node_osm_ids=node_ids,
    )  # fmt: skip


def _railway_record(way: _Way, kind: str, points: FloatArray, length_m: float, node_ids: tuple[int, ...]) -> OsmAssetRecord:
    return OsmAssetRecord(
        kind="railway", subtype=kind, osm_type="w", osm_id=way.osm_id, geometry=LineString(points), centre=_middle(points), tags=way.tags,
        voltages_v=meaning.voltages_v(way.tags.get("voltage")), length_m=length_m, is_flyable=meaning.is_flyable_railway(way.tags),
        node_osm_ids=node_ids,
    )  # fmt: skip


def _stated_extent(box: Any) -> Extent | None:
    if not box.valid():
        return None
    return (box.bottom_left.lon, box.bottom_left.lat, box.top_right.lon, box.top_right.lat)
