"""The nodes nearest to a position, against looking at all of them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.network.nearness import on_unit_sphere
from inspection.network.paths.node_tree import build_node_tree

degrees = st.floats(-85, 85).map(lambda value: round(value, 2))  # some places coincide
places = st.tuples(st.floats(-180, 180).map(lambda value: round(value, 1)), degrees)


@given(st.lists(places, max_size=120), places, st.integers(1, 30), st.floats(0, 2))
def test_nearest_and_around_find_what_looking_at_all_nodes_finds(nodes, place, count, within):
    position = np.array(nodes, dtype=np.float64).reshape(-1, 2)
    tree = build_node_tree(position)
    here = LonLat(*place)
    chords = np.linalg.norm(on_unit_sphere(position) - on_unit_sphere(np.array([place])), axis=1)
    within_2 = within * within
    nearest = tree.nearest(here, count, within)
    expected = np.sort(chords[chords**2 <= within_2 * (1 + 1e-12)])[:count]
    assert abs(len(nearest) - len(expected)) <= np.sum(np.abs(chords - within) < 1e-9)
    assert np.allclose(chords[nearest], expected[: len(nearest)], atol=1e-9)
    assert len(set(nearest.tolist())) == len(nearest)
    around = set(tree.around(here, within).tolist())
    assert {int(node) for node in np.flatnonzero(chords < within - 1e-9)} <= around
    assert around <= {int(node) for node in np.flatnonzero(chords < within + 1e-9)}


def test_many_nodes_at_one_place_are_all_found():
    tree = build_node_tree(np.full((500, 2), 7.0))
    assert len(tree.nearest(LonLat(7.0, 7.0), 500)) == 500
    assert tree.around(LonLat(7.0, 7.0), 1e-9).tolist() == list(range(500))


def test_a_graph_without_nodes_has_none_near():
    tree = build_node_tree(np.zeros((0, 2)))
    assert tree.nearest(LonLat(7.0, 7.0), 3).tolist() == tree.around(LonLat(7.0, 7.0), 2.0).tolist() == []
