"""Fill an empty database with what the load test needs: a graph of make_graph.py, its towers and bridges as assets, users with tokens.

    python deploy/load/prepare_ground.py --graph g200k.npz --users 10000 --missions 2000

The graph becomes a snapshot as it is: built from assets it would be another one, linked by Spanwise's own rules. Its towers and bridges
become assets, so that targets are what an operator picks; lines and railways are in the snapshot alone. Beside the graph it writes
`tokens.txt` (one bearer token a user, good for a week), `password.txt` (of all of them: only those who sign in need it),
`missions.json` (bodies for POST /api/v1/plans: 2 UAVs, 4 targets) and `large_missions.json` (3 UAVs, 16 targets: a worker's).
"""

import argparse
import json
import os
import secrets
import sys
from dataclasses import dataclass
from datetime import timedelta
from hashlib import sha256
from pathlib import Path
from time import perf_counter

import django
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.conf import settings  # noqa: E402 (Django first)
from django.contrib.auth.hashers import make_password  # noqa: E402
from django.contrib.gis.geos import Point, Polygon  # noqa: E402
from django.core.management import call_command  # noqa: E402
from django.db import transaction  # noqa: E402
from django.utils import timezone  # noqa: E402

from inspection.geodesy import distance_m  # noqa: E402
from inspection.models import Asset, AssetKind, GraphSnapshot  # noqa: E402
from inspection.network.build.network import Network  # noqa: E402
from inspection.network.inspection_graph import EdgeKind, NodeKind  # noqa: E402
from inspection.network.snapshot_file import to_bytes  # noqa: E402
from inspection.selectors.graph import rules_of_snapshots  # noqa: E402
from inspection.selectors.ground import ground_revision  # noqa: E402
from inspection.services.ground import mark_ground_changed  # noqa: E402
from workspace.api_tokens import hash_token  # noqa: E402
from workspace.models import DEFAULT_ORGANISATION_ID, ApiToken, Role, User  # noqa: E402

TOWER, RAILWAY, BRIDGE = 0, 1, 2  # kinds of make_graph.py
BRIDGE_HALF_DEG = 1e-4
M_PER_DEG = 111_195.0
OSM_DECIMALS = 7  # of a degree, a centimetre: as every position of OpenStreetMap has
TOKEN_DAYS = 7
LARGE_MISSIONS = 200


@dataclass(frozen=True)
class PlainGraph:
    """The arrays of make_graph.py's npz: position (n, 2) lon lat [deg], kind (n,), edge (m, 2)."""

    position: NDArray[np.float64]
    kind: NDArray[np.uint8]
    edge: NDArray[np.int32]

    @classmethod
    def read(cls, path: Path) -> "PlainGraph":
        with np.load(path, allow_pickle=False) as stored:
            edge = np.sort(np.column_stack([stored["u"], stored["v"]]), axis=1)
            edge = np.unique(edge[edge[:, 0] != edge[:, 1]], axis=0)
            position = np.column_stack([stored["lon"], stored["lat"]]).round(OSM_DECIMALS)
            return cls(position, stored["kind"], edge.astype(np.int32))

    def components(self) -> NDArray[np.int32]:
        nodes = len(self.position)
        links = coo_matrix((np.ones(len(self.edge)), (self.edge[:, 0], self.edge[:, 1])), shape=(nodes, nodes))
        labels: NDArray[np.int32] = connected_components(links, directed=False)[1]
        return labels


def store_assets(graph: PlainGraph) -> NDArray[np.int64]:
    """The primary key of each node's asset, -1 for nodes of railways."""
    keys = np.full(len(graph.position), -1, dtype=np.int64)
    nodes = np.flatnonzero(graph.kind != RAILWAY)
    for part in np.array_split(nodes, max(1, len(nodes) // 5_000)):
        rows = []
        for node in part.tolist():
            centre = Point(*graph.position[node].tolist(), srid=4326)
            if graph.kind[node] == TOWER:
                rows.append(Asset(kind=AssetKind.TOWER, subtype="tower", geometry=centre, centre=centre, ref=str(node)))
            else:
                half, (lon, lat) = BRIDGE_HALF_DEG, centre.coords
                outline = Polygon.from_bbox((lon - half, lat - half, lon + half, lat + half))
                outline.srid = 4326
                rows.append(Asset(kind=AssetKind.BRIDGE, subtype="area", geometry=outline, centre=centre, ref=str(node)))
        keys[part] = [row.pk for row in Asset.objects.bulk_create(rows)]
    return keys


def store_snapshot(graph: PlainGraph, keys: NDArray[np.int64]) -> GraphSnapshot:
    """The graph as it is, with the weights of our own geodesy; the newest snapshot of the present ground."""
    ends = graph.kind[graph.edge]
    edge_kind = np.full(len(graph.edge), EdgeKind.LINE, dtype=np.uint8)
    edge_kind[(ends == RAILWAY).all(axis=1)] = EdgeKind.RAILWAY
    edge_kind[(ends == RAILWAY).any(axis=1) & (ends == TOWER).any(axis=1)] = EdgeKind.RAILWAY_TO_TOWER
    edge_kind[(ends == BRIDGE).any(axis=1)] = EdgeKind.BRIDGE_TO_TOWER
    edge_kind[(ends == BRIDGE).all(axis=1)] = EdgeKind.BRIDGE_TO_BRIDGE
    length_m = distance_m(graph.position[graph.edge[:, 0]], graph.position[graph.edge[:, 1]])
    is_link = ~np.isin(edge_kind, (EdgeKind.LINE, EdgeKind.RAILWAY))
    arrays = Network(
        position=graph.position,
        node_kind=np.array([NodeKind.SUPPORT, NodeKind.RAILWAY, NodeKind.BRIDGE], dtype=np.uint8)[graph.kind],
        node_asset=keys,
        node_height_m=np.full(len(keys), np.nan),
        edge=graph.edge,
        length_m=length_m,
        cost=np.where(is_link, length_m * settings.GRAPH_RULES.off_network_factor, length_m),
        edge_kind=edge_kind,
        edge_asset=np.full(len(graph.edge), -1, dtype=np.int64),
    )
    content, components = to_bytes(arrays), int(graph.components().max()) + 1
    with transaction.atomic():  # or a worker that sees the new ground without its graph builds another one, without these edges
        mark_ground_changed()
        return GraphSnapshot.objects.create(
            ground_revision=ground_revision(),
            rules=rules_of_snapshots(),
            nodes=arrays.node_count,
            edges=arrays.edge_count,
            components=components,
            excluded_nodes=0,
            excluded_edges=0,
            arrays=content,
            arrays_sha256=sha256(content).hexdigest(),
            build_s=0.0,
        )


def store_users(number: int, password: str) -> list[str]:
    """Operators `load-0` and on with this password, and their tokens. Hashed once: for each alone it would take an hour."""
    hashed = make_password(password)
    User.objects.filter(username__startswith="load-").delete()
    users = User.objects.bulk_create(
        (
            User(username=f"load-{index}", role=Role.OPERATOR, organisation_id=DEFAULT_ORGANISATION_ID, password=hashed)
            for index in range(number)
        ),
        batch_size=1_000,
    )
    tokens = [f"spw_{secrets.token_urlsafe(32)}" for _ in users]
    expires_at = timezone.now() + timedelta(days=TOKEN_DAYS)
    ApiToken.objects.bulk_create(
        (
            ApiToken(user=user, name="load", token_sha256=hash_token(token), expires_at=expires_at)
            for user, token in zip(users, tokens, strict=True)
        ),
        batch_size=1_000,
    )
    return tokens


def request_bodies(
    graph: PlainGraph, keys: NDArray[np.int64], *, uavs: int, targets: int, count: int, radius_m: float | None, seed: int
) -> list[dict[str, object]]:
    """Random missions in one component: towers and bridges within the radius of a node, or anywhere (None); UAVs about 30 m beside some."""
    draw, component = np.random.default_rng(seed), graph.components()
    metres = graph.position * M_PER_DEG * [np.cos(np.radians(graph.position[:, 1].mean())), 1.0]
    tree, bodies = cKDTree(metres), []
    while len(bodies) < count:
        centre = int(draw.integers(len(graph.position)))
        near = np.arange(len(keys)) if radius_m is None else np.array(tree.query_ball_point(metres[centre], radius_m))
        near = near[(component[near] == component[centre]) & (keys[near] >= 0)]
        if len(near) < uavs + targets:
            continue
        picked = draw.choice(near, uavs + targets, replace=False)
        starts = graph.position[picked[:uavs]] + draw.normal(0.0, 3e-4, (uavs, 2))
        bodies.append(
            {
                "uavs": [{"name": f"UAV {number + 1}", "position": start} for number, start in enumerate(np.round(starts, 7).tolist())],
                "targets": [{"asset": key} for key in keys[picked[uavs:]].tolist()],
                "objective": "total",
                "return_to_start": False,
            }
        )
    return bodies


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--graph", type=Path, required=True, help="npz of make_graph.py")
    parser.add_argument("--users", type=int, default=10_000)
    parser.add_argument("--missions", type=int, default=2_000)
    parser.add_argument(
        "--radius-km", type=float, default=30.0, help="how far a mission spreads from its centre; 0: anywhere in the component"
    )
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()

    began_s = perf_counter()
    call_command("migrate", verbosity=0)
    graph = PlainGraph.read(options.graph)
    if Asset.objects.exists() and Asset.objects.exclude(ref__regex=r"^\d+$").exists():
        parser.error("this database has assets of its own: the load test wants an empty one")
    rows = dict(Asset.objects.values_list("ref", "pk"))
    keys = np.array([rows.get(str(node), -1) for node in range(len(graph.position))]) if rows else store_assets(graph)
    newest = GraphSnapshot.objects.defer("arrays").first()
    if newest is None or newest.nodes != len(graph.position) or newest.ground_revision != ground_revision():
        newest = store_snapshot(graph, keys)
    folder = options.graph.parent
    radius_m = options.radius_km * 1_000 or None
    bodies = request_bodies(graph, keys, uavs=2, targets=4, count=options.missions, radius_m=radius_m, seed=options.seed)
    (folder / "missions.json").write_text(json.dumps(bodies))
    large = request_bodies(graph, keys, uavs=3, targets=16, count=LARGE_MISSIONS, radius_m=radius_m, seed=options.seed)
    (folder / "large_missions.json").write_text(json.dumps(large))
    password = secrets.token_urlsafe(16)
    for name, text in (("tokens.txt", "\n".join(store_users(options.users, password))), ("password.txt", password)):
        (folder / name).touch(mode=0o600)
        (folder / name).write_text(text)
    print(f"graph {newest.version}: {newest.nodes:,} nodes, {newest.edges:,} edges; {Asset.objects.count():,} assets")
    print(f"{options.users:,} users, {len(bodies):,} missions, in {perf_counter() - began_s:.0f} s")


if __name__ == "__main__":
    main()
