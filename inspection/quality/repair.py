"""New courses of lines: a moved end, added vertices, positions of missing towers."""

from collections.abc import Callable, Sequence

import numpy as np
from shapely import Point

from inspection.geodesy import distance_m
from inspection.geodesy.wgs84 import FloatArray
from inspection.quality.infrastructure import FoundIssue, IssueSearchData
from inspection.quality.lines import impossible_voltages, line_ends
from inspection.quality.network import SupportNetwork
from inspection.quality.supports import lone_towers, long_spans, missing_supports

Position = tuple[float, float]  # lon, lat [deg]

SAME_DEG = 2e-9  # less than a millimetre: the same vertex in spite of rounding
MERGE_M = 30.0  # a vertex this near to a tower is assumed to be at it


class NoSuchVertex(ValueError):
    """Raised when the line no longer has a vertex there."""


def vertex_at(course: Sequence[Position], place: Sequence[float]) -> int:
    """Return the number of the vertex at the place. Raises NoSuchVertex."""
    away = np.abs(np.asarray(course, dtype=np.float64) - np.asarray(place, dtype=np.float64)).max(axis=1)
    nearest = int(away.argmin())
    if away[nearest] > SAME_DEG:
        raise NoSuchVertex
    return nearest


def leg_between(course: Sequence[Position], start: Sequence[float], end: Sequence[float]) -> int:
    """Return the number of the vertex that begins the leg from start to end. Raises NoSuchVertex."""
    points = np.asarray(course, dtype=np.float64)
    away = np.abs(points[:-1] - np.asarray(start)).max(axis=1) + np.abs(points[1:] - np.asarray(end)).max(axis=1)
    if not len(away) or away.min() > 2 * SAME_DEG:
        raise NoSuchVertex
    return int(away.argmin())


def evenly_between(start: Sequence[float], end: Sequence[float], count: int) -> list[Position]:
    """Return `count` positions that divide the path from start to end evenly."""
    first, last = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    return [_position(first + (last - first) * (number / (count + 1))) for number in range(1, count + 1)]


def in_order(start: Sequence[float], end: Sequence[float], places: Sequence[Sequence[float]]) -> list[Position]:
    """Return the places sorted by their distance along the path from start to end."""
    first, step = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64) - np.asarray(start, dtype=np.float64)
    scale = np.array([np.cos(np.radians(first[1])), 1.0])
    along = [float(((np.asarray(place) - first) * scale * step * scale).sum()) for place in places]
    return [_position(np.asarray(places[index], dtype=np.float64)) for index in np.argsort(along, kind="stable")]


def with_vertices(course: Sequence[Position], after: int, places: Sequence[Position]) -> list[Position]:
    """Return the course with the places inserted after vertex `after`."""
    return [*course[: after + 1], *places, *course[after + 1 :]]


def end_moved_to(course: Sequence[Position], end: int, place: Position, *, keeps_end: bool) -> list[Position]:
    """Return the course with its first or last vertex moved to the place, or extended to it where the vertex must stay."""
    if end == 0:
        return [place, *course] if keeps_end else [place, *course[1:]]
    return [*course, place] if keeps_end else [*course[:-1], place]


def nearest_leg(course: Sequence[Position], place: Position) -> tuple[int, float, float]:
    """Return the leg nearest to the place: its first vertex, the fraction along it (0 to 1), and the distance [m]."""
    points = np.asarray(course, dtype=np.float64)
    scale = np.array([np.cos(np.radians(place[1])), 1.0])
    step = (points[1:] - points[:-1]) * scale
    to_place = (np.asarray(place) - points[:-1]) * scale
    square = np.maximum((step**2).sum(axis=1), 1e-30)
    fraction = np.clip((step * to_place).sum(axis=1) / square, 0.0, 1.0)
    leg = int(np.hypot(*(to_place - step * fraction[:, None]).T).argmin())
    foot = points[leg] + (points[leg + 1] - points[leg]) * fraction[leg]
    return leg, float(fraction[leg]), float(distance_m(foot[None], np.asarray(place, dtype=np.float64)[None])[0])


def through(course: Sequence[Position], place: Position, taken: FloatArray) -> list[Position]:
    """Return the course through the place: its nearest vertex is moved if it is near and at no tower (`taken`), else a vertex is added."""
    points = np.asarray(course, dtype=np.float64)
    metres = distance_m(points, np.broadcast_to(np.asarray(place, dtype=np.float64), points.shape))
    nearest = int(metres.argmin())
    is_taken = bool(len(taken)) and bool((np.abs(taken - points[nearest]).max(axis=1) <= SAME_DEG).any())
    if metres[nearest] <= MERGE_M and not is_taken:
        return [*course[:nearest], place, *course[nearest + 1 :]]
    leg, fraction, _ = nearest_leg(course, place)
    if fraction == 0.0 and leg == 0:
        return [place, *course]
    if fraction == 1.0 and leg == len(course) - 2:
        return [*course, place]
    return with_vertices(course, leg, [place])


def _position(point: FloatArray) -> Position:
    return (round(float(point[0]), 7), round(float(point[1]), 7))


RECIPE = 2  # incremented when the rules change, so that unchanged map data are searched again


def bridges_without_way(ground: IssueSearchData) -> list[FoundIssue]:
    return [
        FoundIssue(
            kind="bridge_without_way",
            key=f"bridge_without_way {bridge.key}",
            asset=bridge.asset,
            position=bridge.position,
            geometry=Point(bridge.position),
        )
        for bridge in ground.bridges_without_way
    ]


def search(ground: IssueSearchData, progress: Callable[[str], None] | None = None) -> list[FoundIssue]:
    """Return every issue of the map data, those that disconnect most first; equal inputs give equal lists with unique keys."""
    notify = progress or (lambda message: None)
    notify("joining lines")
    network = SupportNetwork(ground)
    found: list[FoundIssue] = []
    for words, detector in (
        ("long spans", long_spans), ("vertices without a tower", missing_supports), ("towers on no line", lone_towers),
        ("ends of lines", line_ends),
    ):  # fmt: skip
        notify(words)
        found += detector(network)
    notify("bridges and voltages")
    found += bridges_without_way(ground) + impossible_voltages(ground)
    by_key = {issue.key: issue for issue in reversed(found)}
    return sorted(by_key.values(), key=lambda issue: (-issue.cut_off_m, -issue.details.get("missing_towers", 0), issue.key))
