"""Where the arms of a support are and where its wires hang: one rule by voltage, below the height that planners count."""

from dataclasses import dataclass

from inspection.scene.forms import TALL_POLE_V, Form, Layout

USUAL_V = 110_000  # where no voltage is stated
MIN_ARM_SHARE = 0.42  # of the height: arms never come lower
OVERHANG = 1.06  # of an arm over its outermost phase
PIN_M = 0.25  # a small insulator on top of an arm

# Levels from the top; the phases' places across in units of the innermost one's. The window of a delta holds the middle phase.
_LEVELS: dict[Layout, tuple[tuple[float, ...], ...]] = {
    Layout.ONE_LEVEL: ((-1.8, 0.0, 1.8),),
    Layout.DELTA: ((-1.7, 0.0, 1.7),),
    Layout.TRIANGLE: ((1.0,), (-1.25, 1.25)),
    Layout.ALTERNATING: ((1.0,), (-1.0,), (1.0,)),
    Layout.FLAG: ((1.0,), (1.0,), (1.0,)),
    Layout.TWO_LEVEL: ((-1.0, 1.0), (-1.0, 1.0)),
    Layout.DANUBE: ((-1.15, 1.15), (-1.9, -1.0, 1.0, 1.9)),
    Layout.DANUBE_INVERSE: ((-1.9, -1.0, 1.0, 1.9), (-1.15, 1.15)),
    Layout.THREE_LEVEL: ((-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0)),
    Layout.BARREL: ((-1.0, 1.0), (-1.4, 1.4), (-1.15, 1.15)),
}
_NEXT_PHASE = 0.85  # from one phase to the next one outside it


@dataclass(frozen=True)
class Arms:
    """Metres above the ground and across, to the right positive.

    arms: (height, left end, right end); slots: (across, height) of phases, insulators counted; earth: the same of earth wires, at the top.
    """

    arms: tuple[tuple[float, float, float], ...]
    slots: tuple[tuple[float, float], ...]
    earth: tuple[tuple[float, float], ...]


def spacing_m(voltage_v: int | None) -> tuple[float, float, float]:
    """Between levels, from the axis to the innermost phase, and an insulator's length: what is usual for a voltage, as straight lines."""
    kilovolts = (voltage_v or USUAL_V) / 1000.0
    return 1.0 + 0.02 * kilovolts, 0.8 + 0.0165 * kilovolts, 0.3 + 0.0095 * kilovolts


def has_earth_wire(form: Form, voltage_v: int | None) -> bool:
    return form not in {Form.WOODEN, Form.PORTAL} and (voltage_v or USUAL_V) >= TALL_POLE_V


def arms_of(form: Form, layout: Layout, height_m: float, voltage_v: int | None, phases: int, fastened: bool) -> Arms:
    """For at least so many phases; nothing is higher than height_m."""
    level_m, across_m, insulator_m = spacing_m(voltage_v)
    levels = _with_room(_LEVELS[layout], phases)
    has_earth = has_earth_wire(form, voltage_v)
    below_top_m = max(0.8 * level_m, 2.0) if has_earth else 0.0 if form == Form.PORTAL else PIN_M
    squeeze = min(1.0, (1.0 - MIN_ARM_SHARE) * height_m / (below_top_m + level_m * (len(levels) - 1) + insulator_m))
    level_m, below_top_m, insulator_m = level_m * squeeze, below_top_m * squeeze, insulator_m * squeeze
    is_pin = form == Form.WOODEN
    arms, slots = [], []
    for number, places in enumerate(levels):
        own_m = height_m - below_top_m - number * level_m
        left, right = min(0.0, *places), max(0.0, *places)
        arms.append((own_m, left * across_m * OVERHANG, right * across_m * OVERHANG))
        hangs_m = min(own_m + PIN_M, height_m) if is_pin else own_m if fastened else own_m - insulator_m
        slots += [(place * across_m, hangs_m) for place in places]
    if not has_earth:
        earth: tuple[tuple[float, float], ...] = ()
    elif layout in {Layout.DELTA, Layout.ONE_LEVEL}:
        earth = ((-across_m, height_m), (across_m, height_m))
    else:
        earth = ((0.0, height_m),)
    return Arms(tuple(arms), tuple(slots), earth)


def _with_room(levels: tuple[tuple[float, ...], ...], phases: int) -> tuple[tuple[float, ...], ...]:
    """More places further out, the same on both sides, until there is one for each phase."""
    while sum(map(len, levels)) < phases:
        levels = tuple(tuple(sorted((*places, -_outside(places), _outside(places)))) if abs(places[0]) > 0 else places for places in levels)
    return levels


def _outside(places: tuple[float, ...]) -> float:
    return max(map(abs, places)) + _NEXT_PHASE
