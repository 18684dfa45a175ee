"""The panel of rehearsals on the page of a mission: by pointer and keys, wide and narrow, in both languages."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.flying.test_report import VIEWS, posts
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.pictures import HAS_PICTURES, THEMES
from tests.browser.regions import region
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes
from tests.cases import long

pytestmark = pytest.mark.browser

WHY_WITHOUT_REHEARSAL = "Why it is approved without a passed rehearsal"
Picture = Callable[[Page, str], None]
FLIGHT_MS = 120_000
STARTS = dict(zip(("Wigeon", "Shoveler"), region.row_starts, strict=True))
INTO_VIEW = """(panel) => {
    const scrolled = panel.closest(".side-scroll");
    scrolled.scrollTop += panel.getBoundingClientRect().top - scrolled.getBoundingClientRect().top;
}"""
_planned: dict[str, str] = {}


@pytest.fixture
def planned(visitor: Visitor, site: Site) -> str:
    """A mission of two UAVs that is planned, over flat ground: its key; planned once for all tests."""
    if site.address not in _planned:
        page = visitor.signs_in("ada")
        uavs = [
            posts(page, "/uavs", {"name": name, "position": position, "is_simulated": True, "type": unlimited_type(page)})["id"]
            for name, position in STARTS.items()
        ]
        towers = asks(page, f"/assets?kind=tower&bbox={region.short_row}&limit=100")["features"]
        body = {
            "name": "South belt, rehearsed", "uavs": [{"id": uav, "most_targets": 2} for uav in uavs],
            "targets": [{"asset": tower["id"]} for tower in towers[:: max(1, len(towers) // 3)][:3]],
            "return_to_start": True, "plan": True,
        }  # fmt: skip
        _planned[site.address] = posts(page, "/missions", body)["id"]
        page.close()
    return _planned[site.address]


@pytest.fixture
def rehearsed(visitor: Visitor, planned: str) -> str:
    """The same mission, with a rehearsal that has failed with little in the batteries; rehearsed here where no test has done it."""
    page = visitor.signs_in("ada")
    if not asks(page, f"/missions/{planned}/rehearsals")["results"]:
        body = {"conditions": ["calm", {"battery_percent": 25}]}
        address = f"/missions/{planned}/rehearsals/{posts(page, f'/missions/{planned}/rehearsals', body)['id']}"
        expect(opened(page, planned).locator("#rehearsal-sentence")).to_have_count(1, timeout=FLIGHT_MS)
        assert asks(page, address)["state"] == "done"
    page.close()
    return planned


@contextmanager
def asked_for_rehearsals(visitor: Visitor) -> Iterator[None]:
    """The organisation approves only what has passed; other tests approve without."""
    page = visitor.signs_in("ada")
    try:
        writes(page, "PUT", "/rehearsal-rule", {"requires_green": True})
        yield
    finally:
        writes(page, "PUT", "/rehearsal-rule", {"requires_green": False})
    visitor.complaints[:] = [words for words in visitor.complaints if "409 (Conflict)" not in words]  # the refusal that is looked for


def opened(page: Page, key: str) -> Page:
    page.goto(f"/missions/{key}")
    wait_for_map(page)
    return page


def test_a_plan_is_rehearsed_and_its_verdict_read(visitor: Visitor, planned: str, picture: Picture) -> None:
    page = opened(visitor.signs_in("opal"), planned)
    panel = page.get_by_role("region", name="Rehearsal")
    page.keyboard.press("r")
    expect(panel.get_by_role("checkbox", name="Calm")).to_be_focused()
    panel.get_by_role("checkbox", name="As planned").uncheck()
    start = panel.get_by_role("button", name="Rehearse", exact=True)
    expect(start).to_be_disabled()
    panel.get_by_role("checkbox", name="Calm").check()
    panel.get_by_text("Custom conditions").last.click()
    panel.get_by_label("Battery holds").fill("25")
    expect(panel.get_by_role("checkbox", name="Custom conditions")).to_be_checked()
    start.click()
    expect(panel.get_by_role("button", name="Stop")).to_be_visible()
    sentence = panel.locator("#rehearsal-sentence")
    expect(sentence).to_have_text(re.compile(r"^\d of 3 targets fails?: Custom conditions\.$"), timeout=FLIGHT_MS)
    expect(panel.get_by_role("group", name="Conditions").get_by_role("button", name="Custom conditions")).to_have_attribute(
        "aria-pressed", "true"
    )
    expect(panel.locator(".rehearsal-targets .fail .rehearsal-why").first).to_have_text(
        re.compile(r"% battery at return, limit 20 %|was not flown to")
    )
    failures = panel.get_by_role("list", name="What failed")
    expect(failures.get_by_role("button", name="Show").first).to_be_visible()
    expect(panel.get_by_role("row", name=re.compile("Custom conditions.*capacity"))).to_be_visible()
    expect(page.get_by_role("img", name="Height above take-off by time").first).to_be_visible()
    expect(panel.get_by_role("row", name=re.compile(r"^Battery at landing .* limit 20\s%"))).to_be_visible()
    panel.get_by_role("button", name="Calm").click()
    expect(panel.locator(".rehearsal-targets .pass")).to_have_count(3)
    panel.get_by_text("Limits and simulated aircraft").click()
    expect(panel).to_contain_text("Wigeon: the simulated Iris, the nearest by speed and mass")
    picture(page, "rehearsal-limits")


@pytest.mark.long
@pytest.mark.parametrize("view", [*VIEWS] if HAS_PICTURES else ["phone-light", *long("dark")])
def test_the_verdict_fits_every_window(visitor: Visitor, rehearsed: str, picture: Picture, view: str) -> None:
    page = opened(visitor.signs_in("vera", **VIEWS[view]), rehearsed)
    panel = page.locator("#rehearsal")
    expect(panel.locator("#rehearsal-sentence")).to_have_count(1)
    expect(panel.get_by_role("button", name="Rehearse", exact=True)).to_have_count(0)
    panel.evaluate(INTO_VIEW)
    picture(page, f"rehearsal-{view}")
    assert faults(page) == []


@pytest.mark.long
def test_what_its_rehearsal_failed_is_not_approved_where_a_rehearsal_is_asked_for(
    visitor: Visitor, rehearsed: str, picture: Picture
) -> None:
    page = visitor.signs_in("opal")
    with asked_for_rehearsals(visitor):
        opened(page, rehearsed)
        page.get_by_role("button", name="Approve", exact=True).click()
        page.get_by_label(WHY_WITHOUT_REHEARSAL).fill("It will be fine")
        page.get_by_role("dialog").get_by_role("button", name="Approve", exact=True).click()
        expect(page.locator("#notices")).to_contain_text("The rehearsal failed. Change the plan for what its assessment says")
        picture(page, "rehearsal-refused-approval")
    assert asks(page, f"/missions/{rehearsed}")["state"] == "planned"


@pytest.mark.long
def test_a_mission_into_14_mps_of_wind_is_refused_with_the_reason(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("ada")
    strong = {"wind": [{"altitude_agl_m": 10, "speed_mps": 14.0, "from_deg": 0.0}]}
    uav = posts(
        page,
        "/uavs",
        {
            "name": "Gadwall",
            "position": STARTS["Wigeon"],
            "is_simulated": True,
            "type": unlimited_type(page),
            "cruise_speed_mps": 10.0,
            "max_airspeed_mps": 20.0,
        },
    )["id"]
    tower = asks(page, f"/assets?kind=tower&bbox={region.row_west}&limit=1")["features"][0]["id"]
    body = {
        "name": "Into the wind", "uavs": [{"id": uav}], "targets": [{"asset": tower}], "conditions": strong, "return_to_start": True,
        "plan": True,
    }  # fmt: skip
    key = posts(page, "/missions", body)["id"]
    page.goto(f"/missions/{key}/rehearse")
    wait_for_map(page)
    panel = page.get_by_role("region", name="Rehearsal")
    panel.get_by_role("button", name="Rehearse", exact=True).click()
    expect(panel.locator("#rehearsal-sentence")).to_have_text(re.compile("fails?: As planned"), timeout=FLIGHT_MS)
    expect(panel.locator(".rehearsal-reasons")).to_contain_text(
        re.compile(r"wind of 14\.0 m/s at \d+ m, it flies [\d.]+ m/s through the air at most")
    )
    picture(page, "rehearsal-wind")
    with asked_for_rehearsals(visitor):
        page.get_by_role("button", name="Approve", exact=True).click()
        page.get_by_label(WHY_WITHOUT_REHEARSAL).fill("It will be fine")
        page.get_by_role("dialog").get_by_role("button", name="Approve", exact=True).click()
        expect(page.locator("#notices")).to_contain_text("The rehearsal failed.")


def test_a_failed_rehearsal_stands_first_in_the_briefing_and_wants_a_reason_that_is_kept(
    visitor: Visitor, rehearsed: str, picture: Picture
) -> None:
    page = opened(visitor.signs_in("opal"), rehearsed)
    page.get_by_role("button", name="Approve", exact=True).click()
    briefing = page.get_by_role("dialog").locator(".approval-facts")
    expect(briefing.locator("dd").first).to_have_text("Fail: Custom conditions")
    expect(briefing.locator("dd").first).to_have_class("bad")
    for theme in THEMES:
        page.emulate_media(color_scheme=theme)
        picture(page, f"approve-briefing-{theme}")
    page.set_viewport_size({"width": 390, "height": 844})
    picture(page, "approve-briefing-phone")
    page.get_by_label(WHY_WITHOUT_REHEARSAL).fill("The weak battery was a test")
    page.get_by_role("dialog").get_by_role("button", name="Approve", exact=True).click()
    expect(page.locator("#mission-state")).to_have_text("Approved")
    approval = asks(page, f"/missions/{rehearsed}/approval")
    assert approval["failed_rehearsal_reason"] == "The weak battery was a test"
    writes(page, "POST", f"/missions/{rehearsed}/revoke", {"reason": "Other tests plan it"})


@pytest.mark.long
def test_a_verdict_of_another_plan_is_out_of_date(visitor: Visitor, rehearsed: str) -> None:
    page = visitor.signs_in("opal")
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    body: dict[str, Any] = {"departs_at": (datetime.now(UTC) + timedelta(days=30)).isoformat(), "plan": True}
    assert page.request.patch(f"/api/v1/missions/{rehearsed}", data=body, headers={"X-CSRFToken": token, "If-Match": "*"}).ok
    opened(page, rehearsed)
    expect(page.get_by_role("region", name="Rehearsal")).to_contain_text("Outdated:")


@pytest.mark.long
def test_an_administrator_asks_for_rehearsals_before_approval(visitor: Visitor) -> None:
    page = visitor.signs_in("ada")
    page.goto("/administration?tab=rules")
    page.locator("html[data-loaded]").wait_for(state="attached")
    rule = page.get_by_role("switch", name="Approve only what has passed a rehearsal")
    for wanted in (True, False):  # other tests approve without one
        rule.set_checked(wanted)
        expect(rule).to_be_enabled()
        assert asks(page, "/rehearsal-rule") == {"requires_green": wanted}
