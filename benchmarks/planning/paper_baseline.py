# ruff: noqa: N803, N806, PLC0415, PTH123, SIM115 (matrices and counts as in mathematics; a script)
"""Paper-faithful baseline: one A* per (UAV, target) and per (target, target) pair, then an OR-tools VRP.

What the paper states is followed; what it leaves open is a default below:
  * graph cost = distance between neighbours; A* on it (heuristic here: great-circle, so A* is exact);
  * the shortest path is computed for every combination (undirected, so each pair once), path kept;
  * assignment: vehicle routing over that matrix, one vehicle per UAV, open routes (end anywhere),
    every reachable target once. OR-tools, matrix read through a Python callback (--matrix registers it).
    objective "sum" (total distance) or "max" (longest route, span cost).
  * UAV position is joined to its nearest graph node by a straight leg.

    python paper_baseline.py --graph g.npz --missions missions.json --json out.json
    python paper_baseline.py --graph g.npz --workload 2x4 --count 5

missions.json: [{"uavs": [[lat, lon], ...], "targets": [node, ...]}, ...]
graph: npz as written by make_graph.py, or JSON {"nodes": [[lat, lon], ...], "edges": [[u, v, w], ...]}.
Output per mission: cost_m (sum), makespan_m, routes (target order), waypoints (node ids), time split in ms.
"""

import argparse
import itertools
import json
import math
import random
import statistics as st
import time

import networkx as nx
import numpy as np
from scipy.spatial import cKDTree

R = 6371008.8


def load_graph(path):
    if path.endswith(".npz"):
        z = np.load(path)
        return z["lat"], z["lon"], z["u"], z["v"], z["w"]
    d = json.load(open(path))
    ll = np.array(d["nodes"], float)
    e = np.array(d["edges"], float)
    return ll[:, 0], ll[:, 1], e[:, 0].astype(int), e[:, 1].astype(int), e[:, 2]


def build(lat, lon, u, v, w):
    G = nx.Graph()
    G.add_nodes_from(range(len(lat)))
    G.add_weighted_edges_from(zip(u.tolist(), v.tolist(), w.tolist(), strict=False))
    pos = list(zip(np.radians(lat).tolist(), np.radians(lon).tolist(), np.cos(np.radians(lat)).tolist(), strict=False))
    sin, asin, sqrt = math.sin, math.asin, math.sqrt

    def h(a, b):
        p, q = pos[a], pos[b]
        s, t = sin((q[0] - p[0]) / 2), sin((q[1] - p[1]) / 2)
        # 1e-9 relative shrink keeps rounding from making the heuristic inadmissible
        return 2 * R * asin(sqrt(s * s + p[2] * q[2] * t * t)) * (1 - 1e-9)

    return G, h


_tree = {}


def unit(lat, lon):
    p, q = np.radians(lat), np.radians(lon)
    return np.stack([np.cos(p) * np.cos(q), np.cos(p) * np.sin(q), np.sin(p)], axis=-1)


def nearest(lat, lon, p):
    """Nearest node by great circle: k-d tree over unit vectors, built once per graph."""
    if id(lat) not in _tree:
        _tree[id(lat)] = cKDTree(unit(lat, lon)), lat
    c, k = _tree[id(lat)][0].query(unit(p[0], p[1]))
    return int(k), float(2 * R * np.arcsin(c / 2))


def astar(G, h, a, b):
    try:
        p = nx.astar_path(G, a, b, heuristic=h, weight="weight")
    except nx.NetworkXNoPath:
        return math.inf, None
    return nx.path_weight(G, p, "weight"), p


def path_matrix(G, h, starts, legs, targets, sample=None, rng=random):
    """D over [uavs..., targets...]; paths by index pair. With `sample`, time that many pairs only."""
    nu, nt = len(starts), len(targets)
    node = list(starts) + list(targets)
    pairs = [(i, nu + j) for i in range(nu) for j in range(nt)]
    pairs += [(nu + i, nu + j) for i in range(nt) for j in range(i + 1, nt)]
    total = len(pairs)
    if sample and sample < total:
        pairs = rng.sample(pairs, sample)
    D = np.full((nu + nt, nu + nt), math.inf)
    P = {}
    t0 = time.perf_counter()
    for i, j in pairs:
        d, p = astar(G, h, node[i], node[j])
        P[i, j] = p
        if i < nu:
            D[i, j] = d + legs[i]
        else:
            D[i, j] = D[j, i] = d
    dt = time.perf_counter() - t0
    return D, P, dt, dt / len(pairs) * total, total


def ortools_routes(D, nu, nt, objective="sum", matrix=False, limit_s=0.0, first="PATH_CHEAPEST_ARC", meta=None):
    """Open multi-depot routes. D indexed [uavs, targets]. Returns list of target-index lists."""
    from ortools.constraint_solver import pywrapcp
    from ortools.constraint_solver import routing_enums_pb2 as en

    big = 10**8
    n = nu + nt + 1  # last node: dummy end, reached at no cost
    M = np.zeros((n, n), dtype=np.int64)
    Q = np.where(np.isfinite(D), np.round(D), big).astype(np.int64)
    M[: nu + nt, : nu + nt] = Q
    M[:, :nu] = big  # nobody goes to another UAV's start
    M[:, n - 1] = 0
    man = pywrapcp.RoutingIndexManager(n, nu, list(range(nu)), [n - 1] * nu)
    r = pywrapcp.RoutingModel(man)
    if matrix:
        cb = r.RegisterTransitMatrix(M.tolist())
    else:
        L = M.tolist()
        cb = r.RegisterTransitCallback(lambda a, b: L[man.IndexToNode(a)][man.IndexToNode(b)])
    r.SetArcCostEvaluatorOfAllVehicles(cb)
    if objective == "max":
        r.AddDimension(cb, 0, 10**12, True, "d")
        r.GetDimensionOrDie("d").SetGlobalSpanCostCoefficient(100)
    p = pywrapcp.DefaultRoutingSearchParameters()
    p.first_solution_strategy = getattr(en.FirstSolutionStrategy, first)
    if meta:
        p.local_search_metaheuristic = getattr(en.LocalSearchMetaheuristic, meta)
    if limit_s:
        p.time_limit.FromMilliseconds(int(limit_s * 1000))
    s = r.SolveWithParameters(p)
    if s is None:
        return None
    out = []
    for k in range(nu):
        i, seq = r.Start(k), []
        while not r.IsEnd(i):
            x = man.IndexToNode(i)
            if x >= nu:
                seq.append(x - nu)
            i = s.Value(r.NextVar(i))
        out.append(seq)
    return out


def route_costs(D, nu, routes):
    c = []
    for k, seq in enumerate(routes):
        t, a = 0.0, k
        for j in seq:
            t += D[a, nu + j]
            a = nu + j
        c.append(t)
    return c


def expand(P, nu, routes):
    out = []
    for k, seq in enumerate(routes):
        way, a = [], k
        for j in seq:
            b = nu + j
            p = P[a, b] if (a, b) in P else P[b, a]
            if p is None:  # no path between these two: the leg is left out
                continue
            p = p if (a, b) in P else p[::-1]
            way += p if not way else p[1:]
            a = b
        out.append(way)
    return out


def plan(G, h, lat, lon, mission, objective="sum", matrix=False):
    t = [time.perf_counter()]
    near = [nearest(lat, lon, p) for p in mission["uavs"]]
    t.append(time.perf_counter())
    nu, nt = len(near), len(mission["targets"])
    D, P, *_ = path_matrix(G, h, [x[0] for x in near], [x[1] for x in near], mission["targets"])
    t.append(time.perf_counter())
    routes = ortools_routes(D, nu, nt, objective, matrix)
    t.append(time.perf_counter())
    way = expand(P, nu, routes)
    t.append(time.perf_counter())
    c = route_costs(D, nu, routes)
    ms = [round((b - a) * 1e3, 4) for a, b in itertools.pairwise(t)]
    return {
        "cost_m": sum(c),
        "makespan_m": max(c),
        "routes": routes,
        "waypoints": way,
        "ms": dict(zip(("nearest", "matrix", "assign", "expand"), ms, strict=False), total=round((t[-1] - t[0]) * 1e3, 4)),
    }


if __name__ == "__main__":
    ap = argparse.ArgumentParser()
    ap.add_argument("--graph", required=True)
    ap.add_argument("--missions")
    ap.add_argument("--workload", default="2x4", help="UAVSxTARGETS, used without --missions")
    ap.add_argument("--radius-km", type=float, default=30, help="0: anywhere in the component")
    ap.add_argument("--count", type=int, default=5)
    ap.add_argument("--objective", choices=("sum", "max"), default="sum")
    ap.add_argument("--matrix", action="store_true", help="register the matrix instead of a Python callback")
    ap.add_argument("--sample", type=int, help="time only this many pairs of the path matrix, extrapolate, no plan")
    ap.add_argument("--json")
    a = ap.parse_args()
    lat, lon, u, v, w = load_graph(a.graph)
    t0 = time.perf_counter()
    G, h = build(lat, lon, u, v, w)
    print(f"graph {len(lat)} nodes, built in {time.perf_counter() - t0:.2f} s")
    if a.missions:
        ms = json.load(open(a.missions))
    else:
        from make_graph import missions

        x, y = map(int, a.workload.split("x"))
        ms = missions({"lat": lat, "lon": lon, "u": u, "v": v}, x, y, a.count, radius_m=a.radius_km * 1e3 or None)
    res = []
    for k, m in enumerate(ms):
        if a.sample:
            near = [nearest(lat, lon, p) for p in m["uavs"]]
            *_, dt, full, total = path_matrix(G, h, [x[0] for x in near], [x[1] for x in near], m["targets"], a.sample, random.Random(k))
            res.append(full)
            print(
                f"mission {k}: {min(a.sample, total)} of {total} pairs timed, {full / total * 1e3:.2f} ms per pair, "
                f"whole matrix about {full:.2f} s",
                flush=True,
            )
            continue
        r = plan(G, h, lat, lon, m, a.objective, a.matrix)
        res.append(r)
        print(
            f"mission {k}: sum {r['cost_m']:.0f} m, longest {r['makespan_m']:.0f} m, {sum(map(len, r['waypoints']))} waypoints, {r['ms']}",
            flush=True,
        )
    if a.sample:
        print(f"matrix s: min {min(res):.3f} median {st.median(res):.3f}")
    else:
        for key in ("nearest", "matrix", "assign", "expand", "total"):
            x = [r["ms"][key] for r in res]
            print(f"{key:8s} ms: min {min(x):.3f} median {st.median(x):.3f} max {max(x):.3f}")
    if a.json:
        json.dump(res, open(a.json, "w"))
