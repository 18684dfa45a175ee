"""A network survives the way to bytes and files and back, a cleared graph that to files; and broken files are noticed."""

import json
import math
import os
from dataclasses import fields, replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from shapely import box

from inspection.network import snapshot_file
from inspection.network.build.flyable import flyable_part
from inspection.network.build.network import GRAPH_FIELDS, Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import Attachment
from inspection.network.paths.paths import travel_between
from inspection.network.route_index import asset_places, build_route_index, node_tree, route_index
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.snapshot_file import (
    CLEARED,
    KEPT_NETWORKS,
    MANIFEST,
    MAX_MASKED_FILES,
    NETWORKS,
    CorruptSnapshot,
    from_bytes,
    key_of_masked,
    read_masked,
    read_network,
    to_bytes,
    write_masked,
    write_network,
)
from inspection.network.zones.zone_index import ZoneIndex, zones_of_graph
from tests.inspection.network.drawn_graphs import drawn_graph

GRAPH = drawn_graph(
    [(9.0, 47.0), (9.1, 47.0), (9.2, 47.1)], [(0, 1, 7_600.0), (1, 2, 13_500.0)], zones=[box(8, 46, 8.1, 46.1), box(8, 45, 8.1, 45.1)]
)
EMPTY = drawn_graph([], [])
RULES, HEIGHTS = LinkingRules(), FlownHeights()


def network_of(graph: InspectionGraph) -> Network:
    return Network(**{name: getattr(graph, name) for name in GRAPH_FIELDS})


def hash_of(content: bytes) -> str:
    return sha256(content).hexdigest()


def is_equal(one: object, other: object) -> bool:
    if type(one) is not type(other):
        return False
    for field in fields(one):
        left, right = getattr(one, field.name), getattr(other, field.name)
        if isinstance(left, np.ndarray):
            if left.dtype != right.dtype or left.shape != right.shape or left.tobytes() != right.tobytes():
                return False
        elif left != right:
            return False
    return True


@pytest.mark.parametrize("graph", [GRAPH, EMPTY], ids=["small", "empty"])
def test_bytes_give_the_network_back(graph):
    network = network_of(graph)
    content = to_bytes(network)
    assert is_equal(from_bytes(content, content_sha256=hash_of(content)), network)
    assert to_bytes(network) == content


def test_bytes_that_are_not_what_was_stored_are_refused():
    content = to_bytes(network_of(GRAPH))
    with pytest.raises(CorruptSnapshot):
        from_bytes(content[:-1], content_sha256=hash_of(content))


def test_the_bytes_of_a_cleared_graph_name_its_zones(tmp_path: Path):
    (tmp_path / "graph.npz").write_bytes(to_bytes(GRAPH))
    with np.load(tmp_path / "graph.npz") as arrays:
        assert json.loads(arrays["zone_name"].tobytes()) == ["zone 1", "zone 2"]
        assert arrays["zone_wkb"].tobytes() == b"".join(GRAPH.zone_wkb)


@pytest.mark.parametrize("graph", [GRAPH, EMPTY], ids=["small", "empty"])
def test_files_give_the_network_back_read_only(graph, tmp_path: Path):
    write_network(tmp_path, network_of(graph), content_sha256="abc")
    mapped = read_network(tmp_path, content_sha256="abc")
    assert is_equal(mapped, network_of(graph))
    with pytest.raises(ValueError, match="read-only"):
        mapped.length_m[:1] = 0.0


def store(folder: Path, graph: InspectionGraph, key: str = "key", tallest_m: float = math.inf) -> None:
    write_masked(folder, graph, key=key, tallest_m=tallest_m)


def stored(folder: Path, graph: InspectionGraph, key: str = "key", tallest_m: float = math.inf) -> InspectionGraph | None:
    return read_masked(folder, key=key, zones=zones_of_graph(graph), version=1, ground_revision=1, tallest_m=tallest_m)


@pytest.mark.parametrize("graph", [GRAPH, EMPTY], ids=["small", "empty"])
def test_files_give_the_cleared_graph_back_read_only(graph, tmp_path: Path):
    store(tmp_path, graph)
    cached = stored(tmp_path, graph)
    assert is_equal(cached, graph)
    with pytest.raises(ValueError, match="read-only"):
        cached.length_m[:1] = 0.0
    assert [path.name for path in (tmp_path / CLEARED).iterdir()] == ["key"]


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
def test_broken_files_are_not_read_and_can_be_written_anew(spoil, tmp_path: Path):
    store(tmp_path, GRAPH)
    write_network(tmp_path, network_of(GRAPH), content_sha256="abc")
    spoil(tmp_path / CLEARED / "key")
    spoil(tmp_path / NETWORKS / "abc")
    assert stored(tmp_path, GRAPH) is None
    assert read_network(tmp_path, content_sha256="abc") is None
    store(tmp_path, GRAPH)
    write_network(tmp_path, network_of(GRAPH), content_sha256="abc")
    assert is_equal(stored(tmp_path, GRAPH), GRAPH)
    assert is_equal(read_network(tmp_path, content_sha256="abc"), network_of(GRAPH))


def zones(**bands: object) -> ZoneIndex:
    return ZoneIndex([box(8, 46, 8.1, 46.1), box(8, 45, 8.1, 45.1)], [1, 2], ["a", "b"], **bands)


def test_the_key_tells_apart_whatever_the_clearing_reads():
    """But not the zones' names and ids: a zone that is only renamed costs nothing."""

    def key(content="abc", some=None, rules=RULES, heights=HEIGHTS, tallest_m=105.0) -> str:
        return key_of_masked(content, zones() if some is None else some, rules, heights, tallest_m)

    others = [
        key(content="other"),
        key(some=zones().where([0])),
        key(some=zones(floor_agl_m=[30.0, -np.inf])),
        key(some=zones(ceiling_agl_m=[30.0, np.inf])),
        key(rules=replace(RULES, zone_clearance_m=6.0)),
        key(heights=replace(HEIGHTS, margin_m=1.0)),
        key(tallest_m=90.0),
    ]
    assert len({key(), *others}) == 1 + len(others)
    assert key(some=ZoneIndex(zones().polygons, [7, 8], ["c", "d"])) == key()


def test_the_files_used_last_are_kept(tmp_path: Path):
    for number in range(MAX_MASKED_FILES + 2):
        store(tmp_path, GRAPH, key=f"{number}")
        os.utime(tmp_path / CLEARED / f"{number}", (number, number))
        if number >= MAX_MASKED_FILES:
            assert stored(tmp_path, GRAPH, key="1") is not None  # now the one used last
    assert {path.name for path in (tmp_path / CLEARED).iterdir()} == {"1", *map(str, range(3, MAX_MASKED_FILES + 2))}


def test_few_networks_are_kept_and_no_files_of_earlier_layouts(tmp_path: Path):
    (tmp_path / "17").mkdir()
    (tmp_path / ".draft-abc").mkdir()
    for number in range(KEPT_NETWORKS + 1):
        write_network(tmp_path, network_of(GRAPH), content_sha256=f"{number}")
        os.utime(tmp_path / NETWORKS / f"{number}", (number, number))
    assert {path.name for path in tmp_path.iterdir()} == {NETWORKS}
    assert {path.name for path in (tmp_path / NETWORKS).iterdir()} == set(map(str, range(1, KEPT_NETWORKS + 1)))


def test_files_that_are_exchanged_while_they_are_read_are_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    store(tmp_path, GRAPH)
    is_exchanged = False

    def exchange(path: Path) -> np.ndarray:
        nonlocal is_exchanged
        if not is_exchanged:
            is_exchanged = True
            store(tmp_path, replace(GRAPH, position=GRAPH.position + 0.5))
        return np.load(path, mmap_mode="r")

    monkeypatch.setattr(snapshot_file, "_mapped", exchange)
    assert stored(tmp_path, GRAPH) is None


def read_again(folder: Path, graph: InspectionGraph, tallest_m: float) -> InspectionGraph | None:
    store(folder, graph, tallest_m=tallest_m)
    return stored(folder, graph, tallest_m=tallest_m)


def test_the_index_is_stored_with_the_graph_and_mapped(tmp_path: Path):
    cached = read_again(tmp_path, GRAPH, 100.0)
    made = build_route_index(GRAPH)
    for stored, expected in ((route_index(cached).contracted, made.contracted), (route_index(cached).labels, made.labels)):
        for array, made_array in zip(stored, expected, strict=True):
            assert array.tobytes() == made_array.tobytes()
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


def test_files_of_another_layout_are_written_anew(tmp_path: Path):
    store(tmp_path, GRAPH)
    manifest = json.loads((tmp_path / CLEARED / "key" / MANIFEST).read_text())
    manifest["about"]["layout"] -= 1
    (tmp_path / CLEARED / "key" / MANIFEST).write_text(json.dumps(manifest))
    assert stored(tmp_path, GRAPH) is None
    store(tmp_path, GRAPH)
    assert is_equal(stored(tmp_path, GRAPH), GRAPH)
