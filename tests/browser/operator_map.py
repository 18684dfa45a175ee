"""How a test works the operator's map: places on the screen, picking, planning."""

from dataclasses import dataclass
from typing import Any

from playwright.sync_api import Page, TimeoutError, expect

from tests.browser.regions import region

CLOSE_ZOOM = 16
MAX_MOVES, MOVE_TIMEOUT_MS = 4, 15_000
A_HAIR = 1e-5  # of a level: another address for the same place
STANDS_STILL_AT = """(position) => {
    const map = document.getElementById("map");
    const { x, y } = map.project(position);
    const isThere = Math.hypot(x - map.clientWidth / 2, y - map.clientHeight / 2) < 2;
    const rounded = 1 / devicePixelRatio - 1; // a canvas has whole pixels, which conftest makes larger
    const isGrown = Math.abs(map.querySelector("canvas").clientHeight - map.clientHeight) <= rounded; // as the panel lets it
    return isThere && map.dataset.idle === "true" && isGrown;
}"""
TOO_WIDE = """() => {
    const wide = document.documentElement.scrollWidth - innerWidth;
    if (wide <= 0) return [];
    const leaves = (element) => element.getBoundingClientRect().right > innerWidth + 1;
    const guilty = [...document.body.querySelectorAll("*")].filter(leaves).slice(0, 5);
    return [`${wide} px too wide`, ...guilty.map((at) => at.outerHTML.slice(0, 120))];
}"""


def wait_for_map(page: Page) -> None:
    page.locator("html[data-loaded]").wait_for(state="attached")
    page.locator("#map[data-idle]").wait_for(state="attached")


def at_zoom(zoom: float, position: list[float]) -> str:
    """The end of an address that opens the map there."""
    return f"#map={zoom:g}/{position[1]:.9g}/{position[0]:.9g}"


def asks(page: Page, path: str) -> Any:
    """A GET of the API with the page's session."""
    answer = page.request.get(f"/api/v1{path}")
    assert answer.ok, f"{path}: {answer.status} {answer.text()}"
    return answer.json()


def unlimited_type(page: Page) -> int:
    """A type whose UAVs can be planned without a range; made once."""
    found = [row["id"] for row in asks(page, "/uav-types?limit=1000")["results"] if row["name"] == "Unlimited"]
    if found:
        return int(found[0])
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    body = {"name": "Unlimited", "range_unlimited": True}
    answer = page.request.post("/api/v1/uav-types", data=body, headers={"X-CSRFToken": token})
    assert answer.ok, answer.text()
    return int(answer.json()["id"])


def look_at(page: Page, position: list[float], zoom: float = CLOSE_ZOOM) -> dict[str, float]:
    """Moves the map there by its address; the place on the screen. A panel that is still growing moves the map away: then once more."""
    for number in range(MAX_MOVES):
        page.evaluate(
            """async ([longitude, latitude, zoom]) => {
                const map = document.getElementById("map");
                delete map.dataset.idle;
                location.hash = `map=${zoom}/${latitude}/${longitude}`;
            }""",
            [*position, zoom + number * A_HAIR],
        )
        try:
            page.wait_for_function(STANDS_STILL_AT, arg=position, timeout=MOVE_TIMEOUT_MS)
        except TimeoutError:
            continue
        return place_of(page, position)
    raise AssertionError(f"the map does not come to {position}")


def place_of(page: Page, position: list[float]) -> dict[str, float]:
    return page.evaluate(
        """(position) => {
            const map = document.getElementById("map");
            const box = map.getBoundingClientRect();
            const { x, y } = map.project(position);
            return { x: box.left + x, y: box.top + y };
        }""",
        position,
    )


def clicks_at(page: Page, position: list[float], zoom: float = CLOSE_ZOOM) -> None:
    place = look_at(page, position, zoom)
    page.mouse.click(place["x"], place["y"])


def targets(page: Page) -> list[str]:
    return page.locator("#target-list .what span").all_text_contents()


def second_facts(page: Page) -> dict[str, str]:
    """Of each target's row, by its name."""
    return dict(zip(targets(page), page.locator("#target-list .what small").all_text_contents(), strict=True))


def chooses_type(page: Page) -> None:
    """In the dialog of a new UAV."""
    page.get_by_role("dialog").get_by_label("Type").select_option(f"{unlimited_type(page)}")  # waits until the types are there


def adds_uav(page: Page, name: str, position: list[float], *, range_km: float | None = None, base: str | None = None) -> None:
    page.get_by_role("button", name="Add a UAV").click()
    unlimited_type(page)  # before the dialog reads the types
    place = look_at(page, position, 12)
    page.mouse.click(place["x"], place["y"])
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Name").fill(name)
    chooses_type(page)
    if base:
        dialog.get_by_label("Base").select_option(base)
    if range_km:
        dialog.get_by_label("Range").fill(str(range_km))
    dialog.get_by_role("button", name="Add").click()
    expect(page.get_by_role("checkbox", name=name)).to_be_checked()


@dataclass(frozen=True)
class Pickable:
    """Something of each kind that stands alone enough to be clicked."""

    tower: dict[str, Any]
    bridge: dict[str, Any]
    railway_point: list[float]
    line: dict[str, Any]
    line_point: list[float]


def find_pickable(page: Page) -> Pickable:
    """Assets that stand away from others of a kind that a click would prefer, and outside the zones."""
    tower = next(
        feature
        for feature in asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=100")["features"]
        if _is_alone(page, feature["geometry"]["coordinates"], "tower")
    )
    bridge = next(
        feature
        for feature in asks(page, f"/assets?kind=bridge&bbox={region.bridges}&limit=100")["features"]
        if _is_alone(page, feature["properties"]["centre"], "tower,bridge")
    )
    west, south, east, north = map(float, region.railways.split(","))
    railway_point = next(
        place
        for feature in asks(page, f"/assets?kind=railway&bbox={region.railways}&limit=100")["features"]
        for place in _vertices(page, feature["id"])[1:-1]
        if west < place[0] < east and south < place[1] < north and _is_alone(page, place, "tower,bridge,line,railway")
    )
    lines = asks(page, f"/assets?kind=line&bbox={region.lines}&limit=100")["features"]
    line = next(feature for feature in lines if feature["properties"]["is_flyable"] and len(_vertices(page, feature["id"])) > 10)
    a, b = _vertices(page, line["id"])[4:6]
    return Pickable(tower, bridge, railway_point, line, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2])


def _vertices(page: Page, asset: int) -> list[list[float]]:
    geometry = asks(page, f"/assets/{asset}")["geometry"]
    return geometry["coordinates"] if geometry["type"] == "LineString" else geometry["coordinates"][0]


def _is_alone(page: Page, place: list[float], kinds: str) -> bool:
    around = 0.0004  # some 40 m
    stands_there = [feature["geometry"]["coordinates"] for feature in asks(page, "/uavs?limit=100")["features"]]
    if any(max(abs(uav[0] - place[0]), abs(uav[1] - place[1])) < 3 * around for uav in stands_there):
        return False  # a click would meet its mark
    box = f"{place[0] - around},{place[1] - around},{place[0] + around},{place[1] + around}"
    return len(asks(page, f"/assets?kind={kinds}&bbox={box}&limit=3")["features"]) == 1


def stores_mission(page: Page, name: str) -> str:
    """A planned mission with two UAVs and two towers, made through the API with the page's session. Its address."""
    towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=2")["features"]
    uavs = [{"name": "Heron", "position": region.west}, {"name": "Kite", "position": region.east}]
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    answer = page.request.post(
        "/api/v1/missions",
        data={
            "name": name, "uavs": uavs, "targets": [{"asset": tower["id"]} for tower in towers],
            "objective": "makespan", "return_to_start": True, "plan": True,
        },
        headers={"X-CSRFToken": token},
    )  # fmt: skip
    assert answer.status == 201, answer.text()
    return f"/missions/{answer.json()['id']}"
