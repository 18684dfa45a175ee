"""How far a wire hangs through in the middle of a span: one rule for every voltage."""

CATENARY_M = 1_500.0  # horizontal pull over weight by length: usual for aluminium-steel ropes on a mild day without wind
MAX_SAG_SHARE = 0.5  # of the lower end's height above ground: very long spans are drawn tighter, or stand on towers nobody has mapped
EARTH_SHARE = 0.85  # an earth wire is drawn tighter than the phases below it


def sag_m(length_m: float, lowest_slot_m: float) -> float:
    """Of a phase, below the straight line between its ends, in the middle.

    lowest_slot_m: above ground, the lower of both ends' lowest slots. A catenary hangs nowhere above the straight line between its ends,
    so a wire is never higher than planners count it.
    """
    return min(length_m**2 / (8.0 * CATENARY_M), MAX_SAG_SHARE * max(lowest_slot_m, 0.0))
