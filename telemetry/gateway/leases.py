"""How long a gateway may act on a lease by its own clock, without asking."""

from telemetry.services.links import UNHEARD_S
from workspace.lease_times import held_until_s


def served_until_s(asked_s: float, lease_s: float) -> float:
    """The same for a vehicle, which another gateway may also take once nobody has stored for a while that it was heard."""
    return held_until_s(asked_s, min(lease_s, UNHEARD_S))
