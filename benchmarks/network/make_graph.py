# ruff: noqa: N806 (matrices and counts as in mathematics)
"""Synthetic power-grid-like inspection graph (towers, railway nodes, bridges) + no-fly polygons.

    python make_graph.py --nodes 50000 --out g50k.npz [--polygons 500] [--seed 1]

The npz is the plain exchange format of all scripts here:
  lat, lon  float64[n]   degrees          kind  uint8[n]  0 tower, 1 railway, 2 bridge
  u, v      int32[m]     undirected edge  w     float64[m] haversine metres
  poly_xy   float64[k,2] lon/lat rings, poly_off int64[p+1] ring offsets (no-fly, NOT yet applied)
"""

import argparse

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree
from scipy.spatial import Delaunay, cKDTree

R = 6371008.8
LAT0, LON0 = 55.3, 10.3


def haversine(lat1, lon1, lat2, lon2):
    p1, p2 = np.radians(lat1), np.radians(lat2)
    a = np.sin((p2 - p1) / 2) ** 2 + np.cos(p1) * np.cos(p2) * np.sin(np.radians(lon2 - lon1) / 2) ** 2
    return 2 * R * np.arcsin(np.sqrt(a))


def to_ll(xy):
    """local metres -> lat, lon (plain equirectangular; only used to place points)."""
    lat = LAT0 + xy[:, 1] / 111195.0
    lon = LON0 + xy[:, 0] / (111195.0 * np.cos(np.radians(LAT0)))
    return lat, lon


def network(rng, pts, island, extra):
    """MST per island plus a share of the shortest other Delaunay edges."""
    tri = Delaunay(pts).simplices
    e = np.unique(np.sort(np.vstack([tri[:, [0, 1]], tri[:, [1, 2]], tri[:, [0, 2]]]), axis=1), axis=0)
    e = e[island[e[:, 0]] == island[e[:, 1]]]
    d = np.hypot(*(pts[e[:, 0]] - pts[e[:, 1]]).T)
    n = len(pts)
    t = minimum_spanning_tree(csr_matrix((d, (e[:, 0], e[:, 1])), shape=(n, n))).tocoo()
    mst = np.sort(np.c_[t.row, t.col], axis=1)
    key = set(map(tuple, mst.tolist()))
    rest = np.array([k for k, x in enumerate(map(tuple, e.tolist())) if x not in key], dtype=int)
    rest = rest[np.argsort(d[rest] * rng.uniform(0.6, 1.4, len(rest)))][: int(extra * n)]
    return np.vstack([mst, e[rest]])


def subdivide(rng, pts, edges, step, base):
    """Chains of towers about `step` metres apart along each edge, with a smooth sideways bow."""
    xy, us, vs = [], [], []
    nxt = base
    for a, b in edges:
        p, q = pts[a], pts[b]
        L = np.hypot(*(q - p))
        k = max(1, round(L / step))
        t = np.arange(1, k) / k
        if k > 1:
            t = t + rng.uniform(-0.12, 0.12, k - 1) / k
        nrm = np.array([-(q - p)[1], (q - p)[0]])
        bow = rng.uniform(-0.06, 0.06) * np.sin(np.pi * t) + rng.uniform(-0.02, 0.02) * np.sin(3 * np.pi * t)
        xy.append(p + t[:, None] * (q - p) + bow[:, None] * nrm)
        ids = np.r_[a, np.arange(nxt, nxt + k - 1), b]
        us.append(ids[:-1])
        vs.append(ids[1:])
        nxt += k - 1
    return np.vstack(xy), np.concatenate(us), np.concatenate(vs)


def make(n, seed=1, polygons=0):
    rng = np.random.default_rng(seed)
    side = 150e3 * np.sqrt(n / 5000)
    n_br = max(4, int(0.005 * n))

    def grid(total, frac_sub):
        S = max(12, int(total * frac_sub))
        pts = rng.uniform(-side / 2, side / 2, (S, 2))
        # two small islands and a mainland, 12 km of water between them
        isl = np.searchsorted([0.12, 0.30], pts[:, 0] / side + 0.5)
        pts[:, 0] += isl * 12e3
        ed = network(rng, pts, isl, 0.35)
        L = np.hypot(*(pts[ed[:, 0]] - pts[ed[:, 1]]).T).sum()
        xy, u, v = subdivide(rng, pts, ed, L / (total - S + len(ed)), S)
        return np.vstack([pts, xy]), u, v

    n_rail = int(0.09 * n)
    txy, tu, tv = grid(n - n_rail - n_br, 0.022)
    rxy, ru, rv = grid(n_rail, 0.015)
    nt, nr = len(txy), len(rxy)
    xy = np.vstack([txy, rxy])
    u = np.r_[tu, ru + nt]
    v = np.r_[tv, rv + nt]
    # railway stations (network junctions) join the nearest tower within 3 km
    tt = cKDTree(txy)
    S = max(12, int(n_rail * 0.015))
    d, j = tt.query(rxy[:S], distance_upper_bound=3000)
    ok = np.isfinite(d)
    u = np.r_[u, nt + np.flatnonzero(ok)]
    v = np.r_[v, j[ok]]
    # bridges: near towers; nearest tower within 3 km, other bridges within 5 km (the paper's rule)
    c = txy[rng.integers(0, nt, n_br)] + rng.normal(0, 1500, (n_br, 2))
    d, j = tt.query(c, distance_upper_bound=3000)
    ok = np.isfinite(d)
    b0 = nt + nr
    u = np.r_[u, b0 + np.flatnonzero(ok)]
    v = np.r_[v, j[ok]]
    pr = cKDTree(c).query_pairs(5000, output_type="ndarray")
    u = np.r_[u, b0 + pr[:, 0]]
    v = np.r_[v, b0 + pr[:, 1]]
    xy = np.vstack([xy, c])
    kind = np.r_[np.zeros(nt, np.uint8), np.ones(nr, np.uint8), np.full(len(c), 2, np.uint8)]
    lat, lon = to_ll(xy)
    w = haversine(lat[u], lon[u], lat[v], lon[v])
    # no-fly polygons: irregular rings, radius 0.3-6 km, near the lines half of the time
    rings, off = [], [0]
    for k in range(polygons):
        ctr = txy[rng.integers(nt)] + rng.normal(0, 2500, 2) if k % 2 else rng.uniform(-side / 2, side / 2, 2)
        m = int(rng.integers(5, 60))
        ang = np.sort(rng.uniform(0, 2 * np.pi, m))
        rad = np.exp(rng.uniform(np.log(300), np.log(6000))) * rng.uniform(0.6, 1.0, m)
        ring = ctr + np.c_[np.cos(ang), np.sin(ang)] * rad[:, None]
        la, lo = to_ll(np.vstack([ring, ring[:1]]))
        rings.append(np.c_[lo, la])
        off.append(off[-1] + m + 1)
    return {
        "lat": lat,
        "lon": lon,
        "kind": kind,
        "u": u.astype(np.int32),
        "v": v.astype(np.int32),
        "w": w,
        "poly_xy": np.vstack(rings) if rings else np.zeros((0, 2)),
        "poly_off": np.array(off, np.int64),
    }


def missions(g, n_uav, n_tgt, count, seed=7, radius_m=30e3):
    """Random missions in one connected component; all points within radius_m of a centre (None: anywhere)."""
    rng = np.random.default_rng(seed)
    n = len(g["lat"])
    _, lab = connected_components(coo_matrix((np.ones(len(g["u"])), (g["u"], g["v"])), shape=(n, n)), directed=False)
    xy = np.c_[g["lon"] * np.cos(np.radians(LAT0)), g["lat"]] * 111195.0
    tree = cKDTree(xy)
    out = []
    while len(out) < count:
        c = rng.integers(n)
        cand = np.arange(n) if radius_m is None else np.array(tree.query_ball_point(xy[c], radius_m))
        cand = cand[lab[cand] == lab[c]]
        if len(cand) < n_tgt + n_uav:
            if radius_m is not None and n_tgt > 50:
                radius_m *= 1.5
            continue
        pick = rng.choice(cand, n_uav + n_tgt, replace=False)
        uav = np.c_[g["lat"][pick[:n_uav]], g["lon"][pick[:n_uav]]] + rng.normal(0, 3e-4, (n_uav, 2))
        out.append({"uavs": uav.tolist(), "targets": pick[n_uav:].tolist()})
    return out


if __name__ == "__main__":
    ap = argparse.ArgumentParser()
    ap.add_argument("--nodes", type=int, default=5000)
    ap.add_argument("--polygons", type=int, default=50)
    ap.add_argument("--seed", type=int, default=1)
    ap.add_argument("--out", required=True)
    a = ap.parse_args()
    g = make(a.nodes, a.seed, a.polygons)
    n = len(g["lat"])
    deg = np.bincount(np.r_[g["u"], g["v"]], minlength=n)
    nc, lab = connected_components(coo_matrix((np.ones(len(g["u"])), (g["u"], g["v"])), shape=(n, n)), directed=False)
    print(
        f"nodes {n} edges {len(g['u'])} deg2 {np.mean(deg == 2):.4f} deg1 {np.mean(deg == 1):.4f} "
        f"components {nc} biggest {np.bincount(lab).max()} median edge {np.median(g['w']):.0f} m total {g['w'].sum() / 1e3:.0f} km"
    )
    np.savez(a.out, **g)
