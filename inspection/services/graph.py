"""Builds graph snapshots when the ground has changed."""

from collections.abc import Callable
from dataclasses import asdict
from hashlib import sha256
from time import perf_counter

from django.conf import settings
from django.db import connection, transaction

from inspection.graph.build import build
from inspection.graph.snapshot_file import to_bytes
from inspection.models import GraphSnapshot
from inspection.selectors.graph import write_planner_files
from inspection.selectors.ground import ground_revision
from inspection.selectors.ground_data import ground_data, has_flyable_assets

BUILD_LOCK = 5_372_001  # any number that nothing else locks
KEPT_SNAPSHOTS = 20


def build_graph(*, force: bool = False, progress: Callable[[str, float], None] | None = None) -> GraphSnapshot:
    """Build and store a snapshot of the ground, or return the newest one if it already shows the ground under today's rules.

    One build runs at a time: whoever waits for another's finds its snapshot.
    """
    with transaction.atomic():
        with connection.cursor() as cursor:
            cursor.execute("SELECT pg_advisory_xact_lock(%s)", [BUILD_LOCK])
        snapshot = None if force else _current_snapshot()
        return snapshot or _build_and_store(progress)


def refresh_graph() -> GraphSnapshot | None:
    """Build a snapshot if there are assets that the newest one does not show; None when there is nothing to do or another builds."""
    if _current_snapshot() is not None or not (has_flyable_assets() or GraphSnapshot.objects.exists()):
        return None
    with transaction.atomic():
        with connection.cursor() as cursor:
            cursor.execute("SELECT pg_try_advisory_xact_lock(%s)", [BUILD_LOCK])
            (is_ours,) = cursor.fetchone()
        return _build_and_store(None) if is_ours and _current_snapshot() is None else None


def _current_snapshot() -> GraphSnapshot | None:
    """The newest snapshot, if it shows the present ground under the present rules."""
    snapshot = GraphSnapshot.objects.defer("arrays").first()
    rules = asdict(settings.GRAPH_RULES)
    return snapshot if snapshot and snapshot.ground_revision == ground_revision() and snapshot.rules == rules else None


def _build_and_store(progress: Callable[[str, float], None] | None) -> GraphSnapshot:
    started_s = perf_counter()
    if progress is not None:
        progress("reading the ground", 0.0)
    built = build(ground_data(), settings.GRAPH_RULES, progress)
    content = to_bytes(built.graph)
    snapshot = GraphSnapshot.objects.create(
        ground_revision=built.graph.ground_revision,
        rules=asdict(settings.GRAPH_RULES),
        nodes=built.graph.node_count,
        edges=built.graph.edge_count,
        components=built.components,
        excluded_nodes=built.excluded_nodes,
        excluded_edges=built.excluded_edges,
        arrays=content,
        arrays_sha256=sha256(content).hexdigest(),
        build_s=perf_counter() - started_s,
    )
    # Before the commit: whoever sees the snapshot finds its files and its index.
    write_planner_files(snapshot.version, content, snapshot.arrays_sha256)
    newest = list(GraphSnapshot.objects.values_list("version", flat=True)[:KEPT_SNAPSHOTS])
    GraphSnapshot.objects.filter(version__lt=newest[-1]).delete()
    return snapshot
