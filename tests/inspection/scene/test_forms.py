"""Forms, arms and sag of supports, from their tags and voltage."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.scene.bridges import LAYER_M, deck_amsl_m, deck_of, layer_of
from inspection.scene.forms import Form, Layout, form_of, is_anchor, layout_of
from inspection.scene.overhead import CATENARY_M, sag_m
from inspection.scene.supports import LineFacts, arms_of, has_earth_wire, likely_height_m, phases_of

HEIGHTS_M = st.floats(3.0, 380.0)
VOLTAGES_V = st.one_of(st.none(), st.integers(400, 1_200_000))


@pytest.mark.parametrize(
    ("kind", "tags", "voltage_v", "form"),
    [
        ("tower", {}, 138_000, Form.LATTICE),
        ("tower", {"structure": "tubular"}, 138_000, Form.TUBULAR),
        ("tower", {"structure": "guyed_lattice"}, 400_000, Form.GUYED),
        ("tower", {"design": "h-frame"}, 138_000, Form.H_FRAME),
        ("tower", {"design": "guyed_h-frame", "structure": "lattice"}, 380_000, Form.H_FRAME),
        ("pole", {}, None, Form.WOODEN),
        ("pole", {}, 20_000, Form.WOODEN),
        ("pole", {}, 138_000, Form.TUBULAR),
        ("pole", {"material": "wood"}, 138_000, Form.WOODEN),
        ("pole", {"material": "concrete"}, 20_000, Form.TUBULAR),
        ("portal", {}, 110_000, Form.PORTAL),
        ("vertex", {}, 110_000, Form.STAKE),
    ],
)
def test_a_support_is_built_as_its_tags_say_else_as_is_common(kind: str, tags: dict[str, str], voltage_v: int | None, form: Form) -> None:
    assert form_of(kind, tags, voltage_v) == form


@pytest.mark.parametrize(
    ("tags", "phases", "voltage_v", "layout"),
    [
        ({}, 3, 138_000, Layout.TRIANGLE),
        ({}, 3, 400_000, Layout.DELTA),
        ({}, 6, 138_000, Layout.BARREL),
        ({"design": "donau"}, 6, 220_000, Layout.DANUBE),
        ({"design": "one-level"}, 6, 110_000, Layout.ONE_LEVEL),
        ({"design": "no such word"}, 6, 110_000, Layout.BARREL),
    ],
)
def test_phases_hang_as_the_design_says_else_as_their_number_needs(
    tags: dict[str, str], phases: int, voltage_v: int, layout: Layout
) -> None:
    assert layout_of(Form.LATTICE, tags, phases, voltage_v) == layout


def test_wires_are_fastened_where_a_line_ends_branches_or_turns_unless_it_is_tagged() -> None:
    assert [is_anchor({}, ways, bend) for ways, bend in ((2, 3.0), (2, 25.0), (1, 0.0), (3, 0.0))] == [False, True, True, True]
    assert is_anchor({"line_attachment": "suspension"}, 2, 40.0) is False
    assert is_anchor({"tower:type": "anchor"}, 2, 0.0) is True


@given(st.sampled_from(Form), st.sampled_from(Layout), HEIGHTS_M, VOLTAGES_V, st.integers(1, 12), st.booleans())
def test_nothing_is_above_the_height_that_planners_count_and_nothing_in_the_ground(
    form: Form, layout: Layout, height_m: float, voltage_v: int | None, phases: int, fastened: bool
) -> None:
    arms = arms_of(form, layout, height_m, voltage_v, phases, fastened)
    assert len(arms.slots) >= phases
    heights = [arm[0] for arm in arms.arms] + [slot[1] for slot in (*arms.slots, *arms.earth)]
    assert max(heights) <= height_m
    assert min(heights) >= 0.3 * height_m
    assert len(set(arms.slots)) == len(arms.slots)
    assert all(height == height_m for _, height in arms.earth)
    assert bool(arms.earth) == has_earth_wire(form, voltage_v)
    for across_m, hangs_m in arms.slots:
        assert any(left <= across_m <= right and arm_m >= hangs_m - 0.3 for arm_m, left, right in arms.arms)


@pytest.mark.parametrize(
    ("tags", "circuits", "phases"),
    [
        ({}, None, 3),
        ({}, 2, 6),
        ({"cables": "6"}, None, 6),
        ({"cables": "3;6"}, 2, 6),
        ({"frequency": "16.7"}, 2, 4),
        ({"cables": "99"}, 1, 12),
    ],
)
def test_a_line_has_as_many_wires_as_its_cables_or_circuits_say(tags: dict[str, str], circuits: int | None, phases: int) -> None:
    assert phases_of(LineFacts(110_000, circuits, tags)) == phases


def test_a_wire_sags_with_the_square_of_its_length_and_never_to_the_ground() -> None:
    assert sag_m(300.0, 30.0) == pytest.approx(300.0**2 / (8 * CATENARY_M))  # 7.5 m
    assert sag_m(600.0, 100.0) == pytest.approx(4 * sag_m(300.0, 100.0))
    assert sag_m(11_000.0, 30.0) == 15.0


def test_a_deck_keeps_a_layers_room_and_is_no_lower_than_its_ends() -> None:

    assert deck_amsl_m(np.array([10.0, 10.0]), 1) == 10.0 + LAYER_M
    assert deck_amsl_m(np.array([40.0, 2.0, 41.0]), 1) == 41.0
    assert deck_of(np.array([10.0, 12.0]), 20.0, [{}]) == (31.0, "tag")
    assert deck_of(np.array([10.0, 10.0]), 80.0, [{"layer": "2"}, {"bridge:structure": "Cable_Stayed"}]) == (10.0 + 2 * LAYER_M, "layer")
    assert [layer_of({"layer": text}) for text in ("2", "-1", "", "x", "99")] == [2, 1, 1, 1, 5]


@pytest.mark.parametrize(
    ("kind", "voltage_v", "is_of_minor_lines", "height_m"),
    [
        ("pole", 400, True, 8.048), ("pole", 20_000, False, 10.4), ("pole", None, True, 10.4), ("pole", 138_000, False, 24.56),
        ("pole", 400_000, False, 34.0), ("portal", 110_000, False, 10.95), ("portal", None, False, 10.95), ("tower", 20_000, False, 45.0),
        ("vertex", 33_000, False, 11.96), ("vertex", 110_000, False, 45.0), ("vertex", None, True, 10.4), ("vertex", None, False, 45.0),
    ],
)  # fmt: skip
def test_poles_and_portals_without_a_height_are_likely_lower_than_planners_count(
    kind: str, voltage_v: int | None, is_of_minor_lines: bool, height_m: float
) -> None:
    likely_m = likely_height_m(kind, voltage_v, is_of_minor_lines=is_of_minor_lines, counted_m=45.0)
    assert likely_m == pytest.approx(height_m)
