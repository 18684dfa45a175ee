"""Power towers as solids: body, head, crossarms, strings, clamps, peaks, plate and foundations of each form of support.

x is right of the line's direction, y along it and z up, from the foot. Lattices are closed shells: what a camera could see through one is
not counted.
"""

from dataclasses import dataclass

from inspection.scene.forms import Form
from inspection.scene.supports import Arms, DrawnSupport
from planning.views.solids import Component, Solid, SolidBuilder

STRING_WIDTH_M = 0.28
CLAMP_M = 0.35
PLATE_M, PLATE_AT_M = (0.6, 0.45), 3.0  # number plate: width and height, and height of its middle above ground
FOUNDATION_M, FOUNDATION_HEIGHT_M = 1.0, 0.4
GUY_WIDTH_M, GUY_SPREAD = 0.1, 0.42  # of guys, and how far they stand out for each metre of height
SHORTEST_STRING_M = 0.3


@dataclass(frozen=True)
class BodyShape:
    """Half widths [m] of a square body at its foot, where arms begin, and at its top."""

    foot_m: float
    waist_m: float
    top_m: float


def tower_solid(support: DrawnSupport) -> Solid:
    """The support as it likely is, in the frame of its line."""
    height_m, arms = support.likely_m, support.arms
    builder = SolidBuilder()
    waist_m = min((arm for arm, _, _ in arms.arms), default=0.7 * height_m)
    if support.form in {Form.H_FRAME, Form.PORTAL}:
        _two_legs(builder, support, height_m)
    else:
        shape = body_shape(support.form, height_m)
        _body(
            builder, shape, height_m, waist_m, has_peak=bool(arms.earth), top_arm_m=max((arm for arm, _, _ in arms.arms), default=waist_m)
        )
        _arms(builder, arms, shape, support.form)
        _plate(builder, shape, height_m, waist_m)
        _foundations(builder, shape, support.form)
        if support.form is Form.GUYED:
            _guys(builder, waist_m)
    _strings(builder, support)
    return builder.solid()


def body_shape(form: Form, height_m: float) -> BodyShape:
    """The usual shape of a body. Sources: as drawn in the 3D view; base widths of lattice towers of a sixth to an eighth of the height."""
    if form is Form.LATTICE:
        return BodyShape(height_m / 14.0, max(0.6, height_m / 45.0), max(0.3, height_m / 120.0))
    if form is Form.GUYED:
        return BodyShape(0.25, min(max(height_m * 0.015, 0.4), 0.8), 0.25)
    if form is Form.WOODEN:
        return BodyShape(0.21, 0.16, 0.14)
    if form is Form.STAKE:
        return BodyShape(0.125, 0.125, 0.125)
    foot_m = min(max(height_m * 0.015, 0.3), 1.1)
    return BodyShape(foot_m, foot_m * 0.6, foot_m * 0.34)


def _body(builder: SolidBuilder, shape: BodyShape, height_m: float, waist_m: float, *, has_peak: bool, top_arm_m: float) -> None:
    builder.frustum(builder.part(Component.BODY), 0.0, waist_m, shape.foot_m, shape.waist_m)
    head_m = min(top_arm_m + 0.5, height_m) if has_peak else height_m
    share = (head_m - waist_m) / (height_m - waist_m) if height_m > waist_m else 1.0
    head_half_m = shape.waist_m + share * (shape.top_m - shape.waist_m)
    if head_m > waist_m:
        builder.frustum(builder.part(Component.HEAD), waist_m, head_m, shape.waist_m, head_half_m)
    if height_m - head_m > 0.3:
        builder.frustum(builder.part(Component.EARTH_WIRE_PEAK), head_m, height_m, head_half_m, min(0.15, head_half_m))


def _arms(builder: SolidBuilder, arms: Arms, shape: BodyShape, form: Form) -> None:
    is_lattice = form in {Form.LATTICE, Form.GUYED}
    for arm_m, left_m, right_m in arms.arms:
        for end_m in (left_m, right_m):
            if abs(end_m) <= shape.waist_m:
                continue
            root = min(1.4, 0.2 * abs(end_m) + 0.3) if is_lattice else 0.3
            tip = 0.35 if is_lattice else 0.2
            builder.beam(
                builder.part(Component.CROSSARM),
                (0.5 * shape.waist_m * (1.0 if end_m > 0 else -1.0), 0.0, arm_m),
                (end_m, 0.0, arm_m),
                (2.0 * shape.waist_m * 0.8 if is_lattice else root, root),
                (tip, tip),
            )


def _plate(builder: SolidBuilder, shape: BodyShape, height_m: float, waist_m: float) -> None:
    """On the right face, where it is read from beside the line."""
    at_m = min(PLATE_AT_M, 0.3 * height_m)
    half_m = shape.foot_m + (shape.waist_m - shape.foot_m) * at_m / waist_m
    wide, high = min(PLATE_M[0], 1.6 * half_m), PLATE_M[1]
    builder.box(
        builder.part(Component.PLATE),
        (half_m - 0.02, -wide / 2.0, at_m - high / 2.0),
        (half_m + 0.05, wide / 2.0, at_m + high / 2.0),
    )


def _foundations(builder: SolidBuilder, shape: BodyShape, form: Form) -> None:
    if form in {Form.WOODEN, Form.STAKE}:
        return
    half_m = FOUNDATION_M / 2.0
    corners = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)) if form is Form.LATTICE else ((0.0, 0.0),)
    wide_m = half_m if form is Form.LATTICE else max(half_m, 1.5 * shape.foot_m)
    for x, y in corners:
        at = (x * shape.foot_m, y * shape.foot_m)
        part = builder.part(Component.FOUNDATION)
        builder.box(part, (at[0] - wide_m, at[1] - wide_m, 0.0), (at[0] + wide_m, at[1] + wide_m, FOUNDATION_HEIGHT_M))


def _guys(builder: SolidBuilder, hold_m: float) -> None:
    for x, y in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        out_m = hold_m * GUY_SPREAD
        size = (GUY_WIDTH_M, GUY_WIDTH_M)
        builder.beam(builder.part(Component.GUY), (x * out_m, y * out_m, GUY_WIDTH_M), (x * 0.4, y * 0.4, hold_m), size)


def _two_legs(builder: SolidBuilder, support: DrawnSupport, height_m: float) -> None:
    arms = support.arms
    arm_m, left_m, right_m = arms.arms[0]
    reach_m = max(-left_m, right_m)
    is_portal = support.form is Form.PORTAL
    leg_m = abs(arms.earth[0][0]) if arms.earth else reach_m if is_portal else reach_m * 0.58
    half_m = min(max(height_m * 0.007, 0.18), 0.35)
    top_m = arm_m if is_portal else height_m
    for side in (-1.0, 1.0):
        builder.frustum(builder.part(Component.BODY), 0.0, top_m, half_m, half_m * 0.8, (side * leg_m, 0.0, 0.0))
        part, wide_m = builder.part(Component.FOUNDATION), max(FOUNDATION_M / 2.0, 1.6 * half_m)
        builder.box(part, (side * leg_m - wide_m, -wide_m, 0.0), (side * leg_m + wide_m, wide_m, FOUNDATION_HEIGHT_M))
    beam_m = 2.0 * half_m
    builder.beam(builder.part(Component.CROSSARM), (-reach_m, 0.0, arm_m), (reach_m, 0.0, arm_m), (beam_m, beam_m))
    at_m = min(PLATE_AT_M, 0.3 * height_m)
    builder.box(
        builder.part(Component.PLATE),
        (leg_m + half_m - 0.02, -half_m * 0.8, at_m - PLATE_M[1] / 2.0),
        (leg_m + half_m + 0.05, half_m * 0.8, at_m + PLATE_M[1] / 2.0),
    )


def _strings(builder: SolidBuilder, support: DrawnSupport) -> None:
    """Strings hang from arms; at an anchor they lie along the line on both sides. Pins and fixed wires have a clamp alone."""
    levels_m = [arm for arm, _, _ in support.arms.arms]
    if support.form is Form.STAKE:
        return
    size = (STRING_WIDTH_M, STRING_WIDTH_M)
    for across_m, hangs_m in support.arms.slots:
        above = [arm for arm in levels_m if arm >= hangs_m - 0.3]
        if not above:
            continue
        arm_m = min(above)
        ends = []
        if support.is_anchor:
            length_m = _string_length_m(support)
            for side in (-1.0, 1.0):
                start = (across_m, side * 0.3, hangs_m)
                end = (across_m, side * (0.3 + length_m), hangs_m - 0.15 * length_m)
                builder.beam(builder.part(Component.STRING), start, end, size)
                ends.append(end)
        else:
            if arm_m - hangs_m >= SHORTEST_STRING_M:
                builder.beam(builder.part(Component.STRING), (across_m, 0.0, hangs_m), (across_m, 0.0, arm_m), size)
            ends.append((across_m, 0.0, hangs_m))
        half_m = CLAMP_M / 2.0
        for x, y, z in ends:
            builder.box(builder.part(Component.CLAMP), (x - half_m, y - half_m, z - half_m), (x + half_m, y + half_m, z + half_m))


def _string_length_m(support: DrawnSupport) -> float:
    kilovolts = (support.voltage_v or 110_000) / 1000.0
    return 0.3 + 0.0095 * kilovolts
