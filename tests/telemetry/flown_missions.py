"""Missions that a UAV flies, as rows alone."""

from typing import Any

from django.contrib.gis.geos import LineString

from missions.models import Mission, MissionUav, Route, Uav


def flies_route(mission: Mission, uav: Uav, sequence: int = 0, **facts: Any) -> Route:
    """A UAV's place in a mission, with a route there."""
    at = {"start": uav.location, "cruise_speed_mps": 12.0}
    place = MissionUav.objects.create(mission=mission, uav=uav, sequence=sequence, name=uav.name, **{**at, **facts})
    line = LineString((10.0, 56.0), (10.01, 56.0), srid=4326)
    return Route.objects.create(mission=mission, mission_uav=place, geometry=line, length_m=620.0, duration_s=60.0, graph_version=1)
