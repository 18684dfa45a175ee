"""How high what nobody has measured is likely to be: what is drawn of it, below the height that planners count for safety."""

from inspection.scene.forms import TALL_POLE_V

USUAL_POLE_V, USUAL_PORTAL_V = 20_000, 110_000  # where no voltage is stated
# Straight lines through what is common, in metres by kilovolts: wood at 11 to 33 kV, wood and steel up to 220 kV; gantries of substations.
_POLE_M, _POLE_M_BY_KV, _TALLEST_POLE_M = 8.0, 0.12, 34.0
_PORTAL_M, _PORTAL_M_BY_KV = 6.0, 0.045


def likely_height_m(kind: str, voltage_v: int | None, *, is_of_minor_lines: bool, counted_m: float) -> float:
    """Of a support without a stated height: tower, pole, portal or vertex. Never more than counted_m.

    Where a line bends and no support is mapped stands what is common for it: a pole below 60 kV, and where all its lines are minor ones.
    """
    is_pole = kind == "pole" or (kind == "vertex" and (voltage_v < TALL_POLE_V if voltage_v else is_of_minor_lines))
    if is_pole:
        return min(_POLE_M + _POLE_M_BY_KV * (voltage_v or USUAL_POLE_V) / 1000.0, _TALLEST_POLE_M, counted_m)
    if kind == "portal":
        return min(_PORTAL_M + _PORTAL_M_BY_KV * (voltage_v or USUAL_PORTAL_V) / 1000.0, counted_m)
    return counted_m
