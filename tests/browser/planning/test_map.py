"""Where the map opens, what stands around it, and what it says of targets."""

import re

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, at_zoom, look_at, place_of, stores_mission, wait_for_map
from tests.browser.pictures import colours_of
from tests.browser.regions import region
from tests.cases import long

pytestmark = pytest.mark.browser

BETWEEN = [pytest.param(1024, 768, marks=pytest.mark.long), pytest.param(900, 1100, marks=pytest.mark.long)]  # sizes between the extremes
VIEW = re.compile(r"#map=([\d.]+)/")
OVERLAPS = """() => {
    document.getElementById("demo-badge").hidden = false;
    const shown = ["#legend", "#demo-badge", "#coordinates", "#scale", "#attribution", ".map-controls"]
        .map((name) => [name, document.querySelector(`.map-frame ${name}`).getBoundingClientRect()])
        .filter(([, box]) => box.width > 0);
    const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const frame = document.querySelector(".map-frame").getBoundingClientRect();
    const found = shown.filter(([, box]) => box.left < frame.left || box.right > frame.right).map(([name]) => `${name} leaves the map`);
    shown.forEach(([a, first], index) => shown.slice(index + 1).forEach(([b, second]) => meet(first, second) && found.push(`${a} ${b}`)));
    return { names: shown.map(([name]) => name), found };
}"""


def opens_mission(page: Page, name: str, *, view: str = "") -> dict[str, object]:
    [mission] = [mission for mission in asks(page, "/missions?limit=100")["results"] if mission["name"] == name]
    page.goto(f"/missions/{mission['id']}{view}")
    return asks(page, f"/missions/{mission['id']}")


@pytest.mark.parametrize(("width", "height"), [(1440, 900), *BETWEEN, (390, 844)])
def test_nothing_around_the_map_lies_on_anything_else(visitor: Visitor, width: int, height: int) -> None:
    page = visitor.signs_in("opal", size=(width, height), touch=width < 721)
    page.goto("/missions/new")
    wait_for_map(page)
    place = page.locator("#map").bounding_box()
    assert place
    page.mouse.move(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)  # the coordinates come with the pointer
    page.wait_for_function("() => document.getElementById('coordinates').textContent !== ''")
    around = page.evaluate(OVERLAPS)
    assert around["found"] == []
    assert ("#legend" in around["names"]) == (width > 720)


@pytest.mark.parametrize("theme", ["light", *long("dark")])
def test_the_network_and_the_zones_are_drawn(visitor: Visitor, theme: str) -> None:
    page = visitor.signs_in("opal", theme=theme, draws=True)
    page.goto("/missions/new")
    wait_for_map(page)
    place = look_at(page, region.in_heliport, 13)
    around = {"x": place["x"] - 100, "y": place["y"] - 100, "width": 200, "height": 200}
    assert colours_of(page, page.screenshot(clip=around)) > 20
    with_zone = page.screenshot(clip={**around, "x": place["x"], "y": place["y"], "width": 4, "height": 4})
    place = look_at(page, region.empty, 13)
    empty = page.screenshot(clip={"x": place["x"], "y": place["y"], "width": 4, "height": 4})
    assert with_zone != empty


@pytest.mark.long
@pytest.mark.parametrize("size", [(390, 844), *long((1440, 900))])
def test_a_mission_opens_at_its_routes_whatever_far_view_its_address_names(visitor: Visitor, size: tuple[int, int]) -> None:
    page = visitor.signs_in("opal", size=size, touch=size[0] < 721)
    stores_mission(page, f"Seen at {size[0]}")
    for view in ("", "#map=3.48/45/14", at_zoom(3.48, region.centre)):
        mission = opens_mission(page, f"Seen at {size[0]}", view=view)
        wait_for_map(page)
        page.wait_for_url(lambda url: (found := VIEW.search(url)) is not None and float(found[1]) > 9)
        frame = page.locator("#map").bounding_box()
        assert frame
        for route in mission["plan"]["routes"]:  # type: ignore[index]
            for position in route["geometry"]["coordinates"] if route["geometry"] else []:
                place = place_of(page, position)
                assert frame["x"] < place["x"] < frame["x"] + frame["width"]
                assert frame["y"] < place["y"] < frame["y"] + frame["height"]
        page.goto("about:blank")


@pytest.mark.long
def test_a_view_of_the_ground_in_the_address_is_kept_and_moving_adds_nothing_to_the_history(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    longitude, latitude = region.centre
    page.goto(f"/missions/new{at_zoom(14, region.centre)}")
    wait_for_map(page)
    expect(page).to_have_url(re.compile(f"{re.escape(at_zoom(14, region.centre))}$"))
    before = page.evaluate("history.length")
    page.get_by_role("button", name="Zoom in").click()
    expect(page).to_have_url(re.compile(rf"#map=15/{latitude:.5f}\d*/{longitude:.5f}\d*$".replace(".", r"\.")))
    assert page.evaluate("history.length") == before


def test_routes_say_how_they_end_and_the_switch_what_happens_without_it(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    stores_mission(page, "Ends")
    opens_mission(page, "Ends")
    wait_for_map(page)
    expect(page.get_by_role("list", name="Routes")).to_contain_text("returns to start")
    expect(page.get_by_text("Each UAV flies back to where it took off")).to_be_visible()
    page.get_by_role("switch", name="Return to start").uncheck()
    expect(page.get_by_text("Each UAV ends hovering at its last target")).to_be_visible()
    page.get_by_role("button", name="Plan again").click()
    expect(page.locator("#plan-sentence")).to_have_text(re.compile(r"Done in \d+\smin\."))
    expect(page.get_by_role("list", name="Routes")).to_contain_text(re.compile(r"ends hovering at [AB]\d"))


@pytest.mark.long
def test_a_base_map_that_cannot_be_reached_is_said_once_and_asked_for_no_more(visitor: Visitor) -> None:
    page = visitor.signs_in("opal", draws=True)
    asked: list[str] = []

    def refuse(route: Route) -> None:
        asked.append(route.request.url)
        route.abort()

    def with_base_map(route: Route) -> None:
        answer = route.fetch()
        body = answer.text().replace(
            '"baseMap": {"tiles": ""', f'"baseMap": {{"tiles": "{visitor.site.address}/no-tiles/{{z}}/{{x}}/{{y}}"'
        )
        assert "/no-tiles/" in body
        route.fulfill(response=answer, body=body)

    page.route("**/no-tiles/**", refuse)
    page.route("**/missions/new", with_base_map)
    page.goto("/missions/new")
    message = page.get_by_text("The base map cannot be reached")
    expect(message).to_be_visible()
    wait_for_map(page)
    before = len(asked)
    assert 1 <= before <= 40  # one view's
    page.locator("#zoom-in").click()
    wait_for_map(page)
    page.reload()
    wait_for_map(page)
    expect(message).to_have_count(0)
    assert len(asked) == before
    page.get_by_role("button", name="Layers").click()
    page.get_by_role("radio", name="Map", exact=True).check()
    expect(message).to_be_visible()
    assert len(asked) > before
    page.close()  # no tile is refused later
    visitor.complaints[:] = [complaint for complaint in visitor.complaints if "ERR_FAILED" not in complaint]  # the tiles
