"""Supports and spans with forms, arms and sag, from the tags of supports and lines."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from inspection.scene.forms import TALL_POLE_V, Form, Layout, Tags, form_of, is_anchor, layout_of
from inspection.scene.overhead import Overhead, bearings_deg, sag_m

USUAL_V = 110_000  # default voltage
MIN_ARM_SHARE = 0.42  # of the height: arms are never lower
OVERHANG = 1.06  # of an arm beyond its outermost phase
PIN_M = 0.25  # a small insulator on top of an arm

# Levels from the top; the phases' positions across in units of the innermost one's. The window of a delta holds the middle phase.
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
_NEXT_PHASE = 0.85  # from one phase to the next outer one


@dataclass(frozen=True)
class Arms:
    """Metres above the ground and across, positive to the right.

    arms: (height, left end, right end); slots: (across, height) of phases, insulators included; earth: the same of earth wires, at the top.
    """

    arms: tuple[tuple[float, float, float], ...]
    slots: tuple[tuple[float, float], ...]
    earth: tuple[tuple[float, float], ...]


def spacing_m(voltage_v: int | None) -> tuple[float, float, float]:
    """Return the usual distances for a voltage, linear in it: between levels, from axis to innermost phase, and an insulator's length."""
    kilovolts = (voltage_v or USUAL_V) / 1000.0
    return 1.0 + 0.02 * kilovolts, 0.8 + 0.0165 * kilovolts, 0.3 + 0.0095 * kilovolts


def has_earth_wire(form: Form, voltage_v: int | None) -> bool:
    return form not in {Form.WOODEN, Form.PORTAL} and (voltage_v or USUAL_V) >= TALL_POLE_V


def arms_of(form: Form, layout: Layout, height_m: float, voltage_v: int | None, phases: int, fastened: bool) -> Arms:
    """Return arms for at least this many phases; nothing is higher than height_m."""
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
    """Return levels with outer places added on both sides until there is one for each phase."""
    while sum(map(len, levels)) < phases:
        levels = tuple(tuple(sorted((*places, -_outside(places), _outside(places)))) if abs(places[0]) > 0 else places for places in levels)
    return levels


def _outside(places: tuple[float, ...]) -> float:
    return max(map(abs, places)) + _NEXT_PHASE


USUAL_POLE_V, USUAL_PORTAL_V = 20_000, 110_000  # default voltages
# Linear fits to common heights, in metres by kilovolts: wood at 11 to 33 kV, wood and steel up to 220 kV; gantries of substations.
_POLE_M, _POLE_M_BY_KV, _TALLEST_POLE_M = 8.0, 0.12, 34.0
_PORTAL_M, _PORTAL_M_BY_KV = 6.0, 0.045
MAX_PHASES = 12
PHASES_OF_CIRCUIT = 3
_ONE_PHASE_HZ = {"16.7", "16.67", "16 2/3", "0"}  # railway lines and direct current: two wires per circuit


def likely_height_m(kind: str, voltage_v: int | None, *, is_of_minor_lines: bool, counted_m: float) -> float:
    """Return the height of a support without a stated one: tower, pole, portal or vertex; at most counted_m.

    A bend without a mapped support gets what is common there: a pole below 60 kV, and where all its lines are minor ones.
    """
    is_pole = kind == "pole" or (kind == "vertex" and (voltage_v < TALL_POLE_V if voltage_v else is_of_minor_lines))
    if is_pole:
        return min(_POLE_M + _POLE_M_BY_KV * (voltage_v or USUAL_POLE_V) / 1000.0, _TALLEST_POLE_M, counted_m)
    if kind == "portal":
        return min(_PORTAL_M + _PORTAL_M_BY_KV * (voltage_v or USUAL_PORTAL_V) / 1000.0, counted_m)
    return counted_m


@dataclass(frozen=True)
class LineFacts:
    """Facts of a line from its tags."""

    voltage_v: int | None
    circuits: int | None
    tags: Tags
    is_minor: bool = False


@dataclass(frozen=True)
class SceneSupportFacts:
    """Facts of a support from its tags; kind: tower, pole or portal."""

    kind: str
    voltage_v: int | None
    tags: Tags


@dataclass(frozen=True)
class DrawnSupport:
    kind: str  # "vertex" where no support is mapped
    form: Form
    height_m: float  # as planners count it
    height_source: str  # tag, line, assumed
    likely_m: float  # as drawn: its arms are below that
    voltage_v: int | None
    is_anchor: bool
    bearing_deg: float
    arms: Arms


@dataclass(frozen=True)
class DrawnSpan:
    start: int
    end: int
    lines: tuple[int, ...]
    voltage_v: int | None
    phases: int
    earth: int
    length_m: float
    sag_m: float


VERTEX = SceneSupportFacts("vertex", None, {})
NO_LINE = LineFacts(None, None, {})


def phases_of(line: LineFacts) -> int:
    """Return the number of wires to draw of a line, without earth wires: from its cables or circuits, else one circuit."""
    cables = line.tags.get("cables", "")
    if cables.isascii() and cables.isdigit() and cables.strip("0"):
        return MAX_PHASES if len(cables) > 3 else min(int(cables), MAX_PHASES)
    of_circuit = 2 if line.tags.get("frequency", "") in _ONE_PHASE_HZ else PHASES_OF_CIRCUIT
    return min((line.circuits or 1) * of_circuit, MAX_PHASES)


def drawn(
    found: Overhead, supports: Mapping[int, SceneSupportFacts], lines: Mapping[int, LineFacts]
) -> tuple[list[DrawnSupport], list[DrawnSpan]]:
    """Return supports and spans in the order of `found`. supports and lines by primary key."""
    carried = [[lines.get(line, NO_LINE) for line in own] for own in found.span_lines]
    voltage_v = [max((line.voltage_v for line in own if line.voltage_v), default=None) for own in carried]
    phases = [min(sum(map(phases_of, own)), MAX_PHASES) for own in carried]
    bearing, ways, bend = bearings_deg(found, np.array([(own or 1) * 1.0 for own in voltage_v]))
    most_phases, most_v = _at_ends(found, phases), _at_ends(found, [own or 0 for own in voltage_v])
    has_major = _at_ends(found, [int(not all(line.is_minor for line in own)) for own in carried])
    stands = [
        _support(
            VERTEX if key < 0 else supports.get(key, VERTEX),
            height_m=height_m,
            height_source="tag" if is_tagged else "line" if is_by_line else "assumed",
            line_voltage_v=most_v[place] or None,
            phases=most_phases[place] or PHASES_OF_CIRCUIT,
            ways=int(ways[place]),
            bend_deg=float(bend[place]),
            bearing_deg=float(bearing[place]),
            is_of_minor_lines=not has_major[place],
        )
        for place, (key, height_m, is_tagged, is_by_line) in enumerate(
            zip(found.support.tolist(), found.height_m.tolist(), found.is_tagged.tolist(), found.is_by_line.tolist(), strict=True)
        )
    ]
    hung = [
        _span(stands, start, end, own_lines, own_v, own_phases, length_m)
        for (start, end), own_lines, own_v, own_phases, length_m in zip(
            found.span.tolist(), found.span_lines, voltage_v, phases, found.length_m.tolist(), strict=True
        )
    ]
    return stands, hung


def _at_ends(found: Overhead, of_span: Sequence[int]) -> list[int]:
    """Return the greatest value of the spans at each support, 0 where there is none."""
    greatest = np.zeros(len(found.position), dtype=np.int64)
    for side in (0, 1):
        np.maximum.at(greatest, found.span[:, side], np.array(of_span, dtype=np.int64))
    return [int(value) for value in greatest]


def _support(
    facts: SceneSupportFacts, *, height_m: float, height_source: str, line_voltage_v: int | None, phases: int, ways: int, bend_deg: float,
    bearing_deg: float, is_of_minor_lines: bool,
) -> DrawnSupport:  # fmt: skip
    voltage_v = line_voltage_v or facts.voltage_v
    form = form_of(facts.kind, facts.tags, voltage_v)
    fastened = is_anchor(facts.tags, ways, bend_deg)
    layout = layout_of(form, facts.tags, phases, voltage_v)
    likely_m = height_m
    if height_source == "assumed":
        likely_m = likely_height_m(facts.kind, voltage_v, is_of_minor_lines=is_of_minor_lines, counted_m=height_m)
    return DrawnSupport(
        kind=facts.kind,
        form=form,
        height_m=height_m,
        height_source=height_source,
        likely_m=likely_m,
        voltage_v=voltage_v,
        is_anchor=fastened,
        bearing_deg=bearing_deg,
        arms=arms_of(form, layout, likely_m, voltage_v, phases, fastened),
    )


def _span(
    stands: Sequence[DrawnSupport], start: int, end: int, lines: tuple[int, ...], voltage_v: int | None, phases: int, length_m: float
) -> DrawnSpan:
    ends = stands[start].arms, stands[end].arms
    lowest_m = min(height_m for arms in ends for _, height_m in arms.slots)
    return DrawnSpan(
        start=start,
        end=end,
        lines=lines,
        voltage_v=voltage_v,
        phases=min(phases, *(len(arms.slots) for arms in ends)),
        earth=min(len(arms.earth) for arms in ends),
        length_m=length_m,
        sag_m=sag_m(length_m, lowest_m),
    )
