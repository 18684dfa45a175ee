"""The 3D view of a flight as it happens: measured is told from estimated, and a view that is cut off says so and comes again."""

import re
from dataclasses import dataclass, field

import pytest
from playwright.sync_api import Locator, Page, WebSocketRoute, expect

from tests.browser.conftest import Visitor
from tests.browser.flying.test_live import STEP_M, flies_until, flight
from tests.browser.flying.uav_over_http import Flyer
from tests.browser.operator_map import asks, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.scene.test_scene import TIMEOUT_MS
from tests.browser.test_fleet import writes

__all__ = ["flight"]
pytestmark = [pytest.mark.browser, pytest.mark.long]  # UAVs fly in real time

LIVE_SOCKET = re.compile(r"/ws/missions/[^/]+/live$")
ASKED = "**/api/v1/live*"
BEGINS_M = 3_000.0  # along the route, where there are towers
AGAIN_S = 30  # the page reads the record of a flight anew


@dataclass
class Line:
    """The page's websocket, which can be cut and mended; without it the page may not ask by HTTP either."""

    page: Page
    is_cut: bool = False
    routes: list[WebSocketRoute] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.page.route_web_socket(LIVE_SOCKET, self._opens)

    def _opens(self, route: WebSocketRoute) -> None:
        if self.is_cut:
            route.close()
            return
        route.connect_to_server()
        self.routes.append(route)

    def cut(self) -> None:
        self.is_cut = True
        self.page.route(ASKED, lambda request: request.abort())
        for route in self.routes:
            route.close()
        self.routes.clear()

    def repair(self) -> None:
        self.is_cut = False
        self.page.unroute(ASKED)


def starts(page: Page, mission: str) -> None:
    for uav in {command["uav"]["id"] for command in asks(page, f"/missions/{mission}/commands")["results"]}:
        writes(page, "POST", f"/uavs/{uav}/commands", {"kind": "start", "parameters": {"out_of_slot": True}})


def reading(page: Page, name: str) -> str:
    return page.locator(f"[data-reading={name}] .scene-value").inner_text()


def is_shown(place: Locator, words: str) -> bool:
    return place.count() > 0 and words in place.inner_text()


def test_beside_the_map_a_flight_moves_and_what_is_measured_is_told_from_what_is_estimated(
    visitor: Visitor, flight: tuple[str, list[Flyer]], picture: Picture
) -> None:
    mission, flyers = flight
    page = visitor.signs_in("opal")
    starts(page, mission)
    page.goto(f"/missions/{mission}/fly")
    wait_for_map(page)
    along_m = flies_until(page, lambda: page.locator(".map-flyer.measured").count() == 2, flyers, BEGINS_M)
    page.get_by_role("button", name="3D view").click()
    view = page.get_by_role("region", name="3D view")
    certainty = view.locator(".scene-certainty")
    along_m = flies_until(page, lambda: is_shown(certainty, "measured"), flyers, along_m)
    expect(view.locator(".simulated-mark")).to_have_text("Simulated")
    expect(view.get_by_role("img", name=re.compile("^3D view: 2 UAVs"))).to_be_visible()
    first = reading(page, "tower")
    along_m = flies_until(page, lambda: reading(page, "tower") != first, flyers, along_m)

    along_m = flies_until(page, lambda: is_shown(certainty, "estimated, ±"), flyers[1:], along_m)
    assert reading(page, "tower").startswith("~")
    view.get_by_role("button", name=re.compile("^Follow B")).click()
    along_m = flies_until(page, lambda: is_shown(certainty, "measured"), flyers[1:], along_m)
    page.keyboard.press("o")
    in_both_themes(page, picture, "scene-live")
    view.get_by_role("button", name=re.compile("^Follow A")).click()
    expect(certainty).to_contain_text("estimated")
    flies_until(page, lambda: is_shown(certainty, "measured"), flyers, along_m)


def test_a_view_that_is_cut_off_says_so_and_goes_on_when_the_line_is_mended(visitor: Visitor, flight: tuple[str, list[Flyer]]) -> None:
    mission, flyers = flight
    page = visitor.signs_in("opal")
    line = Line(page)
    starts(page, mission)
    page.goto(f"/missions/{mission}/3d?source=live")
    page.locator("html[data-loaded]").wait_for(state="attached", timeout=TIMEOUT_MS)
    certainty = page.locator(".scene-certainty")
    along_m = flies_until(page, lambda: is_shown(certainty, "measured"), flyers, BEGINS_M)
    cut_off = page.get_by_role("status").filter(has_text="everything here is as of then. Connecting again.")
    expect(cut_off).to_have_count(0)
    line.cut()
    expect(cut_off).to_be_visible()
    seen = reading(page, "tower")
    line.repair()
    expect(cut_off).to_be_hidden()
    flies_until(page, lambda: is_shown(certainty, "measured") and reading(page, "tower") != seen, flyers, along_m)
    visitor.complaints[:] = [words for words in visitor.complaints if "ERR_FAILED" not in words]


def test_the_view_over_a_record_goes_with_a_flight_that_is_under_way(visitor: Visitor, flight: tuple[str, list[Flyer]]) -> None:
    mission, flyers = flight
    page = visitor.signs_in("opal")
    starts(page, mission)
    along_m = flies_until(page, lambda: asks(page, f"/missions/{mission}")["state"] == "active", flyers, BEGINS_M)
    for _ in range(3):
        along_m += STEP_M
        for flyer in flyers:
            flyer.reports(along_m)
        page.wait_for_timeout(1_000)  # a UAV reports once a second
    page.goto(f"/missions/{mission}/report")
    wait_for_map(page)
    page.get_by_role("button", name="3D view").click()
    expect(page.locator(".scene-certainty")).to_have_text("measured", timeout=TIMEOUT_MS)
    page.locator("#replay-slider").press("End")
    at_the_end = reading(page, "tower")
    flies_until(page, lambda: reading(page, "tower") != at_the_end, flyers, along_m, most=AGAIN_S + 30)
