"""The ways of doing each place: a point has one, a stretch can be flown from either end."""

from collections.abc import Sequence

import numpy as np

from inspection.geodesy import LonLat, path_length_m
from missions.services.targets.places import Place
from planning.problem import Visit


def visits_of_places(places: Sequence[Place], takes_s: Sequence[float] | None = None) -> tuple[list[Visit], list[tuple[LonLat, ...]]]:
    """The visits, with the course of each; takes_s as `target_s` tells, in the order of the places."""
    visits, courses = [], []
    for number, place in enumerate(places):
        service_s = 0.0 if takes_s is None else takes_s[number]
        length_m = path_length_m(np.array(place.course)) if place.is_stretch else 0.0
        visits.append(Visit(number, is_reversed=False, length_m=length_m, service_s=service_s))
        courses.append(place.course)
        if place.is_stretch:
            visits.append(Visit(number, is_reversed=True, length_m=length_m, service_s=service_s))
            courses.append(tuple(reversed(place.course)))
    return visits, courses
