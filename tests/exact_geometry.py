"""Whether a segment meets a polygon, in exact rational arithmetic: the judge that shares no code with what it judges."""

from collections.abc import Iterator, Sequence
from fractions import Fraction

Point = tuple[float, float]
Exact = tuple[Fraction, Fraction]


def segment_meets_polygon(start: Point, end: Point, rings: Sequence[Sequence[Point]]) -> bool:
    """True when the closed segment shares a point with the closed polygon.

    rings[0] is the outer ring, the others are holes; each may repeat its first point at the end or not. Touching the border counts,
    also the border of a hole; lying wholly inside a hole does not. A segment of length 0 is a point.
    """
    a, b = _exact(start), _exact(end)
    sides = [side for ring in rings for side in _sides(ring)]
    if any(_segments_meet(a, b, c, d) for c, d in sides):
        return True
    return _is_inside(a, sides)  # no border is met: the whole segment is on one side of it


def _exact(point: Point) -> Exact:
    return Fraction(point[0]), Fraction(point[1])


def _sides(ring: Sequence[Point]) -> Iterator[tuple[Exact, Exact]]:
    points = [_exact(point) for point in ring]
    for index, point in enumerate(points):
        yield points[index - 1], point


def _turn(a: Exact, b: Exact, c: Exact) -> int:
    """1 when a, b, c turn left, -1 right, 0 when they lie on one line."""
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (area > 0) - (area < 0)


def _is_between(a: Exact, b: Exact, point: Exact) -> bool:
    """For a point on the line through a and b: whether it is on the segment."""
    return min(a[0], b[0]) <= point[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= point[1] <= max(a[1], b[1])


def _segments_meet(a: Exact, b: Exact, c: Exact, d: Exact) -> bool:
    if max(a[0], b[0]) < min(c[0], d[0]) or max(c[0], d[0]) < min(a[0], b[0]):
        return False
    if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
        return False
    c_side, d_side, a_side, b_side = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if c_side * d_side < 0 and a_side * b_side < 0:
        return True
    return (
        (c_side == 0 and _is_between(a, b, c))
        or (d_side == 0 and _is_between(a, b, d))
        or (a_side == 0 and _is_between(c, d, a))
        or (b_side == 0 and _is_between(c, d, b))
    )


def _is_inside(point: Exact, sides: Sequence[tuple[Exact, Exact]]) -> bool:
    """Even-odd rule for a point that is on no side; holes turn the parity back."""
    inside = False
    for (x0, y0), (x1, y1) in sides:
        if (y0 > point[1]) != (y1 > point[1]) and x0 + (point[1] - y0) * (x1 - x0) / (y1 - y0) > point[0]:
            inside = not inside
    return inside
