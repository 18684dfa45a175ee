"""Form of a support by its tags; untagged ones get what is common for their kind and voltage."""

from collections.abc import Mapping
from enum import StrEnum

TALL_POLE_V = 60_000  # poles of such lines are steel or concrete, and the line has an earth wire
DELTA_V = 300_000  # towers with one circuit of such lines carry it on one level, the middle phase in a window
BEND_DEG = 10.0  # at larger bends the wires are anchored at the support instead of suspended

Tags = Mapping[str, str]


class Form(StrEnum):
    """Construction of the support."""

    LATTICE = "lattice"
    TUBULAR = "tubular"
    WOODEN = "wooden"
    H_FRAME = "h-frame"
    PORTAL = "portal"
    GUYED = "guyed"
    STAKE = "stake"  # a bend of a line without a mapped support


class Layout(StrEnum):
    """Arrangement of the phases."""

    ONE_LEVEL = "one-level"
    DELTA = "delta"
    TRIANGLE = "triangle"
    ALTERNATING = "alternating"
    FLAG = "flag"
    TWO_LEVEL = "two-level"
    DANUBE = "danube"
    DANUBE_INVERSE = "danube-inverse"
    THREE_LEVEL = "three-level"
    BARREL = "barrel"


# https://wiki.openstreetmap.org/wiki/Key:design
_LAYOUT_OF_DESIGN = {
    "one-level": Layout.ONE_LEVEL, "h-frame": Layout.ONE_LEVEL, "guyed_h-frame": Layout.ONE_LEVEL, "portal": Layout.ONE_LEVEL,
    "x-frame": Layout.ONE_LEVEL, "bipole": Layout.ONE_LEVEL, "delta": Layout.DELTA, "y-frame": Layout.DELTA, "guyed_v-frame": Layout.DELTA,
    "triangle": Layout.TRIANGLE, "delta_two-level": Layout.TRIANGLE, "asymmetric": Layout.ALTERNATING, "flag": Layout.FLAG,
    "two-level": Layout.TWO_LEVEL, "donau": Layout.DANUBE, "donau_inverse": Layout.DANUBE_INVERSE, "three-level": Layout.THREE_LEVEL,
    "four-level": Layout.THREE_LEVEL, "six-level": Layout.THREE_LEVEL, "barrel": Layout.BARREL,
}  # fmt: skip
_TWO_LEGGED = {"h-frame", "guyed_h-frame", "portal", "x-frame"}
# https://wiki.openstreetmap.org/wiki/Key:line_attachment, Key:line_management and the older Key:tower:type
_FASTENED = {"anchor", "termination", "terminal", "branch", "transition", "split", "transpose"}
_HUNG = {"suspension", "pin", "pulley"}


def form_of(kind: str, tags: Tags, voltage_v: int | None) -> Form:
    """Return the form. kind: tower, pole, portal or vertex."""
    design, structure = tags.get("design", ""), tags.get("structure", "")
    if kind == "vertex":
        return Form.STAKE
    if kind == "portal" or design == "portal":
        return Form.PORTAL
    if design in _TWO_LEGGED:
        return Form.H_FRAME
    if structure.startswith("guyed") or design.startswith("guyed"):
        return Form.GUYED
    if structure == "lattice":
        return Form.LATTICE
    if structure in {"tubular", "solid"}:
        return Form.TUBULAR if tags.get("material") != "wood" else Form.WOODEN
    if kind == "tower":
        return Form.TUBULAR if tags.get("material") in {"concrete", "wood"} else Form.LATTICE
    is_of_wood = tags.get("material", "wood" if (voltage_v or 0) < TALL_POLE_V else "steel") == "wood"
    return Form.WOODEN if is_of_wood else Form.TUBULAR


def layout_of(form: Form, tags: Tags, phases: int, voltage_v: int | None) -> Layout:
    """Return the layout of the design tag; else one level on two legs, and otherwise what is common for the number of phases."""
    stated = _LAYOUT_OF_DESIGN.get(tags.get("design", ""))
    if stated is not None:
        return stated
    if form in {Form.H_FRAME, Form.PORTAL}:
        return Layout.ONE_LEVEL
    if phases > 3:
        return Layout.BARREL if form == Form.LATTICE else Layout.THREE_LEVEL
    if form in {Form.LATTICE, Form.GUYED} and (voltage_v or 0) >= DELTA_V:
        return Layout.DELTA
    return Layout.ALTERNATING if form == Form.TUBULAR else Layout.TRIANGLE


def is_anchor(tags: Tags, ways: int, bend_deg: float) -> bool:
    """Whether wires end at the support: as tagged, else where a line ends, branches or bends."""
    stated = {tags.get(key, "") for key in ("line_attachment", "line_management", "tower:type")}
    if stated & _FASTENED:
        return True
    if stated & _HUNG:
        return False
    return ways != 2 or bend_deg > BEND_DEG
