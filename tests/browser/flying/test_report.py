"""The record of a flown mission: the sentence, the figures, the flight once more by pointer and keys."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.operator_map import TOO_WIDE, asks, stores_mission, unlimited_type, wait_for_map
from tests.browser.pictures import HAS_PICTURES
from tests.browser.regions import region
from tests.browser.test_accessibility import faults
from tests.cases import long

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
STARTS = {"Pintail": region.west, "Garganey": region.east}
VIEWS: dict[str, dict[str, Any]] = {
    "light": {"theme": "light", "size": (1440, 900)},
    "dark": {"theme": "dark", "size": (1440, 900)},
    "tablet-light": {"theme": "light", "size": (1024, 768)},
    "phone-light": {"theme": "light", "size": (390, 844), "touch": True},
    "phone-dark": {"theme": "dark", "size": (390, 844), "touch": True},
}
SENTENCE = re.compile(r"^\d of 8 targets inspected")
_flown: dict[str, str] = {}


def posts(page: Page, path: str, body: dict[str, Any]) -> Any:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    answer = page.request.post(f"/api/v1{path}", data=body, headers={"X-CSRFToken": token, "If-Match": "*"})
    assert answer.ok, f"{path}: {answer.status} {answer.text()}"
    return answer.json()


@pytest.fixture
def flown(visitor: Visitor, site: Site) -> str:
    """The address of the report of a mission that two UAVs have flown; flown once for all tests."""
    if site.address not in _flown:
        page = visitor.signs_in("ada")
        uavs = [
            posts(page, "/uavs", {"name": name, "position": position, "is_simulated": True, "type": unlimited_type(page)})["id"]
            for name, position in STARTS.items()
        ]
        towers = asks(page, f"/assets?kind=tower&bbox={region.report_towers}&limit=400")["features"]
        towers = towers[:: len(towers) // 8][:8]
        body = {
            "name": "South belt, autumn", "uavs": [{"id": uav, "most_targets": 4} for uav in uavs],
            "targets": [{"asset": tower["id"]} for tower in towers],
            "objective": "makespan", "return_to_start": True, "plan": True,
        }  # fmt: skip
        key = posts(page, "/missions", body)["id"]
        posts(page, f"/missions/{key}/approve", {})
        posts(page, f"/missions/{key}/dispatch", {})
        site.does(f"from tests.browser.flying.flown_mission import fly_mission; fly_mission('{key}')")
        page.close()
        _flown[site.address] = f"/missions/{key}/report"
    return _flown[site.address]


def opened(page: Page, address: str) -> Page:
    page.goto(address)
    wait_for_map(page)
    return page


def test_a_flown_mission_is_told_and_flown_once_more(visitor: Visitor, flown: str) -> None:
    page = opened(visitor.signs_in("opal"), flown)
    expect(page.get_by_role("heading", name=SENTENCE)).to_be_visible()
    reasons = page.locator("#report-reasons")
    expect(reasons).to_contain_text(re.compile(r"not inspected: Garganey passed it at \d+ m\."))
    figures = page.get_by_role("table", name="Planned and flown")
    expect(figures.get_by_role("row", name=re.compile(r"^Distance \d.* km \d.* km [+−]"))).to_be_visible()
    missed = page.get_by_role("region", name=re.compile("^Not inspected"))
    expect(missed.get_by_role("listitem")).to_have_count(1)
    expect(missed).to_contain_text(re.compile(r"Garganey passed it at \d+ m"))
    expect(page.get_by_role("rowheader", name="Track error (RMS)")).to_be_hidden()
    page.locator("#report-quality > summary").click()
    expect(page.get_by_role("rowheader", name="Track error (RMS)")).to_be_visible()

    page.locator("#report-targets > summary").click()
    expect(page.locator("#report-targets .report-target-state:is(.inspected, .not-confirmed)")).to_have_count(7)
    page.locator("#report-legs > summary").click()
    page.locator(".report-route > summary").first.click()
    stage = page.locator(".report-leg[aria-expanded=false]").first
    stage.click()
    page.locator(".report-within:visible .report-leg").nth(1).hover()
    page.locator("#report-alerts > summary").click()
    for words in ("Pintail: no report for 12 s", "Garganey: 300 m off its route"):
        expect(page.locator("#report-alerts")).to_contain_text(words)

    slider = page.get_by_role("slider", name="Time of the replay")
    slider.focus()
    page.keyboard.press("End")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("Pintail lands|Garganey lands"))
    page.keyboard.press("Home")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("09:10:0., Pintail takes off"))
    page.keyboard.press(".")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("reached|Garganey takes off"))
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Stop", exact=True)).to_be_visible()
    before = slider.get_attribute("aria-valuenow")
    expect(slider).not_to_have_attribute("aria-valuenow", before or "")
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()

    page.locator("#report-alerts").get_by_role("button", name="09:14:12").click()
    expect(page.locator("#replay-strips .replay-row").first).to_contain_text("estimated, ±")
    expect(page.locator("#map .map-flyer.estimated")).to_have_count(1)
    page.get_by_role("button", name="A Pintail", exact=True).click()
    expect(page.get_by_role("button", name="A Pintail", exact=True)).to_have_attribute("aria-pressed", "true")
    box = slider.bounding_box()
    assert box
    page.mouse.click(box["x"] + box["width"] * 0.5, box["y"] + 40)
    whole = int(slider.get_attribute("aria-valuemax") or 0)
    assert int(slider.get_attribute("aria-valuenow") or 0) == pytest.approx(whole / 2, abs=whole * 0.02)
    with page.expect_download() as download:
        page.get_by_role("link", name="All data (ZIP)").click()
    assert download.value.suggested_filename.endswith("-record.zip")
    for name, ending in (("Results (XLSX)", "xlsx"), ("KML", "kml")):
        with page.expect_download() as download:
            page.get_by_role("link", name=name).click()
        assert download.value.suggested_filename.endswith(f"-results.{ending}")


@pytest.mark.long
@pytest.mark.parametrize("view", [*VIEWS] if HAS_PICTURES else ["phone-light", *long("dark")])
def test_the_record_fits_every_window(visitor: Visitor, flown: str, picture: Picture, view: str) -> None:
    page = opened(visitor.signs_in("vera", **VIEWS[view]), flown)
    expect(page.get_by_role("heading", name=SENTENCE)).to_be_visible()
    page.locator("#report-alerts button").first.evaluate("(button) => button.click()")
    picture(page, f"report-{view}")
    for part in ("targets", "legs", "alerts", "commands", "quality"):
        page.locator(f"#report-{part} > summary").click()
    assert faults(page) == []


def test_a_mission_that_nobody_has_flown_says_so(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opened(page, f"{stores_mission(page, 'Left on the ground')}/report")
    expect(page.get_by_role("heading", name="Not flown yet.")).to_be_visible()
    expect(page.locator("#dock")).to_contain_text("Nothing to replay yet.")
    expect(page.get_by_role("slider")).to_have_count(0)
    assert page.evaluate(TOO_WIDE) == []
    picture(page, "report-empty-light")


@pytest.mark.long
@pytest.mark.parametrize("start", ["fly", *long("report")])
def test_a_mission_with_open_targets_is_closed_and_followed_up(visitor: Visitor, site: Site, picture: Picture, start: str) -> None:
    """After an abort: each open target gets a reason, and the draft of the rest is there at once."""
    page = visitor.signs_in("ada")
    uav = posts(page, "/uavs", {"name": f"Wigeon {start}", "position": region.west, "is_simulated": True, "type": unlimited_type(page)})[
        "id"
    ]
    towers = asks(page, f"/assets?kind=tower&bbox={region.report_towers}&limit=400")["features"][:2]
    body = {"name": f"West, {start}", "uavs": [{"id": uav}], "targets": [{"asset": tower["id"]} for tower in towers], "plan": True}
    key = posts(page, "/missions", body)["id"]
    for act in ("approve", "dispatch", "abort"):
        posts(page, f"/missions/{key}/{act}", {} if act != "abort" else {"why": "thunderstorm"})
    opened(page, f"/missions/{key}/{start}")
    page.get_by_role("button", name="Close mission").click()
    dialog = page.get_by_role("dialog", name=re.compile("^Close"))
    reasons = dialog.locator(".close-reasons input")
    expect(reasons).to_have_count(2)
    expect(reasons.first).to_have_value("mission aborted by ada: thunderstorm")
    reasons.nth(1).fill("")
    dialog.get_by_role("button", name="Close mission").click()
    expect(dialog).to_be_visible()
    reasons.nth(1).fill("lightning over the valley")
    picture(page, f"close-mission-{start}")
    assert faults(page) == []
    dialog.get_by_label("Plan a follow-up").check()
    dialog.get_by_role("button", name="Close mission").click()
    page.wait_for_url(lambda address: key not in address and "/missions/" in address)
    expect(page).to_have_title(re.compile(f"^West, {start} – follow-up"))
    opened(page, f"/missions/{key}/report")
    expect(page.get_by_role("heading", name="0 of 2 targets inspected")).to_be_visible()
    expect(page.locator("#report-reasons")).to_contain_text("not inspected: lightning over the valley.")
    expect(page.get_by_role("button", name="Close mission")).to_be_hidden()
    expect(page.get_by_role("button", name="Plan a follow-up")).to_be_visible()
