"""Registry for the fact whether a UAV flies, which later apps know."""

from django.utils.module_loading import import_string

from missions.models import Uav

_tellers: list[str] = []


def register_flight_teller(name: str) -> None:
    """Register a function by its dotted name. It takes a UAV and returns whether it is in the air. It is imported on first use."""
    if name not in _tellers:
        _tellers.append(name)


def is_in_flight(uav: Uav) -> bool:
    """Whether any app reports the UAV in the air."""
    return any(import_string(name)(uav) for name in _tellers)
