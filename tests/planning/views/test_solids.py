"""Solids: closed, with outward faces, inside of the support's heights; patches are all of the surface."""

import numpy as np
import pytest

from planning.views.solids import Component, Solid, SolidBuilder, patches_of
from planning.views.tower_solid import tower_solid
from tests.planning.views.towers import TOWERS

KINDS = {"lattice": {Component.BODY, Component.CROSSARM, Component.CLAMP, Component.PLATE, Component.FOUNDATION}}


def volume_m3(triangles: np.ndarray) -> float:
    return float(np.einsum("ti,ti->t", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])).sum() / 6.0)


@pytest.mark.parametrize("name", sorted(TOWERS))
def test_every_part_of_a_tower_is_a_closed_body_within_its_height(name: str) -> None:
    own = TOWERS[name]
    solid = tower_solid(own)
    low, high = solid.box
    assert low[2] >= 0.0
    assert high[2] <= own.likely_m + 1.0, "a beam at the top is half its thickness higher"
    kinds = {kind for kind, _ in solid.components}
    assert {Component.BODY, Component.PLATE, Component.CROSSARM, Component.CLAMP} <= kinds
    for part in range(len(solid.components)):
        triangles = solid.triangles[solid.component == part]
        assert volume_m3(triangles) > 0.0, solid.components[part]
        edges = {}
        for triangle in triangles.round(9).tolist():
            for start, end in zip(triangle, triangle[1:] + triangle[:1], strict=True):
                edges[(tuple(start), tuple(end))] = edges.get((tuple(start), tuple(end)), 0) + 1
        assert all(edges.get((end, start)) == count for (start, end), count in edges.items()), "each edge has a face on both sides"


def test_an_anchor_has_a_string_on_each_side_of_a_phase() -> None:
    own = TOWERS["lattice, 220 kV, danube, anchor"]
    solid = tower_solid(own)
    strings = [number for kind, number in solid.components if kind is Component.STRING]
    assert len(strings) == 2 * len(own.arms.slots)


@pytest.mark.parametrize("size_m", [0.5, 2.0])
def test_patches_are_all_of_the_surface_and_no_larger_than_asked(size_m: float) -> None:
    solid = tower_solid(TOWERS["lattice, 110 kV, triangle"])
    patches = patches_of(solid, size_m)
    across = np.cross(solid.triangles[:, 1] - solid.triangles[:, 0], solid.triangles[:, 2] - solid.triangles[:, 0])
    assert patches.area_m2.sum() == pytest.approx(np.linalg.norm(across, axis=1).sum() / 2.0)
    sides = np.linalg.norm(np.roll(patches.corners, -1, axis=1) - patches.corners, axis=2)
    assert sides.max() <= 2.0 * size_m
    np.testing.assert_allclose(np.linalg.norm(patches.normal, axis=1), 1.0)


def test_a_turned_solid_looks_along_the_bearing() -> None:
    builder = SolidBuilder()
    builder.box(builder.part(Component.BODY), (2.0, 10.0, 0.0), (3.0, 11.0, 1.0))
    east, north = builder.solid().turned(90.0).triangles[:, :, 0], builder.solid().turned(90.0).triangles[:, :, 1]
    assert (east.min(), east.max()) == pytest.approx((10.0, 11.0)), "along the line, which leads east"
    assert (north.min(), north.max()) == pytest.approx((-3.0, -2.0)), "right of it is south"
    assert isinstance(builder.solid().moved((1.0, 0.0, 0.0)), Solid)
