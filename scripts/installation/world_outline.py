"""Convert Natural Earth's coasts and borders from the TopoJSON of the npm package world-atlas to lines for the map's ground.

Coasts are the arcs of one country, borders those of two. Lines are simplified to a size that pages can load with every map.
"""

import json
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

TOLERANCE_DEG = 0.02  # about 2 km: a third of a pixel at zoom 6
UNITS_PER_DEG = 100
SOUTH_OF_MAP_DEG = -85.06

Point = tuple[float, float]


def write_outline(source: Path, target: Path) -> None:
    """Write the outline of a TopoJSON file of countries: lines as [x, y, step x, step y, ...] in hundredths of a degree, by kind."""
    topology = json.loads(source.read_text())
    uses = Counter(arc for country in topology["objects"]["countries"]["geometries"] for arc in _arcs(country.get("arcs", [])))
    lines: dict[str, list[list[int]]] = {"coasts": [], "borders": []}
    for number, arc in enumerate(topology["arcs"]):
        for part in _parts(_positions(arc, topology["transform"])) if uses[number] else []:
            line = _steps(simplified(part, TOLERANCE_DEG))
            if len(line) > 2:
                lines["borders" if uses[number] > 1 else "coasts"].append(line)
    target.write_text(json.dumps(lines, separators=(",", ":")))


def _arcs(nested: Any) -> Iterator[int]:
    """Yield the numbers of arcs; a reversed one is stored as its complement."""
    if isinstance(nested, int):
        yield nested if nested >= 0 else ~nested
    else:
        for part in nested:
            yield from _arcs(part)


def _positions(arc: list[list[int]], transform: dict[str, list[float]]) -> list[Point]:
    """Return the positions of a delta-encoded arc [deg]."""
    (scale_x, scale_y), (first_x, first_y) = transform["scale"], transform["translate"]
    x = y = 0
    found = []
    for step_x, step_y in arc:
        x, y = x + step_x, y + step_y
        found.append((x * scale_x + first_x, y * scale_y + first_y))
    return found


def _parts(line: list[Point]) -> Iterator[list[Point]]:
    """Yield the line cut where it crosses the 180th meridian, and at the points south of the map: the edge of Antarctica at the pole."""
    cuts = [
        index
        for index in range(1, len(line))
        if abs(line[index][0] - line[index - 1][0]) > 180.0 or min(line[index][1], line[index - 1][1]) < SOUTH_OF_MAP_DEG
    ]
    for first, last in pairwise([0, *cuts, len(line)]):
        yield line[first:last]


def simplified(line: list[Point], tolerance: float) -> list[Point]:
    """Return the line without the points that are nearer to it than the tolerance (Douglas-Peucker)."""
    kept = {0, len(line) - 1}
    parts = [(0, len(line) - 1)]
    while parts:
        first, last = parts.pop()
        distances = [_distance(line[index], line[first], line[last]) for index in range(first + 1, last)]
        if distances and max(distances) > tolerance:
            farthest = first + 1 + distances.index(max(distances))
            kept.add(farthest)
            parts += [(first, farthest), (farthest, last)]
    return [line[index] for index in sorted(kept)]


def _distance(point: Point, start: Point, end: Point) -> float:
    """Return the distance of a point from a segment, in the plane of degrees."""
    (x, y), (east, north) = (point[0] - start[0], point[1] - start[1]), (end[0] - start[0], end[1] - start[1])
    length2 = east * east + north * north
    share = min(1.0, max(0.0, (x * east + y * north) / length2)) if length2 else 0.0
    return float(((x - share * east) ** 2 + (y - share * north) ** 2) ** 0.5)


def _steps(line: list[Point]) -> list[int]:
    """Return the first position and the steps from each to the next, in hundredths of a degree; without empty steps."""
    found: list[int] = []
    x = y = 0
    for longitude, latitude in line:
        next_x, next_y = round(longitude * UNITS_PER_DEG), round(latitude * UNITS_PER_DEG)
        if not found or (next_x, next_y) != (x, y):
            found += [next_x - x, next_y - y]
            x, y = next_x, next_y
    return found
