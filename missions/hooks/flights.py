"""Whether a UAV flies, which later apps know: missions ask here."""

from django.utils.module_loading import import_string

from missions.models import Uav

_tellers: list[str] = []


def register_flight_teller(name: str) -> None:
    """The dotted name of a function of a UAV that tells whether it is in the air. It is loaded when it is first asked."""
    if name not in _tellers:
        _tellers.append(name)


def is_in_flight(uav: Uav) -> bool:
    """As far as any app knows."""
    return any(import_string(name)(uav) for name in _tellers)
