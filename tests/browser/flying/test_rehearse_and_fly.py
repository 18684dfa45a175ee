"""A mission from the first click to its record: picked, planned, rehearsed, approved, sent, flown by simulated UAVs, watched, over."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, asks, clicks_at, targets, wait_for_map
from tests.browser.pictures import HAS_PICTURES, Picture
from tests.browser.simulated_mission import (
    FLIGHT_MS,
    SOON_MS,
    answers,
    card,
    flies_in_simulation,
    panel_of,
    retires,
    simulated_uavs,
    two_towers,
)
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

NAME = "Gannet"
SILENT_S = "3600"  # until somebody ends it
WATCHES_THE_UAV = """() => {
    window.placesOfTheUav = new Set();
    const look = () => placesOfTheUav.add(document.querySelector("#map .map-flyer")?.style.transform);
    new MutationObserver(look).observe(document.getElementById("map"), { attributes: true, subtree: true, attributeFilter: ["style"] });
}"""


@pytest.fixture
def towers(visitor: Visitor) -> Iterator[list[list[float]]]:
    """Where two of them stand, with a simulated UAV of the fleet beside."""
    page = visitor.signs_in("ada")
    found = [tower["geometry"]["coordinates"] for tower in two_towers(page)]
    uavs = simulated_uavs(page, NAME, at=found[0])
    page.close()
    yield found
    retires(visitor.signs_in("ada"), uavs)


def test_a_mission_is_picked_planned_rehearsed_approved_flown_in_simulation_and_read_afterwards(
    visitor: Visitor, towers: list[list[float]], picture: Picture
) -> None:
    page = visitor.signs_in("opal")
    plans(page, towers, picture)
    rehearses(page, picture)
    approves_and_sends(page, picture)
    key = page.url.split("/missions/")[1].split("/")[0].split("#")[0]
    live = visitor.opens(f"/missions/{key}/fly", cookies=page.context.cookies())  # beside the plan: the flight is looked at from its start
    wait_for_map(live)
    flies(page, live, picture)
    loses_the_link_and_finds_it_again(live, picture)
    reads_the_log(live, picture)
    comes_home_at_10x(live, picture)
    live.get_by_role("link", name="Report", exact=True).click()
    reads_the_record(live, picture)
    if HAS_PICTURES:
        shows_more_of_it(visitor, key, picture)


def plans(page: Page, towers: list[list[float]], picture: Picture) -> None:
    page.goto("/missions/new")
    wait_for_map(page)
    for number, tower in enumerate(towers, 1):
        clicks_at(page, tower)
        expect(page.locator("#target-list li")).to_have_count(number)
    picture(page, "flow-1-picked")
    page.get_by_role("checkbox", name=NAME).check()
    page.get_by_role("switch", name="Return to start").check()
    page.get_by_role("button", name="Plan P").click()
    expect(page.locator("#plan-sentence")).to_contain_text("All back in", timeout=SOON_MS)
    assert len(targets(page)) == 2
    expect(page.locator(".mission-title .simulated-mark")).to_be_visible()
    expect(page).to_have_url(re.compile(r"/missions/[0-9a-f]{8}-"), timeout=SOON_MS)
    picture(page, "flow-2-planned")


def rehearses(page: Page, picture: Picture) -> None:
    page.get_by_role("link", name="Rehearse", exact=True).click()
    wait_for_map(page)
    expect(page).to_have_url(re.compile("/rehearse"))
    panel = page.get_by_role("region", name="Rehearsal")
    expect(panel).to_contain_text("Not rehearsed yet")
    picture(page, "flow-3-not-rehearsed")
    panel.get_by_role("button", name="Rehearse", exact=True).click()
    expect(panel.locator("#rehearsal-sentence")).to_have_text(re.compile("^It passes.*As planned"), timeout=FLIGHT_MS)
    expect(page.get_by_role("img", name="Height above take-off by time")).to_be_visible()
    expect(page.get_by_role("img", name="Battery by time")).to_be_visible()
    expect(panel.locator(".rehearsal-targets li")).to_have_count(2)
    expect(page).to_have_url(re.compile(r"/rehearse\?rehearsal=[0-9a-f-]{36}&run=0"))
    page.reload()
    wait_for_map(page)
    expect(panel.locator("#rehearsal-sentence")).to_have_text(re.compile("^It passes"))
    picture(page, "flow-3-rehearsed")


def approves_and_sends(page: Page, picture: Picture) -> None:
    page.get_by_role("button", name="Approve", exact=True).click()
    question = page.get_by_role("dialog")
    expect(question).to_contain_text(f"Simulated, no real aircraft: {NAME}.")
    picture(page, "flow-4-approve")
    answers(page, "Approve")
    expect(page.locator("#mission-state")).to_have_text("Approved", timeout=SOON_MS)
    page.get_by_role("link", name="Plan", exact=True).click()
    wait_for_map(page)
    expect(page.locator("#flyers .simulated-mark")).to_be_visible()
    fly = page.get_by_role("link", name="Fly in simulation")
    expect(fly).to_have_attribute("href", re.compile("/fly$"))


def flies(plan: Page, live: Page, picture: Picture) -> None:
    """In real time: a browser that is slow is still there in time."""
    flies_in_simulation(live, "Real time")
    plan.get_by_role("button", name="Upload to 1 UAV").click(timeout=SOON_MS)
    expect(plan.get_by_role("dialog", name="Upload the mission to 1 UAV?")).to_contain_text(NAME)
    answers(plan, "Upload to 1 UAV")
    expect(live.locator("#mission-state")).to_have_text("Uploaded", timeout=SOON_MS)
    expect(card(live, NAME).locator(".simulated-mark").first).to_be_visible(timeout=SOON_MS)
    expect(plan.locator("#flyers")).to_contain_text("Uploaded", timeout=SOON_MS)
    plan.get_by_role("button", name="Start 1 UAV").click(timeout=SOON_MS)
    picture(plan, "flow-5-on-board")
    question = plan.get_by_role("dialog", name="Start 1 UAV in planned order?")
    question.get_by_role("button", name="Start in planned order").click()  # is not done before the pilot's checks
    question.get_by_role("checkbox", name=re.compile("Looked at on site")).check()
    answers(plan, "Start in planned order")
    expect(live.locator("#mission-state")).to_have_text("In flight", timeout=SOON_MS)
    expect(live.locator("#map .map-flyer")).to_have_class(re.compile("measured"), timeout=SOON_MS)
    expect(card(live, NAME).locator("[data-figure=height]")).to_contain_text(re.compile("(AGL|above take-off)[1-9]"), timeout=SOON_MS)


def loses_the_link_and_finds_it_again(page: Page, picture: Picture) -> None:
    """While it stands in the air, so that the flight waits for whoever looks at it."""
    panel = panel_of(page)
    is_reported(page, "Hold")
    expect(card(page, NAME).locator(".chip").first).to_have_text("Holding", timeout=SOON_MS)
    panel.get_by_label("Link or GPS lost for").fill(SILENT_S)
    repair = panel.get_by_role("button", name="Clear faults")
    place = repair.bounding_box()
    panel.get_by_role("button", name="Lose the link").click()
    expect(panel.locator(".simulation-uavs")).to_contain_text("link lost", timeout=SOON_MS)
    alert = page.locator(".alert").filter(has_text=re.compile("no telemetry"))
    expect(alert.first).to_be_visible(timeout=SOON_MS)
    expect(alert.first.locator(".simulated-mark")).to_be_visible()
    assert repair.bounding_box() == place  # an alert that comes moves nothing that the pointer may be over
    expect(page.locator("#map .map-flyer")).to_have_class(re.compile("estimated"), timeout=SOON_MS)
    expect(card(page, NAME).locator(".estimate")).to_contain_text("(95 %)")
    picture(page, "flow-7-link-lost")
    alert.first.get_by_role("button", name="Acknowledge").click()
    expect(page.locator(".alert.known").filter(has_text="Acknowledged by opal").first).to_be_visible(timeout=SOON_MS)
    repair.click()
    expect(page.locator("#map .map-flyer")).to_have_class(re.compile("measured"), timeout=SOON_MS)
    is_reported(page, "Resume")


def reads_the_log(page: Page, picture: Picture) -> None:
    """Who did what, as the server keeps it; what is new comes by itself."""
    page.get_by_role("button", name="Event log").click()
    log = page.get_by_role("list", name="Event log")
    for words in (f"{NAME} took off", f"{NAME}: link lost for 3,600 s of simulated time, injected by opal", f"{NAME}: Hold, given by opal"):
        expect(log.get_by_text(words)).to_be_visible(timeout=SOON_MS)
    expect(log.get_by_text(re.compile("^Acknowledged by opal: ")).first).to_be_visible()
    expect(log.get_by_text(re.compile("^Resolved: ")).first).to_be_visible(timeout=SOON_MS)
    expect(log.get_by_text(f"{NAME}: Resume, done")).to_be_visible(timeout=SOON_MS)
    picture(page, "flow-7-event-log")
    assert faults(page) == []
    page.get_by_role("button", name="Back to target status").click()


def is_reported(page: Page, act: str) -> None:
    """By the button over the map, once the question is answered."""
    bar = page.get_by_role("group", name=f"Commands to {NAME}")
    if not bar.is_visible():
        card(page, NAME).get_by_role("button", name=re.compile(NAME)).click()
    bar.get_by_role("button", name=act, exact=True).click()
    page.get_by_role("dialog").get_by_role("button", name=re.compile(f"^{act}")).click()
    expect(page.get_by_role("dialog")).to_have_count(0)


def comes_home_at_10x(page: Page, picture: Picture) -> None:
    page.evaluate(WATCHES_THE_UAV)
    panel_of(page).get_by_role("combobox", name="Speed").select_option(label="10× real time")
    page.wait_for_function("() => window.placesOfTheUav.size > 2", timeout=FLIGHT_MS)  # it moves
    picture(page, "flow-6-flying")
    expect(page.locator("#mission-state")).to_have_text("Completed", timeout=FLIGHT_MS)
    expect(page.locator("#board .complete")).to_have_count(2)
    page.get_by_role("button", name="Event log").click()
    expect(page.get_by_role("list", name="Event log").get_by_text(f"{NAME} landed")).to_be_visible(timeout=SOON_MS)
    page.get_by_role("button", name="Back to target status").click()
    assert faults(page) == []
    assert page.evaluate(TOO_WIDE) == []
    picture(page, "flow-8-completed")


def reads_the_record(page: Page, picture: Picture) -> None:
    wait_for_map(page)
    expect(page.locator("#report-state")).to_have_text("Completed")
    expect(page.locator("#report-sentence")).to_contain_text("2", timeout=SOON_MS)
    expect(page.locator("#report-said")).to_contain_text("Simulated flight.")
    expect(page.get_by_role("row", name=re.compile(r"^Distance .*\d"))).to_be_visible()
    expect(page.get_by_role("img", name="Height above take-off by time")).to_be_visible()
    expect(page.locator("#replay-strips .replay-row")).to_have_count(1)
    picture(page, "flow-9-record")


def shows_more_of_it(visitor: Visitor, key: str, picture: Picture) -> None:
    """Dark, and on a phone; for the documentation alone."""
    for theme, size, mark in (("dark", (1440, 900), "dark"), ("light", (390, 844), "phone")):
        page = visitor.signs_in("vera", theme=theme, size=size, touch=size[0] < 600)
        for stage in ("rehearse", "fly", "report"):
            page.goto(f"/missions/{key}/{stage}")
            wait_for_map(page)
            picture(page, f"flow-{stage}-{mark}")
        assert asks(page, f"/missions/{key}")["state"] == "completed"
        page.close()
