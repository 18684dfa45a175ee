"""The graph that planners use: the newest snapshot, memory-mapped, and the zones in force now."""

import fcntl
import logging
import threading
from datetime import datetime

import numpy as np
import shapely
from django.conf import settings

from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.snapshot_file import from_bytes, read_cache, write_cache
from inspection.graph.zone_index import ZoneIndex
from inspection.models import GraphSnapshot
from inspection.selectors.ground import ground_edition
from inspection.selectors.ground_data import zones_of_the_ground

logger = logging.getLogger(__name__)

KEPT_GRAPHS = 2  # per process: the newest, and the one that plans under way still hold


class NoGraph(Exception):
    """No snapshot has been built yet, or none of this version is kept."""


_lock = threading.Lock()
_graphs: dict[tuple[int, str], InspectionGraph] = {}
_zones: tuple[tuple[int, datetime | None], ZoneIndex] | None = None


def current_graph() -> InspectionGraph:
    """The newest snapshot. Costs one small query once the process has it."""
    return graph_of_row(GraphSnapshot.objects.values_list("version", "ground_revision", "arrays_sha256").first())


def graph_of_version(version: int) -> InspectionGraph:
    return graph_of_row(GraphSnapshot.objects.filter(version=version).values_list("version", "ground_revision", "arrays_sha256").first())


def zones_in_force() -> ZoneIndex:
    """The zones of the ground as it is now, whatever graph is in use. Costs one small query until they change."""
    return zones_of_edition(ground_edition())


def zones_of_edition(key: tuple[int, datetime | None]) -> ZoneIndex:
    """The zones of an edition of the ground that has just been read: they are at least as new as that."""
    global _zones
    remembered = _zones
    if remembered is None or remembered[0] != key:
        zones = zones_of_the_ground()
        polygons = shapely.from_wkb(np.array(zones.wkb, dtype=object))
        _zones = remembered = key, ZoneIndex(polygons, zones.identifier, zones.name)
    return remembered[1]


def graph_of_row(row: tuple[int, int, str] | None) -> InspectionGraph:
    """The graph of a snapshot's version, ground_revision and arrays_sha256; raises NoGraph for None."""
    if row is None:
        raise NoGraph
    version, ground_revision, content_sha256 = row
    key = version, content_sha256
    with _lock:
        if key not in _graphs:
            _graphs[key] = _load(version, ground_revision, content_sha256)
            for old in sorted(_graphs)[:-KEPT_GRAPHS]:
                if old != key:
                    del _graphs[old]
        return _graphs[key]


def _load(version: int, ground_revision: int, content_sha256: str) -> InspectionGraph:
    """The graph from its files; the first process that misses them writes them, and with them the index of an old snapshot."""
    graph = _read(version, ground_revision, content_sha256)
    if graph is not None:
        return graph
    content = GraphSnapshot.objects.filter(version=version).values_list("arrays", flat=True).first()
    if content is None:
        raise NoGraph
    write_planner_files(version, bytes(content), content_sha256)
    graph = _read(version, ground_revision, content_sha256)
    return graph or from_bytes(bytes(content), content_sha256=content_sha256, version=version, ground_revision=ground_revision)


def write_planner_files(version: int, content: bytes, content_sha256: str) -> None:
    """Unpack a snapshot and index it for all planners of this machine, one process at a time; does nothing where it is done."""
    folder = settings.GRAPH_CACHE_DIR
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / ".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if _read(version, 0, content_sha256) is None:
                write_cache(folder, content, content_sha256=content_sha256, version=version, tallest_m=settings.FLIGHT_RULES.tallest_m)
    except OSError as error:
        logger.warning("graph %d is kept in memory, its cache cannot be written: %s", version, error)


def _read(version: int, ground_revision: int, content_sha256: str) -> InspectionGraph | None:
    tallest_m = settings.FLIGHT_RULES.tallest_m
    return read_cache(
        settings.GRAPH_CACHE_DIR, content_sha256=content_sha256, version=version, ground_revision=ground_revision, tallest_m=tallest_m
    )
