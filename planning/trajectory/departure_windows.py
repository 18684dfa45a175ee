"""When a mission may depart: for legs flown so long after departure, and zones that apply at times, the departures that meet one."""

import math
from collections.abc import Iterable

from inspection.zones.activity import Span, merged

LegTime = tuple[float, float]  # from when to when a leg is flown, in seconds after departure, its end included


def blocked_departures(
    legs: Iterable[LegTime], spans: Iterable[tuple[float, float]], margin_s: float, from_s: float, to_s: float
) -> tuple[Span, ...]:
    """Departures between two moments at which a leg would be flown while a zone applies, or within the margin of that.

    A leg that is flown from a to b after departure meets a span from s to e, its end not included, if it departs from s - b up to but
    without e - a; the margin makes that longer on both sides. Rounded outwards to whole seconds.
    """
    times = set(legs)
    return merged(
        Span(max(float(math.floor(start - margin_s - last_s)), from_s), min(float(math.ceil(end + margin_s - first_s)), to_s))
        for start, end in spans
        for first_s, last_s in times
    )


def free_between(blocked: Iterable[Span], from_s: float, to_s: float) -> tuple[Span, ...]:
    """What spans leave over of the time between two moments."""
    free: list[Span] = []
    open_s = from_s
    for span in merged(blocked):
        if span.from_s > open_s:
            free.append(Span(open_s, min(span.from_s, to_s)))
        open_s = max(open_s, span.to_s)
    if open_s < to_s:
        free.append(Span(open_s, to_s))
    return tuple(free)
