"""Coasts and borders of the world, as set-up makes them of TopoJSON."""

import gzip
import json
from pathlib import Path

from scripts.installation.world_outline import simplified, write_outline

PROJECT_DIR = Path(__file__).resolve().parents[3]


def test_an_arc_of_two_countries_is_a_border_and_one_of_one_country_a_coast(tmp_path: Path) -> None:
    countries = [{"type": "Polygon", "arcs": [[0, 1]]}, {"type": "MultiPolygon", "arcs": [[[-2]]]}, {"type": None}]
    topology = {
        "transform": {"scale": [0.5, 0.5], "translate": [10.0, 50.0]},
        "arcs": [[[0, 0], [2, 0], [0, 2]], [[2, 2], [-2, -2]], [[7, 7], [1, 1]]],
        "objects": {"countries": {"geometries": countries}},
    }
    source, target = tmp_path / "countries.json", tmp_path / "outline.json"
    source.write_text(json.dumps(topology))
    write_outline(source, target)
    assert json.loads(target.read_text()) == {"coasts": [[1000, 5000, 100, 0, 0, 100]], "borders": [[1100, 5100, -100, -100]]}


def test_a_coast_is_cut_at_the_180th_meridian(tmp_path: Path) -> None:
    topology = {
        "transform": {"scale": [1.0, 1.0], "translate": [0.0, 0.0]},
        "arcs": [[[178, 65], [2, 0], [-360, 1], [2, 0]]],
        "objects": {"countries": {"geometries": [{"type": "Polygon", "arcs": [[0]]}]}},
    }
    source, target = tmp_path / "countries.json", tmp_path / "outline.json"
    source.write_text(json.dumps(topology))
    write_outline(source, target)
    assert json.loads(target.read_text())["coasts"] == [[17800, 6500, 200, 0], [-18000, 6600, 200, 0]]


def test_points_near_the_line_are_left_out() -> None:
    assert simplified([(0, 0), (1, 0.001), (2, 0), (2, 3)], 0.01) == [(0, 0), (2, 0), (2, 3)]
    assert simplified([(0, 0), (1, 1), (0, 0)], 0.01) == [(0, 0), (1, 1), (0, 0)]


def test_the_outline_of_the_pages_is_small_enough_to_load_with_every_map() -> None:
    outline = (PROJECT_DIR / "node_modules" / ".spanwise" / "world-atlas" / "outline.json").read_bytes()
    assert len(gzip.compress(outline, 2)) < 150_000  # the reverse proxy's level
    lines = json.loads(outline)
    assert len(lines["coasts"]) > 1_000
    assert len(lines["borders"]) > 300
    assert all(abs(step) < 18_000 for kind in lines.values() for line in kind for step in line[2:])
