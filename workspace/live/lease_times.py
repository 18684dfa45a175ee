"""How long whoever holds something by a lease may act on it by its own clock, without asking."""

SURE_SHARE = 0.8  # of a lease: clocks do not run quite alike, and what is on its way still arrives


def held_until_s(asked_s: float, lease_s: float) -> float:
    """Until when what was asked for at a time, and granted, is surely nobody else's; monotonic seconds."""
    return asked_s + SURE_SHARE * lease_s
