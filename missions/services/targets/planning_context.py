"""A request on one set of zones: its targets as places and visits, and the ways between all of them. Nobody flies yet."""

from collections.abc import Sequence
from dataclasses import dataclass

from inspection.geodesy import LonLat
from missions.services.planning.requests import BaseRequest, PlanRequest
from missions.services.targets.places import Place
from missions.services.targets.refusals import Scene
from planning.connection_points import Ways
from planning.problem import Visit


@dataclass(frozen=True, eq=False)
class LaidOut:
    """agl_m: the height above ground at which each place is inspected; visits are of the places, by their numbers, with their courses."""

    request: PlanRequest
    scene: Scene
    places: Sequence[Place]
    agl_m: Sequence[float]
    visits: Sequence[Visit]
    courses: Sequence[tuple[LonLat, ...]]
    ways: Ways
    bases: Sequence[BaseRequest]
