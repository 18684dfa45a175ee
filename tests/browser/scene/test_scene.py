"""The 3D view: a rehearsed flight among towers and wires, by pointer and keys, as a picture, as a link, and without WebGL."""

import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.flying.test_report import posts
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.pictures import CANVAS_COLOURS, colours_of
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
TIMEOUT_MS = 60_000  # pictures are drawn by the processor here
FLIGHT_S = 120
DEPARTS_AT = (datetime.now(UTC) + timedelta(days=20)).replace(hour=15, minute=0, second=0, microsecond=0)
NO_WEBGL = """
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith("webgl") ? null : own.call(this, kind, ...rest);
    };
"""
_rehearsed: dict[str, tuple[str, str]] = {}


@pytest.fixture
def rehearsed(visitor: Visitor, site: Site) -> tuple[str, str]:
    """Keys of a mission with one short flight to a tower, and of its rehearsal in calm air; flown once for all tests."""
    if site.address not in _rehearsed:
        page = visitor.signs_in("ada")
        uav = posts(page, "/uavs", {"name": "Eider", "position": region.beside_tower, "is_simulated": True, "type": unlimited_type(page)})[
            "id"
        ]
        towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=200")["features"]
        nearest = min(
            towers, key=lambda tower: sum((a - b) ** 2 for a, b in zip(tower["geometry"]["coordinates"], region.beside_tower, strict=True))
        )
        body: dict[str, Any] = {
            "name": "One tower", "uavs": [{"id": uav}], "targets": [{"asset": nearest["id"]}], "return_to_start": True, "plan": True,
            "departs_at": DEPARTS_AT.isoformat(),
        }  # fmt: skip
        mission = posts(page, "/missions", body)["id"]
        rehearsal = posts(page, f"/missions/{mission}/rehearsals", {"conditions": ["calm"]})["id"]
        for _ in range(FLIGHT_S):
            state = asks(page, f"/missions/{mission}/rehearsals/{rehearsal}")["state"]
            if state not in {"queued", "running"}:
                break
            page.wait_for_timeout(1_000)
        assert state == "done"
        page.close()
        _rehearsed[site.address] = mission, rehearsal
    return _rehearsed[site.address]


def seen(page: Page, address: str) -> Page:
    page.goto(address)
    page.locator("html[data-loaded]").wait_for(state="attached", timeout=TIMEOUT_MS)
    expect(page.locator(".scene-canvas")).to_have_attribute("aria-label", re.compile("UAV"), timeout=TIMEOUT_MS)
    return page


def test_a_rehearsal_is_seen_in_space_kept_as_a_picture_and_linked(visitor: Visitor, rehearsed: tuple[str, str], picture: Picture) -> None:
    mission, rehearsal = rehearsed
    page = seen(visitor.signs_in("vera", draws=True), f"/missions/{mission}/3d")  # without a flight on record: the newest rehearsal
    canvas = page.get_by_role("img", name=re.compile("^3D view: 1 UAV"))
    instruments = page.get_by_role("region", name="Instruments")
    expect(instruments).to_contain_text("Eider", timeout=TIMEOUT_MS)
    expect(page.get_by_text("Simulated", exact=True)).to_be_visible()
    page.keyboard.press(".")  # from the take-off on: its target is reached
    expect(instruments.locator("[data-reading=task]")).to_contain_text("A1", timeout=TIMEOUT_MS)
    expect(instruments.locator("[data-reading=wire]")).to_contain_text("m", timeout=TIMEOUT_MS)
    page.keyboard.press("o")
    expect(page.get_by_role("radio", name="Target")).to_be_checked()
    expect(canvas).to_have_attribute("aria-label", re.compile("Round a target A1"), timeout=TIMEOUT_MS)
    with page.expect_download(timeout=TIMEOUT_MS) as kept:
        page.keyboard.press("p")
    assert kept.value.suggested_filename.startswith(f"one-tower-{DEPARTS_AT:%Y-%m-%d}-15")
    assert colours_of(page, kept.value.path().read_bytes()) > 100
    expect(page).to_have_url(re.compile(rf"source=rehearsal:{rehearsal}:0&t={DEPARTS_AT:%Y-%m-%d}T15.*camera=orbit"), timeout=TIMEOUT_MS)
    clock = page.locator(".scene-clock").text_content()
    assert faults(page) == []
    other = seen(visitor.signs_in("opal"), page.url)
    expect(other.locator(".scene-clock")).to_have_text(clock or "")
    expect(other.get_by_role("radio", name="Target")).to_be_checked()


@pytest.mark.long
def test_over_the_map_of_a_mission(visitor: Visitor, rehearsed: tuple[str, str]) -> None:
    page = visitor.signs_in("opal")
    page.goto(f"/missions/{rehearsed[0]}")
    wait_for_map(page)
    page.get_by_role("button", name="3D view").click()
    panel = page.get_by_role("region", name="3D view")
    expect(panel.get_by_role("img", name=re.compile("^3D view"))).to_be_focused(timeout=TIMEOUT_MS)
    page.keyboard.press("t")
    expect(panel.get_by_role("radio", name="Top")).to_be_checked(timeout=TIMEOUT_MS)
    page.keyboard.press("Escape")
    expect(panel).to_have_count(0)


def test_without_webgl_it_says_so_and_shows_the_flight_from_above(visitor: Visitor, rehearsed: tuple[str, str]) -> None:
    page = visitor.signs_in("vera")
    page.add_init_script(NO_WEBGL)
    seen(page, f"/missions/{rehearsed[0]}/3d")
    expect(page.get_by_role("status").filter(has_text="This browser draws no 3D. WebGL is missing")).to_be_visible()
    canvas = page.get_by_role("img", name=re.compile("^View from above, without WebGL: 1 UAV"))
    expect(canvas).to_be_visible()
    drawn = f"(canvas) => ({CANVAS_COLOURS})(canvas) > 5"  # ground, lines, the planned way and a UAV, not a blank
    page.wait_for_function(drawn, arg=canvas.element_handle())
    expect(page.get_by_role("radio", name="Chase")).to_be_disabled()
