"""How long a gateway may act on a lease by its own clock, without asking."""

from telemetry.services.links import UNHEARD_S

SURE_SHARE = 0.8  # of a lease: clocks do not run quite alike, and what is on its way still arrives


def held_until_s(asked_s: float, lease_s: float) -> float:
    """Until when what was asked for at a time, and granted, is surely nobody else's; monotonic seconds."""
    return asked_s + SURE_SHARE * lease_s


def served_until_s(asked_s: float, lease_s: float) -> float:
    """The same for a vehicle, which another gateway may also take once nobody has stored for a while that it was heard."""
    return held_until_s(asked_s, min(lease_s, UNHEARD_S))
