"""The planners' graph: the newest network, cleared of the zones that a plan must avoid, memory-mapped."""

import fcntl
import logging
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from datetime import datetime
from typing import Any, Generic, TypeVar

from django.conf import settings
from django.db.models import QuerySet

from inspection.models import GraphSnapshot
from inspection.network.build.network import Network
from inspection.network.build.zone_masking import masked
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.snapshot_file import (
    LAYOUT,
    from_bytes,
    key_of_masked,
    read_masked,
    read_network,
    write_masked,
    write_network,
)
from inspection.network.zones.zone_index import ZoneIndex
from inspection.selectors.ground import ground_dataset_version
from inspection.selectors.zone_table import zone_table_of_version
from inspection.zones.reach import BoolArray, ZoneTable

logger = logging.getLogger(__name__)

KEPT = 6  # per process: the sets of zones of current and recent plans

Made = TypeVar("Made")
SnapshotRow = tuple[int, int, str]  # version, ground_revision, arrays_sha256


class NoGraph(Exception):
    """Raised when no snapshot has been built yet, or none of this version is stored."""


class _MadeOnce(Generic[Made]):
    """Cache of expensive values by last use. One thread makes a value; others wait only for the same one."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._made: OrderedDict[Hashable, Made] = OrderedDict()
        self._under_way: dict[Hashable, threading.Lock] = {}

    def get(self, key: Hashable, make: Callable[[], Made]) -> Made:
        made = self._look_up(key)
        if made is not None:
            return made
        with self._lock:
            own = self._under_way.setdefault(key, threading.Lock())
        with own:
            made = self._look_up(key)
            if made is None:
                try:
                    made = make()
                    self._keep(key, made)
                finally:
                    with self._lock:
                        self._under_way.pop(key, None)
        return made

    def _look_up(self, key: Hashable) -> Made | None:
        with self._lock:
            made = self._made.get(key)
            if made is not None:
                self._made.move_to_end(key)
            return made

    def _keep(self, key: Hashable, made: Made) -> None:
        with self._lock:
            self._made[key] = made
            while len(self._made) > KEPT:
                self._made.popitem(last=False)


_graphs: _MadeOnce[InspectionGraph] = _MadeOnce()
_indices: _MadeOnce[ZoneIndex] = _MadeOnce()
_networks: _MadeOnce[Network] = _MadeOnce()


def rules_of_snapshots() -> dict[str, Any]:
    """Return the rules of a snapshot made now. A snapshot with other rules is made again; one of another layout is not read."""
    return {"layout": LAYOUT} | asdict(settings.GRAPH_RULES)


def current_graph() -> InspectionGraph:
    """Return the newest snapshot's network, cleared of all current zones. Costs two small queries once the process has it."""
    return graph_for(_rows().first(), zones_in_force())


def graph_of_version(version: int) -> InspectionGraph:
    """Return the network of a snapshot, cleared of all current zones."""
    return graph_for(version, zones_in_force())


def zones_in_force() -> ZoneIndex:
    """Return the current zones, whatever graph is in use. Costs one small query until they change."""
    return zones_of_version(ground_dataset_version())


def zones_of_version(key: tuple[int, datetime | None]) -> ZoneIndex:
    """Return the zones of a dataset version that has just been read: they are at least as new."""
    return zones_of_table(zone_table_of_version(key))


def zones_of_table(table: ZoneTable, chosen: BoolArray | None = None) -> ZoneIndex:
    """Return all zones of a table, or those where the mask (z,) is true, each with the heights above ground that it may reach."""
    if chosen is None or chosen.all():
        return _indices.get((table, None), lambda: _index_of(table))
    return _indices.get((table, chosen.tobytes()), lambda: zones_of_table(table).where(chosen))


def _index_of(table: ZoneTable) -> ZoneIndex:
    return ZoneIndex(table.polygons, table.ids, table.names, floor_agl_m=table.floor_agl_m, ceiling_agl_m=table.ceiling_agl_m)


def graph_for(snapshot: SnapshotRow | int | None, zones: ZoneIndex) -> InspectionGraph:
    """Return the network of a snapshot, by its row or version, cleared of these zones at the heights flown.

    Costs nothing once the process has it; for a set of zones that is new on this machine, the graph is cleared and indexed first. Raises
    NoGraph for None, and for a version that is not stored or has an earlier layout.
    """
    row = _rows().filter(version=snapshot).first() if isinstance(snapshot, int) else snapshot
    if row is None:
        raise NoGraph
    key = (*row, zones.digest, zones.identity, settings.GRAPH_RULES, settings.FLOWN_HEIGHTS, settings.FLIGHT_RULES.tallest_m)
    return _graphs.get(key, lambda: _load(row, zones))


def network_for(row: SnapshotRow | None) -> Network:
    """Return the network of a snapshot without regard to zones. Raises NoGraph for None, and for a version that is not stored."""
    if row is None:
        raise NoGraph
    return _networks.get(row, lambda: _network(row))


def _network(row: SnapshotRow) -> Network:
    return read_network(settings.GRAPH_CACHE_DIR, content_sha256=row[2]) or from_bytes(_content(row), content_sha256=row[2])


def prepare_graph(row: SnapshotRow, content: Callable[[], bytes], zones: ZoneIndex) -> None:
    """Write the missing files of a network and of the graph cleared of these zones; one process at a time."""
    content_sha256 = row[2]
    try:
        with _only_process():
            if _read(row, zones) is None:
                folder, tallest_m = settings.GRAPH_CACHE_DIR, settings.FLIGHT_RULES.tallest_m
                network = read_network(folder, content_sha256=content_sha256)
                if network is None:
                    network = from_bytes(content(), content_sha256=content_sha256)
                    write_network(folder, network, content_sha256=content_sha256)
                graph = _masked(network, zones)
                write_masked(folder, graph, key=_key_of_files(content_sha256, zones), tallest_m=tallest_m)
    except OSError as error:
        logger.warning("graph %d is kept in memory, its cache cannot be written: %s", row[0], error)


def _rows() -> "QuerySet[GraphSnapshot, SnapshotRow]":
    """Return version, ground_revision and arrays_sha256 of the readable snapshots, newest first."""
    return GraphSnapshot.objects.filter(rules__layout=LAYOUT).values_list("version", "ground_revision", "arrays_sha256")


def _load(row: SnapshotRow, zones: ZoneIndex) -> InspectionGraph:
    """Return the graph from its files; the first process that finds them missing writes them."""
    graph = _read(row, zones)
    if graph is not None:
        return graph
    prepare_graph(row, lambda: _content(row), zones)
    return _read(row, zones) or _masked(from_bytes(_content(row), content_sha256=row[2]), zones, version=row[0], ground_revision=row[1])


def _content(row: SnapshotRow) -> bytes:
    content = GraphSnapshot.objects.filter(version=row[0]).values_list("arrays", flat=True).first()
    if content is None:
        raise NoGraph
    return bytes(content)


def _masked(network: Network, zones: ZoneIndex, **stamps: int) -> InspectionGraph:
    return masked(network, zones, settings.GRAPH_RULES, settings.FLOWN_HEIGHTS, **stamps).graph


def _read(row: SnapshotRow, zones: ZoneIndex) -> InspectionGraph | None:
    version, ground_revision, content_sha256 = row
    return read_masked(
        settings.GRAPH_CACHE_DIR,
        key=_key_of_files(content_sha256, zones),
        zones=zones,
        version=version,
        ground_revision=ground_revision,
        tallest_m=settings.FLIGHT_RULES.tallest_m,
    )


def _key_of_files(content_sha256: str, zones: ZoneIndex) -> str:
    return key_of_masked(content_sha256, zones, settings.GRAPH_RULES, settings.FLOWN_HEIGHTS, settings.FLIGHT_RULES.tallest_m)


@contextmanager
def _only_process() -> Iterator[None]:
    """Hold a lock among the processes of this machine and their threads."""
    folder = settings.GRAPH_CACHE_DIR
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
