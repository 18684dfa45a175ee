"""Builds graph snapshots after changes of the map data."""

from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from time import perf_counter

from django.conf import settings
from django.db import transaction

from inspection.models import GraphSnapshot
from inspection.network.build.network import network
from inspection.network.build.zone_masking import masked
from inspection.network.snapshot_file import to_bytes
from inspection.selectors.graph import NoGraph, current_graph, prepare_graph, rules_of_snapshots, zones_in_force
from inspection.selectors.ground import ground_revision
from inspection.selectors.ground_data import ground_data, has_flyable_assets
from workspace.leases import lock_until_end, try_lock_until_end

BUILD_LOCK = 5_372_001  # advisory lock
KEPT_SNAPSHOTS = 20


def build_graph(*, force: bool = False, progress: Callable[[str, float], None] | None = None) -> GraphSnapshot:
    """Build and store a snapshot, or return the newest one if it matches the current map data and rules.

    One build runs at a time; a waiting caller gets the other's snapshot.
    """
    with transaction.atomic():
        lock_until_end(BUILD_LOCK)
        snapshot = None if force else _current_snapshot()
        return snapshot or _build_and_store(progress)


def refresh_graph() -> GraphSnapshot | None:
    """Build a snapshot if the newest one is outdated; None when nothing is to do or another build runs."""
    if _current_snapshot() is not None or not (has_flyable_assets() or GraphSnapshot.objects.exists()):
        return None
    with transaction.atomic():
        is_ours = try_lock_until_end(BUILD_LOCK)
        return _build_and_store(None) if is_ours and _current_snapshot() is None else None


def _current_snapshot() -> GraphSnapshot | None:
    """Return the newest snapshot, if it matches the current map data and rules."""
    snapshot = GraphSnapshot.objects.defer("arrays").first()
    is_current = snapshot and snapshot.ground_revision == ground_revision() and snapshot.rules == rules_of_snapshots()
    return snapshot if is_current else None


def _build_and_store(progress: Callable[[str, float], None] | None) -> GraphSnapshot:
    started_s = perf_counter()
    notify = progress or (lambda message, fraction: None)
    notify("clearing the zones", 0.0)
    _clear_newest_network()
    notify("reading the ground", 0.2)
    ground = ground_data()
    notify("joining lines and railways", 0.4)
    whole = network(ground, settings.GRAPH_RULES)
    content = to_bytes(whole)
    notify("clearing the zones", 0.7)
    zones = zones_in_force()
    built = masked(whole, zones, settings.GRAPH_RULES, settings.FLOWN_HEIGHTS)
    snapshot = GraphSnapshot.objects.create(
        ground_revision=ground.revision,
        rules=rules_of_snapshots(),
        nodes=built.graph.node_count,
        edges=built.graph.edge_count,
        components=built.components,
        excluded_nodes=built.excluded_nodes,
        excluded_edges=built.excluded_edges,
        arrays=content,
        arrays_sha256=sha256(content).hexdigest(),
        build_s=perf_counter() - started_s,
    )
    # Before the commit: readers of the snapshot find its files and its index.
    prepare_graph((snapshot.version, snapshot.ground_revision, snapshot.arrays_sha256), lambda: content, zones)
    newest = list(GraphSnapshot.objects.values_list("version", flat=True)[:KEPT_SNAPSHOTS])
    GraphSnapshot.objects.filter(version__lt=newest[-1]).delete()
    return snapshot


def _clear_newest_network() -> None:
    """Clear the newest network: mostly only zones have changed, and planners continue at once while the map data are read and compared."""
    with suppress(NoGraph):
        current_graph()
