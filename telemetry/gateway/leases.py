"""How long a gateway may act on a lease by its own clock, without asking."""

SURE_SHARE = 0.8  # of a lease: the database counts from later than we asked, and clocks do not run quite alike


def held_until_s(asked_s: float, lease_s: float) -> float:
    """Until when what was asked for at a time, and granted, is surely nobody else's; monotonic seconds."""
    return asked_s + SURE_SHARE * lease_s
