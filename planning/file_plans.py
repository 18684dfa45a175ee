"""Plans on a graph from a file: targets are nodes, UAVs join at their nearest node, and a plan leaves as JSON.

A graph file is an npz with lat, lon float64 (n,) [deg], u, v int32 (m,) node indices and w float64 (m,) metres.
"""

import io
import json
import sys
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, BinaryIO

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.network.nearness import EARTH_RADIUS_M
from inspection.network.paths.contracted_graph import contract_columns
from inspection.network.paths.hub_labels import label
from inspection.network.paths.node_tree import NodeTree, tree_of
from inspection.network.paths.paths import PlaceLegs, travel_of_legs
from inspection.network.route_index import RouteIndex
from planning.problem import FloatArray, IntArray, Objective, Problem, Routes, UavStart, Visit
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.exact import MAX_TARGETS, best_routes
from planning.solver.problem_arrays import Arcs, no_burden
from planning.solver.solver import solve

PHASES = ("nearest", "matrix", "assign", "expand")

Clock = Callable[[], float]  # seconds from any moment on


class InvalidFile(ValueError):
    """The graph or the missions are not in the format."""


@dataclass(frozen=True, eq=False)
class FileGraph:
    """A graph as planners of a file need it: its index, and its nodes by place."""

    index: RouteIndex
    tree: NodeTree
    fragment: NDArray[np.uint64]  # (n, words) the text for each node in a list of nodes

    @property
    def node_count(self) -> int:
        return len(self.fragment)


@dataclass(frozen=True, eq=False)
class FileMission:
    uavs: FloatArray  # (u, 2) lon, lat [deg]
    targets: IntArray  # (t,) nodes


def read_graph(file: BinaryIO) -> FileGraph:
    """The graph of an npz with its index. Raises InvalidFile."""
    # One array after the other, each let go before the next is made: a million nodes take less than 100 MiB.
    try:
        with np.load(file, allow_pickle=False) as stored:
            node_count = len(stored["lat"])
            u, v, w = _column(stored["u"], np.int32), _column(stored["v"], np.int32), _column(stored["w"], np.float64)
            if not len(u) == len(v) == len(w) or not (np.isfinite(w).all() and (w >= 0).all()):
                raise InvalidFile("not a graph: each edge needs two ends and a length of 0 m or more")
            if len(u) and not (min(u.min(), v.min()) >= 0 and max(u.max(), v.max()) < node_count):
                raise InvalidFile("not a graph: an edge leads to a node that is not there")
            contracted = contract_columns(node_count, u, v, w, w)
            del u, v, w
            labels = label(contracted)
            lon, lat = _column(stored["lon"], np.float64), _column(stored["lat"], np.float64)
    except (KeyError, ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise error if isinstance(error, InvalidFile) else InvalidFile(f"not a graph: {error}") from error
    if not len(lon) == len(lat) > 0 or not (np.isfinite(lon).all() and np.isfinite(lat).all()):
        raise InvalidFile("not a graph: it needs nodes, each with a place")
    tree = tree_of(lon, lat)
    del lon, lat
    return FileGraph(RouteIndex(contracted, labels), tree, _fragments(node_count).view(np.uint64))


def _column(values: NDArray[Any], dtype: type[np.generic]) -> NDArray[Any]:
    """Raises InvalidFile for what is no column of numbers."""
    if values.ndim != 1 or values.dtype.kind not in "fiu":
        raise InvalidFile("not a graph: its arrays are columns of numbers")
    return values.astype(dtype, copy=False)


def read_mission(graph: FileGraph, mission: Mapping[str, Any]) -> FileMission:
    """A mission with UAVs at lat, lon and nodes as targets. Raises InvalidFile."""
    try:
        uavs = np.array(mission["uavs"], dtype=np.float64).reshape(-1, 2)[:, ::-1]
        targets = np.array(mission["targets"], dtype=np.int64).reshape(-1)
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidFile(f"not a mission: {error}") from error
    if not np.isfinite(uavs).all() or (len(targets) and not (targets.min() >= 0 and targets.max() < graph.node_count)):
        raise InvalidFile("not a mission: a UAV without a place, or a target that is no node")
    return FileMission(uavs, targets)


def plan_json(graph: FileGraph, mission: Mapping[str, Any], objective: Objective, clock: Clock) -> bytes:
    """One plan as JSON, with the milliseconds of each phase; `ms.total` is from the positions to the finished bytes before it."""
    began = [clock()]
    asked = read_mission(graph, mission)
    uavs, targets = len(asked.uavs), len(asked.targets)
    joined, chord = graph.tree.nearest_of_each(asked.uavs)
    leg_m = np.zeros(uavs + targets)
    leg_m[:uavs] = 2.0 * EARTH_RADIUS_M * np.arcsin(np.minimum(chord / 2.0, 1.0))
    leg_node = np.concatenate([joined, asked.targets]).astype(np.int32)
    began.append(clock())
    places = np.arange(uavs + targets + 1)
    travel = travel_of_legs(graph.index, PlaceLegs(places, leg_node, leg_m, leg_m), places[:-1], places[uavs:-1])
    began.append(clock())
    routes = _routes(travel.length_m, uavs, objective)
    began.append(clock())

    # Of the sources the UAVs come first, then the targets.
    legs = [leg for uav, route in enumerate(routes) for leg in pairwise((uav - uavs, *route))]
    pairs = np.array(legs, dtype=np.int64).reshape(-1, 2)
    pairs[:, 0] += uavs
    nodes, first = travel.paths(pairs)
    counts = np.array([len(route) for route in routes], dtype=np.int64)
    waypoints = _as_json(nodes, first, counts, graph.fragment, BLANK_COMMA, MARKS).tobytes()
    lengths_m = _lengths_m(travel.length_m[pairs[:, 0], pairs[:, 1]].tolist(), counts.tolist())
    content = (
        f'{{"cost_m": {sum(lengths_m)!r}, "makespan_m": {max(lengths_m, default=0.0)!r}, "routes": {json.dumps(routes)}, "waypoints": '
    ).encode() + waypoints
    began.append(clock())
    ms = {phase: round((end - begin) * 1e3, 4) for phase, (begin, end) in zip(PHASES, pairwise(began), strict=True)}
    return content + b', "ms": ' + json.dumps(ms | {"total": round((began[-1] - began[0]) * 1e3, 4)}).encode() + b"}"


def _routes(length_m: FloatArray, uavs: int, objective: Objective) -> Routes:
    """Targets in order for each UAV; proven up to MAX_TARGETS."""
    targets = length_m.shape[1]
    if not uavs or not targets:
        return ((),) * uavs
    if targets <= MAX_TARGETS:
        paths_m = np.minimum(length_m, NO_PATH_M)
        return best_routes(_arcs(paths_m[:uavs], paths_m[uavs:], objective))
    problem = Problem(
        uavs=(UavStart(),) * uavs,
        visits=tuple(Visit(target) for target in range(targets)),
        target_count=targets,
        from_start_m=length_m[:uavs],
        between_m=length_m[uavs:],
        to_start_m=np.zeros((targets, uavs)),
        objective=objective,
    )
    return solve(problem).routes


def _arcs(first_m: FloatArray, onward_m: FloatArray, objective: Objective) -> Arcs:
    uavs, targets = first_m.shape
    return Arcs(first_m=first_m, onward_m=onward_m[None], is_makespan=objective is Objective.MAKESPAN, **_plain(uavs, targets))


@lru_cache(maxsize=64)
def _plain(uavs: int, targets: int) -> dict[str, Any]:
    """The arrays of a problem without limits, in which UAVs end anywhere. They are shared: nobody writes to them."""
    return {
        "end_m": np.zeros((uavs, targets)),
        "target": np.arange(targets, dtype=np.int64),
        "service_s": np.zeros(targets),
        "ready_s": np.zeros(uavs),
        "done": np.ones(targets, dtype=np.int64),
        "limit_m": np.full(uavs, NO_PATH_M / 2),
        "speed_mps": np.ones(uavs),
        "most": np.full(uavs, targets, dtype=np.int64),
        "allowed": np.ones((uavs, targets), dtype=np.bool_),
        "weight": np.ones(targets),
        "class_of": np.zeros(uavs, dtype=np.int64),
        "along_m": np.zeros((1, targets)),
        "owner": np.arange(uavs),
        "turnaround_s": np.zeros(uavs),
        "again_m": np.zeros(uavs),
        "burden": no_burden(uavs, targets),
        "has_sorties": False,
    }


def _lengths_m(leg_m: Sequence[float], counts: Sequence[int]) -> list[float]:
    ends = np.cumsum([0, *counts]).tolist()
    return [sum(leg_m[begin:end]) for begin, end in pairwise(ends)]


WORD = 8  # bytes; JSON may have blanks between its tokens, so that every node takes up as many words as any other


@njit(cache=True, nogil=True)
def _fragments(node_count: int) -> NDArray[np.uint8]:
    """A comma and the node's number, for each node, filled up with blanks to whole words."""
    words = 1 if node_count <= 10_000_000 else 2
    text = np.full((node_count, words * WORD), 32, dtype=np.uint8)
    for node in range(node_count):
        text[node, 0] = 44  # ,
        digits, rest = 1, node
        while rest >= 10:
            rest //= 10
            digits += 1
        rest = node
        for place in range(digits, 0, -1):
            text[node, place] = 48 + rest % 10
            rest //= 10
    return text


@njit(cache=True, nogil=True)
def _as_json(
    nodes: IntArray, first: IntArray, counts: IntArray, fragment: NDArray[np.uint64], blank_comma: np.uint64, marks: NDArray[np.uint64]
) -> NDArray[np.uint64]:
    """The nodes of each route as a list of lists; counts (u,) says how many legs a route has. Where legs meet, the node counts once.

    fragment has a row of words for each node; blank_comma takes the comma from a row's first word; marks are the words for where the
    list begins, where one route ends and the next begins, where the list ends, and for no route at all.
    """
    words = fragment.shape[1]
    text = np.empty(words * len(nodes) + len(counts) + 2, dtype=np.uint64)
    if not len(counts):
        text[0] = marks[3]
        return text[:1]
    text[0] = marks[0]
    size, leg = 1, 0
    for route in range(len(counts)):
        if route:
            text[size] = marks[1]
            size += 1
        begin = size
        for number in range(counts[route]):
            for at in range(first[leg] + (1 if number else 0), first[leg + 1]):
                for word in range(words):
                    text[size + word] = fragment[nodes[at], word]
                size += words
            leg += 1
        if size > begin:
            text[begin] -= blank_comma
    text[size] = marks[2]
    return text[: size + 1]


def _word(text: bytes) -> int:
    return int.from_bytes(text.ljust(WORD), sys.byteorder)


MARKS = np.array([_word(mark) for mark in (b"[[", b"],[", b"]]", b"[]")], dtype=np.uint64)
BLANK_COMMA = np.uint64(_word(b",") - _word(b" "))


def rehearse() -> None:
    """Plan a mission of one UAV and one target on a graph of two nodes: what is compiled is compiled, or loaded, then."""
    file = io.BytesIO()
    np.savez(file, lat=np.array([47.0, 47.1]), lon=np.array([9.0, 9.0]), u=np.array([0]), v=np.array([1]), w=np.array([11_000.0]))
    file.seek(0)
    plan_json(read_graph(file), {"uavs": [[47.0, 9.0]], "targets": [1]}, Objective.TOTAL, float)
