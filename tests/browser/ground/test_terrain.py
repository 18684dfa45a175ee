"""The page of terrain: a model that comes in and goes, the height under a click, the profile of points and of a power line."""

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.gdal import GDALRaster
from playwright.sync_api import Page, expect

from tests.browser.conftest import ContextPool, Site, Visitor
from tests.browser.operator_map import asks, look_at, place_of, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser

WEST, NORTH = region.at(-0.2, 0.2)  # of the first post
STEP = 0.001  # between posts
VOID = -32768
NAME = "plane.tif"
WORDS = re.compile(r"([\d,]+)\N{NO-BREAK SPACE}m above sea level")


def plane_m(position: list[float]) -> float:
    """The made ground: a plane that rises to the east."""
    return 200 + 1000 * (position[0] - WEST)


def plane_file(folder: Path) -> Path:
    columns = rows = 501
    heights = np.tile((200 + 1000 * STEP * np.arange(columns)).astype(np.float32), (rows, 1))
    heights[:20, :20] = VOID
    path = folder / NAME
    raster = GDALRaster(
        {
            "driver": "GTiff", "name": str(path), "width": columns, "height": rows, "srid": 4326, "datatype": 6,
            "origin": (WEST - STEP / 2, NORTH + STEP / 2), "scale": (STEP, -STEP), "skew": (0, 0),
            "bands": [{"data": heights, "nodata_value": VOID}],
        }
    )  # fmt: skip
    del raster  # writes the file
    return path


def sends(page: Page, path: str, data: dict[str, Any] | bytes, method: str = "POST") -> Any:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    headers = {"X-CSRFToken": token} | ({"Content-Type": "application/octet-stream"} if isinstance(data, bytes) else {})
    answer = page.request.fetch(f"/api/v1{path}", method=method, data=data, headers=headers)
    assert answer.ok, f"{path}: {answer.status} {answer.text()}"
    return answer.json() if answer.text() else None


def waits_for(page: Page, proposal: str, state: str) -> Any:
    for _ in range(120):
        found = asks(page, f"/imports/{proposal}")
        if found["state"] == state:
            return found
        assert found["state"] in {"reading", "ready", "applying"}, found
        time.sleep(0.25)
    raise AssertionError(f"the proposal did not become {state}")


def brings_in(page: Page, file: Path) -> None:
    content = file.read_bytes()
    upload = sends(page, "/uploads", {"file_name": file.name, "size_bytes": len(content)})
    for first in range(0, len(content), upload["part_bytes"]):
        sends(page, f"/uploads/{upload['id']}/bytes/{first}", content[first : first + upload["part_bytes"]], "PUT")
    body = {"kind": "terrain", "upload": upload["id"], "parameters": {"vertical_datum": "EGM2008"}, "provenance": {"licence": "CC0-1.0"}}
    proposal = sends(page, "/imports", body)["id"]
    waits_for(page, proposal, "ready")
    sends(page, f"/imports/{proposal}/apply", {})
    waits_for(page, proposal, "applied")


def takes_all_away(page: Page) -> None:
    for feature in asks(page, "/terrain")["features"]:
        sends(page, f"/terrain/{feature['id']}", {}, "DELETE")


@pytest.fixture(scope="module", autouse=True)
def no_model_stays(site: Site, contexts: ContextPool) -> Iterator[None]:
    yield
    last = Visitor(site, contexts)
    takes_all_away(last.signs_in("cora"))
    last.leaves()


@pytest.fixture
def model(visitor: Visitor, tmp_path: Path) -> None:
    """A terrain model over the region; the next tests find it."""
    page = visitor.signs_in("cora")
    if not asks(page, "/terrain")["features"]:
        brings_in(page, plane_file(tmp_path))
    page.close()


@pytest.fixture
def no_model(visitor: Visitor) -> None:
    page = visitor.signs_in("cora")
    takes_all_away(page)
    page.close()


def opens_terrain(visitor: Visitor, name: str, *, size: tuple[int, int] = (1440, 900), theme: str = "light") -> Page:
    page = visitor.signs_in(name, size=size, theme=theme, touch=size[0] < 721)
    page.goto("/terrain")
    wait_for_map(page)
    return page


def shown_m(page: Page) -> float:
    heading = page.locator("#terrain-panel h2", has_text="above sea level")
    expect(heading).to_be_visible()
    found = WORDS.search(heading.inner_text())
    assert found
    return float(found[1].replace(",", ""))


def a_line_of(page: Page) -> tuple[dict[str, Any], list[float]]:
    """A power line that has its towers, and the middle of one of its spans."""
    for feature in asks(page, f"/assets?kind=line&bbox={region.everything}&limit=100")["features"]:
        places = asks(page, f"/assets/{feature['id']}")["geometry"]["coordinates"]
        lons, lats = zip(*places, strict=True)
        around = f"{min(lons) - 0.0001},{min(lats) - 0.0001},{max(lons) + 0.0001},{max(lats) + 0.0001}"
        towers = asks(page, f"/assets?kind=tower&bbox={around}&limit=500")["features"]
        standing = {tuple(tower["geometry"]["coordinates"]) for tower in towers}
        if feature["properties"]["is_flyable"] and sum(tuple(place) in standing for place in places) > 10:
            return feature, [(places[4][axis] + places[5][axis]) / 2 for axis in (0, 1)]
    raise AssertionError("no line")


@pytest.mark.long
def test_without_terrain_the_page_says_so_and_leads_to_imports(visitor: Visitor, no_model: None) -> None:
    page = opens_terrain(visitor, "cora")
    expect(page.locator("#terrain-list-end")).to_contain_text("No terrain here yet.")
    look_at(page, region.centre)
    page.locator("#map").click()
    expect(page.locator("#terrain-panel h2")).to_have_text("No terrain model knows the ground here.")
    page.get_by_role("link", name="Import a file").first.click()
    expect(page).to_have_url(re.compile(r"/imports$"))


def test_a_model_is_told_with_its_datum_voids_and_licence(visitor: Visitor, model: None) -> None:
    page = opens_terrain(visitor, "opal")
    row = page.locator(".terrain-row")
    expect(row).to_have_count(1)
    for words in (NAME, "EGM2008", "200\N{NO-BREAK SPACE}m to 700\N{NO-BREAK SPACE}m", "CC0-1.0", "400 posts"):
        expect(row).to_contain_text(words)
    expect(page.get_by_role("button", name=f"Remove {NAME}")).to_have_count(0)


@pytest.mark.long
def test_a_click_tells_the_height_of_the_ground_there(visitor: Visitor, model: None) -> None:
    page = opens_terrain(visitor, "vera")
    position = region.at(0.01, 0.001)
    place = look_at(page, position)
    page.mouse.click(place["x"], place["y"])
    assert shown_m(page) == pytest.approx(plane_m(position), abs=0.6)
    page.keyboard.press("Escape")
    expect(page.locator("#dock")).to_be_hidden()


@pytest.mark.long
def test_points_make_a_profile_and_the_last_can_be_taken_back(visitor: Visitor, model: None) -> None:
    page = opens_terrain(visitor, "vera")
    page.keyboard.press("p")
    look_at(page, region.centre, 13)
    for position in (region.at(-0.03, 0), region.at(0.01, 0.01), region.at(0.03, -0.01)):
        place = place_of(page, position)
        page.mouse.click(place["x"], place["y"])
    expect(page.get_by_role("heading", name="3 points")).to_be_visible()
    chart = page.locator("svg.profile-chart")
    expect(chart).to_have_attribute("aria-label", re.compile("from 370\N{NO-BREAK SPACE}m to 430\N{NO-BREAK SPACE}m above"))
    page.keyboard.press("Backspace")
    expect(page.get_by_role("heading", name="2 points")).to_be_visible()
    expect(chart).to_have_attribute("aria-label", re.compile("to 410\N{NO-BREAK SPACE}m above"))
    page.keyboard.press("Escape")
    expect(page.locator("#dock")).to_be_hidden()


def test_a_power_line_stands_in_its_profile_with_its_towers_and_one_cursor(visitor: Visitor, model: None) -> None:
    page = opens_terrain(visitor, "vera")
    page.get_by_role("radio", name="Profile").check(force=True)
    line, position = a_line_of(page)
    place = look_at(page, position)
    page.mouse.click(place["x"], place["y"])
    expect(page.get_by_role("heading", name=line["properties"]["label"])).to_be_visible()
    assert page.locator("svg.profile-chart .tower").count() > 5
    frame = page.locator(".profile-frame").bounding_box()
    assert frame
    page.mouse.move(frame["x"] + frame["width"] / 2, frame["y"] + 60)
    expect(page.locator(".profile-figures")).to_contain_text("Along")
    page.get_by_text("As a table").click()
    assert page.locator(".profile-table tbody tr").count() > 10


@pytest.mark.long
@pytest.mark.parametrize(
    ("theme", "width", "height", "name"), [("light", 1440, 900, "light"), ("dark", 1440, 900, "dark"), ("light", 390, 844, "phone")]
)
def test_the_profile_stands_in_sight(
    visitor: Visitor, model: None, picture: Callable[[Page, str], None], theme: str, width: int, height: int, name: str
) -> None:
    page = opens_terrain(visitor, "cora", size=(width, height), theme=theme)
    page.get_by_role("radio", name="Profile").check(force=True)
    _, position = a_line_of(page)
    place = look_at(page, position)
    page.mouse.click(place["x"], place["y"])
    expect(page.locator("svg.profile-chart")).to_be_in_viewport()
    wait_for_map(page)
    picture(page, f"terrain-{name}")


@pytest.mark.long
def test_a_curator_takes_a_model_away_after_being_asked(visitor: Visitor, model: None) -> None:
    page = opens_terrain(visitor, "cora")
    page.get_by_role("button", name=f"Remove {NAME}").click()
    page.get_by_role("button", name="Keep it").click()
    expect(page.locator(".terrain-row")).to_have_count(1)
    page.get_by_role("button", name=f"Remove {NAME}").click()
    page.get_by_role("dialog").get_by_role("button", name="Remove").click()
    expect(page.locator("#terrain-list-end")).to_contain_text("No terrain here yet.")
    assert asks(page, "/terrain")["features"] == []
