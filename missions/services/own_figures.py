"""Figures that are said for one mission alone, when its UAVs are sent again."""

from collections.abc import Sequence
from dataclasses import replace

from missions.services.requests import UavRequest


def as_said_before(uav: UavRequest, before: Sequence[UavRequest]) -> UavRequest:
    """Own figures that are sent again as they were are not said anew: what the stored UAV had when they were said is kept."""
    old = next((other for other in before if other.uav is not None and other.uav == uav.uav), None)
    if old is None or not old.fleet_figures:
        return uav
    values, said = ({**vars(one), **vars(one.performance)} for one in (uav, old))
    kept = {name: value for name, value in old.fleet_figures.items() if name in uav.fleet_figures and values[name] == said[name]}
    return replace(uav, fleet_figures={**uav.fleet_figures, **kept})
