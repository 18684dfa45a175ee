"""Quillmoor's file has what real extracts have: each property is counted in the file, apart from the code that draws it."""

from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import osmium
import pytest
import shapely

from inspection.demo_region import make_quillmoor, make_region, write_osm_file
from inspection.demo_region.place import METRES_PER_DEG_LAT, METRES_PER_DEG_LON
from inspection.geodesy import distance_m

SUPPORTS = {"tower", "pole", "portal"}
Position = tuple[float, float]


@dataclass
class Content(osmium.SimpleHandler):
    """Everything in the file: positions and tags by node, node references and tags by way."""

    position: dict[int, Position] = field(default_factory=dict)
    tags: dict[int, dict[str, str]] = field(default_factory=dict)
    ways: list[tuple[list[int], dict[str, str]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()

    def node(self, node: Any) -> None:
        self.position[node.id] = (node.location.lon, node.location.lat)
        self.tags[node.id] = dict(node.tags)

    def way(self, way: Any) -> None:
        self.ways.append(([node.ref for node in way.nodes], dict(way.tags)))

    def lines(self, *kinds: str) -> list[tuple[list[int], dict[str, str]]]:
        """Return the ways of these kinds, busbars and lines out of use left out."""
        wanted = kinds or ("line", "minor_line")
        return [(refs, tags) for refs, tags in self.ways if tags.get("power") in wanted and tags.keys().isdisjoint({"line", "disused"})]

    def is_support(self, node: int) -> bool:
        return self.tags.get(node, {}).get("power") in SUPPORTS

    def metres(self, refs: list[int]) -> list[Position]:
        """Return the positions of the way's nodes that are in the file, in metres in a plane."""
        here = [self.position[node] for node in refs if node in self.position]
        return [(lon * METRES_PER_DEG_LON, lat * METRES_PER_DEG_LAT) for lon, lat in here]


@pytest.fixture(scope="module")
def quillmoor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("quillmoor") / "quillmoor.osm.pbf"
    write_osm_file(path, make_quillmoor())
    return path


@pytest.fixture(scope="module")
def content(quillmoor: Path) -> Content:
    found = Content()
    found.apply_file(str(quillmoor))
    return found


def test_a_sixth_to_a_third_of_the_line_vertices_are_not_tagged_and_some_are_in_runs(content: Content) -> None:
    vertices = {node for refs, _ in content.lines() for node in refs if node in content.position}
    assert 0.16 <= sum(not content.is_support(node) for node in vertices) / len(vertices) <= 0.34
    longest = max(
        len(run)
        for refs, _ in content.lines("line")
        for run in "".join("s" if content.is_support(node) else "-" for node in refs if node in content.position).split("s")
    )
    assert longest >= 4


def test_one_line_has_no_tagged_tower(content: Content) -> None:
    without = [tags["name"] for refs, tags in content.lines("line") if not any(content.is_support(node) for node in refs)]
    assert without.count("Line 13") == 1


def test_three_lines_share_one_row_of_towers_and_then_part(content: Content) -> None:
    by_ref = {tags["ref"]: refs for refs, tags in content.lines("line") if tags["ref"] in {"8", "9", "10"}}
    shared = set.intersection(*map(set, by_ref.values()))
    assert len(shared) >= 15
    assert sum(content.is_support(node) for node in shared) >= 12
    assert all(len(set(refs) - shared) >= 10 for refs in by_ref.values())


def test_two_rows_of_towers_run_beside_each_other(content: Content) -> None:
    one, other = (shapely.LineString(content.metres(refs)) for refs, tags in content.lines("line") if tags["ref"] == "7" and len(refs) > 60)
    assert one.length > 15_000
    assert 40.0 < one.hausdorff_distance(other) < 60.0


def test_the_yard_has_30_tracks_from_ladder_to_ladder(content: Content) -> None:
    tracks = [refs for refs, tags in content.ways if tags.get("service") == "yard" and "railway:track_ref" in tags]
    ladders = [refs for refs, tags in content.ways if tags.get("service") == "yard" and "railway:track_ref" not in tags]
    assert (len(tracks), len(ladders)) == (30, 2)
    for ends, ladder in zip(zip(*((refs[0], refs[-1]) for refs in tracks), strict=True), ladders, strict=True):
        assert list(ends) == ladder[1:]
    main = {node for refs, tags in content.ways if tags.get("usage") == "main" for node in refs}
    assert all(ladder[0] in main for ladder in ladders)
    middles = sorted(np.mean(content.metres(refs), axis=0)[1] for refs in tracks)
    assert np.diff(middles) == pytest.approx(np.full(29, 4.6), abs=0.1)


def test_outlines_carry_several_ways_and_one_carries_none(content: Content) -> None:
    outlines = [
        (tags["name"], shapely.Polygon(content.metres(refs)))
        for refs, tags in content.ways
        if tags.get("man_made") == "bridge" and set(refs) <= content.position.keys()
    ]
    decks = [shapely.LineString(content.metres(refs)) for refs, tags in content.ways if "bridge" in tags]
    on = sorted((name, sum(outline.covers(deck) for deck in decks)) for name, outline in outlines)
    assert on == [("Harbour Bridge", 6), ("Mill Bridge", 1), ("Mill Bridge", 2), ("Mill Bridge", 3), ("Old Quay", 0), ("Yard Bridge", 3)]
    assert all(outline.is_valid for _, outline in outlines)
    lone = [deck for deck in decks if not any(outline.intersects(deck) for _, outline in outlines)]
    assert len(lone) == 35


def test_no_support_states_its_height(content: Content) -> None:
    assert sum(map(content.is_support, content.tags)) > 400
    assert not any("height" in tags for tags in content.tags.values())


def test_names_repeat_on_lines_towers_railways_bridges_and_substations(content: Content) -> None:
    line_names = Counter(tags.get("name") for _, tags in content.lines("line"))
    assert line_names["Line 7"] == 5
    tower_refs = Counter(tags["ref"] for tags in content.tags.values() if "ref" in tags)
    assert tower_refs["5"] >= 5
    names = Counter(tags.get("name") for _, tags in content.ways)
    assert names["Mill Bridge"] == 4
    assert names["Quillmoor Line"] > 20
    things = [tags for _, tags in content.ways] + list(content.tags.values())
    kinds = sorted(tags["power"] for tags in things if tags.get("name") == "Quillmoor")
    assert kinds == ["sub_station", "substation", "substation"]


def test_lines_end_inside_a_substation_and_on_its_fence_without_a_support(content: Content) -> None:
    fences = [
        (refs, shapely.Polygon(content.metres(refs))) for refs, tags in content.ways if tags.get("power") in {"substation", "sub_station"}
    ]
    inside, on_fence = set(), set()
    for refs, tags in content.lines("line"):
        for end in (refs[0], refs[-1]):
            if end not in content.position or content.is_support(end):
                continue
            for corners, fence in fences:
                if end in corners:
                    on_fence.add(tags["ref"])
                elif fence.contains(shapely.Point(content.metres([end])[0])):
                    inside.add(tags["ref"])
    assert (inside, on_fence) == ({"7", "12"}, {"8", "9", "10", "11"})


def test_a_line_has_a_span_whose_towers_are_not_mapped(content: Content) -> None:
    (refs,) = [refs for refs, tags in content.lines("line") if tags["ref"] == "12"]
    pairs = [pair for pair in pairwise(refs) if content.position.keys() >= set(pair)]
    ends = np.array([[content.position[node] for node in pair] for pair in pairs])
    spans = distance_m(ends[:, 0], ends[:, 1])
    assert max(spans) == pytest.approx(2_400.0, rel=0.005)
    assert np.median(spans) == pytest.approx(260.0, abs=20.0)


def test_clipped_ways_refer_to_nodes_that_are_not_in_the_file(content: Content) -> None:
    """At one end, at both, in the middle, on a closed outline; and one way has a single node left."""
    present = [("".join("+" if node in content.position else "-" for node in refs), tags) for refs, tags in content.ways]
    clipped = [(pattern, tags) for pattern, tags in present if "-" in pattern]
    assert len(clipped) == 29
    assert sum(pattern.count("-") for pattern, _ in clipped) >= 100
    assert all("+" in pattern for pattern, _ in present)
    kinds = {key for _, tags in clipped for key in ("power", "railway", "highway", "waterway", "man_made", "bridge") if key in tags}
    assert kinds == {"power", "railway", "highway", "waterway", "man_made", "bridge"}
    assert any(pattern.strip("+") and pattern[0] == pattern[-1] == "+" for pattern, tags in clipped if tags.get("ref") == "12")
    assert sum(pattern[0] == pattern[-1] == "-" for pattern, _ in clipped) >= 2
    assert [tags["ref"] for pattern, tags in clipped if pattern.count("+") == 1] == ["16"]


def test_every_position_is_in_the_box_of_the_header(content: Content, quillmoor: Path) -> None:
    with osmium.io.Reader(str(quillmoor)) as reader:
        box = reader.header().box()
        assert reader.header().get("generator") == "Spanwise synthetic demo region"
    positions = np.array(list(content.position.values()))
    assert (positions.min(axis=0) >= (box.bottom_left.lon, box.bottom_left.lat)).all()
    assert (positions.max(axis=0) <= (box.top_right.lon, box.top_right.lat)).all()
    west, east = (np.array([node.position for node in make_region().osm.nodes])[:, 0].min(), box.top_right.lon)
    assert east < west - 0.2, "20 km and more from Elme Valley"


def test_no_id_is_also_one_of_elme_valley(content: Content) -> None:
    elme_valley = make_region().osm
    assert content.position.keys().isdisjoint(node.id for node in elme_valley.nodes)
    assert max(content.position) < 2**53
    assert min(way.id for way in make_quillmoor().ways) > max(way.id for way in elme_valley.ways)


def test_the_same_seed_writes_the_same_file_and_another_seed_another(quillmoor: Path, tmp_path: Path) -> None:
    paths = [tmp_path / f"{number}.osm.pbf" for number in range(2)]
    write_osm_file(paths[0], make_quillmoor())
    write_osm_file(paths[1], make_quillmoor(seed=1))
    assert paths[0].read_bytes() == quillmoor.read_bytes()
    assert paths[1].read_bytes() != quillmoor.read_bytes()
