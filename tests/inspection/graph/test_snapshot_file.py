"""A graph survives the way to bytes and files and back, and a broken cache is noticed."""

import json
from dataclasses import fields, replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from shapely import box

from inspection.graph import snapshot_file
from inspection.graph.flyable import flyable_part
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.legs import Attachment
from inspection.graph.route_index import asset_places, build_route_index, node_tree, route_index
from inspection.graph.snapshot_file import MANIFEST, CorruptSnapshot, from_bytes, read_cache, to_bytes, write_cache
from inspection.graph.ways import travel_between
from tests.inspection.graph.drawn_graphs import drawn_graph

GRAPH = drawn_graph(
    [(9.0, 47.0), (9.1, 47.0), (9.2, 47.1)], [(0, 1, 7_600.0), (1, 2, 13_500.0)], zones=[box(8, 46, 8.1, 46.1), box(8, 45, 8.1, 45.1)]
)


def hash_of(content: bytes) -> str:
    return sha256(content).hexdigest()


def is_equal(one: InspectionGraph, other: InspectionGraph) -> bool:
    for field in fields(InspectionGraph):
        left, right = getattr(one, field.name), getattr(other, field.name)
        if isinstance(left, np.ndarray):
            if left.dtype != right.dtype or left.shape != right.shape or left.tobytes() != right.tobytes():
                return False
        elif left != right:
            return False
    return True


@pytest.mark.parametrize("graph", [GRAPH, drawn_graph([], [])], ids=["small", "empty"])
def test_bytes_give_the_graph_back(graph):
    content = to_bytes(graph)
    assert is_equal(from_bytes(content, content_sha256=hash_of(content), version=1, ground_revision=1), graph)
    assert to_bytes(graph) == content


@pytest.mark.parametrize("graph", [GRAPH, drawn_graph([], [])], ids=["small", "empty"])
def test_files_give_the_graph_back_read_only(graph, tmp_path: Path):
    content = to_bytes(graph)
    write_cache(tmp_path, content, content_sha256=hash_of(content), version=1)
    cached = read_cache(tmp_path, content_sha256=hash_of(content), version=1, ground_revision=1)
    assert is_equal(cached, graph)
    with pytest.raises(ValueError, match="read-only"):
        cached.length_m[:1] = 0.0
    assert [path.name for path in tmp_path.iterdir()] == ["1"]


def test_bytes_that_are_not_what_was_stored_are_refused():
    content = to_bytes(GRAPH)
    with pytest.raises(CorruptSnapshot):
        from_bytes(content[:-1], content_sha256=hash_of(content), version=1, ground_revision=1)


def spoil_one_byte(place: Path) -> None:
    content = bytearray((place / "length_m.npy").read_bytes())
    content[-1] ^= 1
    (place / "length_m.npy").write_bytes(bytes(content))


def cut_off(place: Path) -> None:
    path = place / "edge.npy"
    path.write_bytes(path.read_bytes()[:-4])


def remove_a_file(place: Path) -> None:
    (place / "cost.npy").unlink()


def spoil_the_manifest(place: Path) -> None:
    (place / "manifest.json").write_text('{"files": 3}')


@pytest.mark.parametrize("spoil", [spoil_one_byte, cut_off, remove_a_file, spoil_the_manifest])
def test_a_broken_cache_is_not_read_and_can_be_written_anew(spoil, tmp_path: Path):
    content = to_bytes(GRAPH)
    write_cache(tmp_path, content, content_sha256=hash_of(content), version=1)
    spoil(tmp_path / "1")
    assert read_cache(tmp_path, content_sha256=hash_of(content), version=1, ground_revision=1) is None
    write_cache(tmp_path, content, content_sha256=hash_of(content), version=1)
    assert is_equal(read_cache(tmp_path, content_sha256=hash_of(content), version=1, ground_revision=1), GRAPH)


def test_a_cache_of_another_snapshot_of_that_version_is_not_read(tmp_path: Path):
    """As after the database was made anew and its versions began at 1 again."""
    content = to_bytes(GRAPH)
    write_cache(tmp_path, content, content_sha256=hash_of(content), version=1)
    assert read_cache(tmp_path, content_sha256=hash_of(b"other"), version=1, ground_revision=1) is None


def test_folders_of_old_versions_are_removed(tmp_path: Path):
    content = to_bytes(GRAPH)
    for version in (1, 2, 9, 10, 11, 12):
        write_cache(tmp_path, content, content_sha256=hash_of(content), version=version)
    assert sorted(int(path.name) for path in tmp_path.iterdir()) == [9, 10, 11, 12]


def test_an_older_version_that_is_written_after_a_restore_stays(tmp_path: Path):
    content = to_bytes(GRAPH)
    for version in (101, 102, 103, 104, 7):
        write_cache(tmp_path, content, content_sha256=hash_of(content), version=version)
    assert read_cache(tmp_path, content_sha256=hash_of(content), version=7, ground_revision=1) is not None


def test_files_that_are_exchanged_while_they_are_read_are_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    content, other = to_bytes(GRAPH), to_bytes(replace(GRAPH, position=GRAPH.position + 0.5))
    write_cache(tmp_path, content, content_sha256=hash_of(content), version=1)
    is_exchanged = False

    def exchange(path: Path) -> np.ndarray:
        nonlocal is_exchanged
        if not is_exchanged:
            is_exchanged = True
            write_cache(tmp_path, other, content_sha256=hash_of(other), version=1)
        return np.load(path, mmap_mode="r")

    monkeypatch.setattr(snapshot_file, "_mapped", exchange)
    assert read_cache(tmp_path, content_sha256=hash_of(content), version=1, ground_revision=1) is None


def read_again(folder: Path, graph: InspectionGraph, tallest_m: float) -> InspectionGraph | None:
    content = to_bytes(graph)
    write_cache(folder, content, content_sha256=hash_of(content), version=1, tallest_m=tallest_m)
    return read_cache(folder, content_sha256=hash_of(content), version=1, ground_revision=1, tallest_m=tallest_m)


def test_the_index_is_stored_with_the_graph_and_mapped(tmp_path: Path):
    cached = read_again(tmp_path, GRAPH, 100.0)
    made = build_route_index(GRAPH)
    for stored, expected in ((route_index(cached).condensed, made.condensed), (route_index(cached).labels, made.labels)):
        for field in fields(stored):
            array = getattr(stored, field.name)
            assert array.tobytes() == getattr(expected, field.name).tobytes()
            assert isinstance(array.base, np.memmap)
            assert not array.flags.writeable
    assert travel_between(cached, [[Attachment(0, 0.0, 0.0)]], [[Attachment(2, 0.0, 0.0)]]).length_m.tolist() == [[21_100.0]]
    assert node_tree(cached).nearest((9.09, 47.0), 1).tolist() == [1]
    assert asset_places(cached).node_of(102) == 2


def test_the_part_that_can_be_flown_over_is_stored_with_its_own_index(tmp_path: Path):
    """The tower in the middle is too tall: nothing leads past it."""
    graph = replace(GRAPH, node_height_m=np.array([40.0, 130.0, np.nan]))
    cached = read_again(tmp_path, graph, 105.0)
    assert is_equal(cached, graph)
    flyable = flyable_part(cached, 105.0)
    assert is_equal(flyable, flyable_part(graph, 105.0))
    assert isinstance(flyable.position.base, np.memmap)
    assert isinstance(route_index(flyable).labels.label_cost.base, np.memmap)
    assert np.isinf(travel_between(flyable, [[Attachment(0, 0.0, 0.0)]], [[Attachment(1, 0.0, 0.0)]]).cost).all()
    assert (asset_places(cached).node_of(101), asset_places(flyable).node_of(101)) == (1, None)


def test_files_without_an_index_or_for_another_height_are_written_anew(tmp_path: Path):
    """As they were laid out before there was an index."""
    cached = read_again(tmp_path, GRAPH, 100.0)
    content = to_bytes(cached)
    assert read_cache(tmp_path, content_sha256=hash_of(content), version=1, ground_revision=1, tallest_m=90.0) is None
    manifest = json.loads((tmp_path / "1" / MANIFEST).read_text())
    del manifest["layout"]
    (tmp_path / "1" / MANIFEST).write_text(json.dumps(manifest))
    assert read_cache(tmp_path, content_sha256=hash_of(content), version=1, ground_revision=1, tallest_m=100.0) is None
    assert is_equal(read_again(tmp_path, GRAPH, 100.0), GRAPH)
