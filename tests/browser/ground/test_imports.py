"""A curator brings data in: sends files, also over a bad connection, sees what they would change, and decides."""

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, Route, expect

from inspection.demo_region import write_osm_file
from inspection.demo_region.osm_file import OsmDrawing
from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, look_at, place_of, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser

FIRST_MS = 180_000  # on a site that has just started, data workers have the ground's gaps and graph to look at first
PART = 1024 * 1024
SIDE_DEG = 0.02
TOWERS = 90_000
SETS = ("Works", "Long works", "Phone works")
TAKE_AWAY = """async (path) => { const api = await import("/static/js/api.js"); await api.remove(path); }"""
EDIT = """async (path) => {
    const api = await import("/static/js/api.js");
    const { etag } = await api.get(path);
    await api.patch(path, { reason: "Checked on site" }, { headers: { "If-Match": etag } });
}"""
WHERE_IT_OPENS = region.at(0, 0.01)
NORTH, SOUTH, EAST = ("North", *region.at(0, 0.03)), ("South", *region.at(0, -0.02)), ("East", *region.at(0.07, 0))
NORTH_MOVED, WEST = ("North", *region.at(0, 0.035)), ("West", *region.at(-0.06, -0.01))


def square(west: float, south: float) -> dict[str, Any]:
    east, north = west + SIDE_DEG, south + SIDE_DEG
    return {"type": "Polygon", "coordinates": [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}


def zone_file(*zones: tuple[str, float, float], padding: str = "") -> bytes:
    features = [
        {"type": "Feature", "id": name, "properties": {"name": name, "note": padding}, "geometry": square(west, south)}
        for name, west, south in zones
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def written(folder: Path, name: str, content: bytes) -> Path:
    path = folder / name
    path.write_bytes(content)
    return path


def many_towers(path: Path) -> Path:
    """Three parts of OpenStreetMap data, whose reading takes a while."""
    drawing = OsmDrawing()
    generator = np.random.default_rng(1)
    for place in generator.uniform(-10_000.0, 10_000.0, (TOWERS, 2)):
        drawing.add_node(place, {"power": "tower", "ref": generator.bytes(16).hex()})
    write_osm_file(path, drawing)
    return path


@pytest.fixture
def curator(visitor: Visitor) -> Iterator[Page]:
    """Cora on the page; the sets that a test brings in are off the ground afterwards."""
    page = visitor.signs_in("cora")
    opens_imports(page)
    yield page
    for zone_set in asks(page, "/zone-sets?limit=1000")["results"]:
        if zone_set["name"] in SETS:
            page.evaluate(TAKE_AWAY, f"/zone-sets/{zone_set['id']}")


def opens_imports(page: Page) -> None:
    page.goto("/imports")
    wait_for_map(page)


def sends(page: Page, path: Path, *, set_name: str) -> None:
    page.locator("#choose-file").set_input_files(path)
    expect(page.get_by_label("What it is")).to_have_value("zones")
    page.get_by_label("Name of the set").fill(set_name)
    page.get_by_role("button", name="Read the file").click()


def sentence(page: Page) -> Any:
    return page.locator("#import-sentence")


def test_what_a_file_would_change_is_seen_on_list_and_map_before_it_counts_and_can_be_rolled_back(
    curator: Page, tmp_path: Path, picture: Callable[[Page, str], None]
) -> None:
    page = curator
    first = written(tmp_path, "works.geojson", zone_file(NORTH, SOUTH, EAST))
    sends(page, first, set_name="Works")
    expect(sentence(page)).to_have_text("3\u00a0new.", timeout=FIRST_MS)
    assert not [found for found in asks(page, "/zone-sets")["results"] if found["name"] == "Works" and found["zone_count"]]
    page.get_by_role("button", name="Apply 3 changes").click()
    expect(page.locator("#proposal .chip")).to_have_text("Applied")
    expect(page.get_by_text("Applied by cora")).to_be_visible()

    page.get_by_role("link", name="All imports").click()
    second = written(tmp_path, "works.geojson", zone_file(NORTH_MOVED, WEST, EAST))
    sends(page, second, set_name="Works")
    expect(sentence(page)).to_have_text("1\u00a0new, 1\u00a0changed, 1\u00a0removed from source.")
    expect(page.get_by_text("1 is as it was.")).to_be_visible()
    expect(page.get_by_role("list", name="Changes").get_by_role("listitem")).to_have_count(3)
    page.locator("#map[data-idle]").wait_for(state="attached")
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        picture(page, f"imports-difference-{theme}")
    page.emulate_media(color_scheme="light")
    place = place_of(page, [degrees + SIDE_DEG / 4 for degrees in WEST[1:]])
    page.mouse.move(place["x"], place["y"])
    expect(page.locator("#changes li", has_text="West")).to_have_attribute("data-lit", "true")
    page.mouse.move(0, 0)
    page.get_by_role("button", name="Zones, changed: 1").click()
    expect(page.get_by_role("list", name="Changes").get_by_role("listitem")).to_have_count(1)
    page.get_by_role("button", name="North").click()
    expect(page.get_by_text("dashed on the map")).to_be_visible()
    page.get_by_role("button", name="Apply 3 changes").click()
    expect(page.locator("#proposal .chip")).to_have_text("Applied")

    page.get_by_text("Roll the set back").click()
    page.get_by_role("listitem").filter(has_text="Version 1").get_by_role("button", name="Roll back").click()
    expect(page.locator("#proposal .chip")).to_have_text("Ready for review")
    expect(sentence(page)).to_have_text("1\u00a0new, 1\u00a0changed, 1\u00a0removed from source.")
    page.get_by_role("button", name="Discard").click()
    expect(page.get_by_text("is discarded. Nothing of it counts.")).to_be_visible()
    expect(page.get_by_role("list", name="Import history").get_by_role("listitem").first).to_contain_text("Discarded")


def test_a_cut_connection_goes_on_where_it_was_also_after_a_reload(visitor: Visitor, curator: Page, tmp_path: Path) -> None:
    page = curator
    path = written(tmp_path, "long.geojson", zone_file(("Long", *region.at(0, 0.03)), padding="x" * (3 * PART)))
    sent: list[int] = []
    page.on("request", lambda request: request.method == "PUT" and sent.append(int(request.url.rsplit("/", 1)[1])))
    asked: list[str] = []

    def cut(route: Route) -> None:
        route.abort()

    page.route(f"**/bytes/{PART}", cut)
    sends(page, path, set_name="Long works")
    expect(page.get_by_text("The connection was cut.")).to_be_visible()
    page.on("dialog", lambda dialog: (asked.append(dialog.type), dialog.accept()))
    page.reload()
    wait_for_map(page)
    assert asked == ["beforeunload"]
    expect(page.get_by_text(re.compile(r"33.% is there already"))).to_be_visible()
    page.unroute(f"**/bytes/{PART}", cut)
    page.locator("#choose-file").set_input_files(path)
    expect(sentence(page)).to_have_text("1\u00a0new.")
    assert sent.count(0) == 1
    assert sent[-1] == 3 * PART
    visitor.complaints[:] = [complaint for complaint in visitor.complaints if "net::ERR_FAILED" not in complaint]  # the cut one
    page.get_by_role("button", name="Discard").click()


@pytest.mark.long
def test_a_connection_that_comes_back_is_used_without_a_word_from_anybody(visitor: Visitor, curator: Page, tmp_path: Path) -> None:
    page = curator
    path = written(tmp_path, "again.geojson", zone_file(("Again", *region.at(0, 0.03)), padding="x" * PART))
    cuts, lost = iter([True]), iter([True])
    page.route(f"**/bytes/{PART}", lambda route: route.abort() if next(cuts, False) else route.continue_())

    def lose_answer(route: Route) -> None:
        if route.request.method == "POST" and next(lost, False):
            assert route.fetch().status == 202
            route.abort()
        else:
            route.continue_()

    page.route("**/api/v1/imports", lose_answer)
    sends(page, path, set_name="Long works")
    expect(sentence(page)).to_have_text("1\u00a0new.")
    assert [found["file_name"] for found in asks(page, "/imports?state=ready")["results"]].count("again.geojson") == 1
    visitor.complaints[:] = [complaint for complaint in visitor.complaints if "net::ERR_FAILED" not in complaint]
    page.get_by_role("button", name="Discard").click()


def test_a_file_with_a_fault_is_refused_and_the_place_is_one_click_away(curator: Page, tmp_path: Path) -> None:
    page = curator
    west, south = WHERE_IT_OPENS
    ring = [[west, south], [west + 0.02, south + 0.02], [west + 0.02, south], [west, south + 0.02], [west, south]]
    sends(page, written(tmp_path, "bowtie.json", json.dumps({"type": "Polygon", "coordinates": [ring]}).encode()), set_name="Works")
    alert = page.get_by_role("alert")
    expect(alert).to_contain_text("self-intersection")
    expect(alert).to_contain_text("Nothing was imported.")
    page.get_by_role("button", name="Fit everything").click()
    page.get_by_role("button", name="See the place").click()
    page.locator("#map[data-idle]").wait_for(state="attached")
    frame = page.locator("#map").bounding_box()
    assert frame
    place = place_of(page, [west + 0.01, south + 0.01])
    assert abs(place["x"] - frame["x"] - frame["width"] / 2) < 5
    assert abs(place["y"] - frame["y"] - frame["height"] / 2) < 5
    page.get_by_role("button", name="Discard").click()


@pytest.mark.long
def test_somebody_slower_hears_who_decided(curator: Page, visitor: Visitor, tmp_path: Path) -> None:
    sends(curator, written(tmp_path, "works.geojson", zone_file(NORTH)), set_name="Works")
    expect(curator.get_by_role("button", name="Apply 1 change")).to_be_visible()
    other = visitor.signs_in("cora", curator.url.split("#")[0])
    other.get_by_role("button", name="Discard").click()
    expect(other.get_by_text("is discarded.")).to_be_visible()
    curator.get_by_role("button", name="Apply 1 change").click()
    expect(curator.get_by_role("alert")).to_contain_text("cora")
    expect(curator.locator("#proposal .chip")).to_have_text("Discarded")
    visitor.complaints[:] = [complaint for complaint in visitor.complaints if "409" not in complaint]


@pytest.mark.long
def test_the_keyboard_is_enough_to_decide(curator: Page, tmp_path: Path) -> None:
    page = curator
    page.locator("#choose-file").set_input_files(written(tmp_path, "works.geojson", zone_file(NORTH, EAST)))
    expect(page.get_by_label("What it is")).to_be_focused()
    page.get_by_label("Name of the set").press("Enter")
    expect(sentence(page)).to_have_text("2\u00a0new.")
    page.get_by_role("button", name="North").focus()
    page.keyboard.press("ArrowDown")
    expect(page.get_by_role("button", name="East")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="East")).to_have_attribute("aria-expanded", "true")
    page.get_by_role("button", name="Discard").press("Enter")
    expect(page.get_by_text("is discarded.")).to_be_visible()


@pytest.mark.long
def test_what_was_edited_by_hand_is_kept_or_overwritten_with_a_word(curator: Page, tmp_path: Path) -> None:
    page = curator
    sends(page, written(tmp_path, "works.geojson", zone_file(NORTH)), set_name="Works")
    page.get_by_role("button", name="Apply 1 change").click()
    expect(page.locator("#proposal .chip")).to_have_text("Applied")
    [zone] = asks(page, "/zones?limit=1000")["features"][-1:]
    assert zone["properties"]["name"] == "North"
    page.evaluate(EDIT, f"/zones/{zone['id']}")
    page.get_by_role("link", name="All imports").click()
    sends(page, written(tmp_path, "works.geojson", zone_file(NORTH_MOVED)), set_name="Works")
    expect(sentence(page)).to_have_text("1\u00a0kept as edited by hand.")
    apply = page.locator("#apply")
    expect(apply).to_be_disabled()
    page.get_by_label("Overwrite what was edited by hand (1)").check()
    apply.click()
    expect(page.get_by_role("button", name="Keep the edits")).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.locator("#proposal .chip")).to_have_text("Ready for review")
    apply.click()
    page.get_by_role("button", name="Overwrite and apply").click()
    expect(page.locator("#proposal .chip")).to_have_text("Applied")
    assert asks(page, f"/zones/{zone['id']}")["properties"]["reason"] == ""


@pytest.mark.long
def test_the_columns_of_a_table_are_explained_before_it_is_compared(
    curator: Page, tmp_path: Path, picture: Callable[[Page, str], None]
) -> None:
    page = curator
    west, south = region.at(-0.05, -0.01)
    rows = "".join(
        f"{number};{'Mast' if number % 7 else 'Zaun'};{west + number * 0.003:.5f};{south + number * 0.0007:.5f};{30 + number % 5}\n"
        for number in range(40)
    )
    page.locator("#choose-file").set_input_files(written(tmp_path, "masts.csv", f"Nr;art;x;y;Hoehe\n{rows}".encode()))
    expect(page.get_by_label("What it is")).to_have_value("assets")
    page.get_by_role("button", name="Read the file").click()
    expect(sentence(page)).to_contain_text("Say what the rows are")
    expect(page.locator("#apply")).to_be_disabled()
    expect(page.get_by_label("Mast", exact=True)).to_have_value("tower")
    expect(page.get_by_label("Zaun", exact=True)).to_have_value("")
    page.get_by_label("Hoehe", exact=True).select_option(label="Height in feet")
    page.locator("#map[data-idle]").wait_for(state="attached")
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        picture(page, f"imports-columns-{theme}")
    page.get_by_role("button", name="Show what would change").click()
    expect(sentence(page)).to_have_text("34\u00a0new.")
    page.locator("#changes button").first.click()
    expect(page.locator(".change-facts")).to_contain_text(re.compile(r"height\s*9\.4\d*\u00a0m"))
    page.get_by_role("button", name="Discard").click()


@pytest.mark.long
def test_a_file_on_its_way_says_how_far_it_is_and_what_is_read_can_be_stopped(
    curator: Page, tmp_path: Path, picture: Callable[[Page, str], None]
) -> None:
    page = curator
    held: list[Route] = []
    page.route(f"**/bytes/{2 * PART}", lambda route: held.append(route))
    whole = many_towers(tmp_path / "many.osm.pbf")
    assert whole.stat().st_size > 2 * PART
    page.locator("#choose-file").set_input_files(whole)
    expect(page.get_by_label("What it is")).to_have_value("osm")
    page.get_by_role("button", name="Read the file").click()
    bar = page.get_by_role("progressbar")
    expect(bar).to_have_attribute("aria-valuenow", str(round(2 * PART / whole.stat().st_size * 100)))
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        picture(page, f"imports-progress-{theme}")
    [route] = held
    route.continue_()
    page.get_by_role("button", name="Cancel").click()
    expect(page.locator("#proposal .chip")).to_have_text("Discarded")


@pytest.mark.long
def test_an_area_that_is_too_large_is_not_asked_of_overpass(curator: Page) -> None:
    page = curator
    look_at(page, region.centre, 11)
    button = page.get_by_role("button", name="Download this area from OpenStreetMap")
    expect(button).to_have_attribute("aria-disabled", "false")
    for _ in range(3):
        page.get_by_role("button", name="Zoom out").click()
        page.locator("#map[data-idle]").wait_for(state="attached")
    expect(button).to_have_attribute("aria-disabled", "true")
    expect(page.locator("#area-words")).to_contain_text("Zoom in.")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.method))
    button.click(force=True)
    page.wait_for_timeout(200)
    assert "POST" not in asked


@pytest.mark.long
def test_only_curators_have_the_tools_the_others_a_sentence(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_imports(page)
    expect(page.get_by_text("Only curators bring data in.")).to_be_visible()
    expect(page.locator("#choose-file")).to_have_count(0)


@pytest.mark.long
def test_a_phone_has_it_all_in_the_sheet(visitor: Visitor, curator: Page, tmp_path: Path, picture: Callable[[Page, str], None]) -> None:
    sends(curator, written(tmp_path, "works.geojson", zone_file(NORTH, EAST)), set_name="Phone works")
    expect(sentence(curator)).to_be_visible(timeout=FIRST_MS)
    page = visitor.signs_in("cora", curator.url.split("#")[0], size=(390, 844), touch=True, theme="dark")
    wait_for_map(page)
    expect(sentence(page)).to_have_text("2\u00a0new.")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    expect(page.get_by_role("button", name="Apply 2 changes")).to_be_in_viewport()
    picture(page, "imports-phone-dark")
    curator.get_by_role("button", name="Discard").click()
