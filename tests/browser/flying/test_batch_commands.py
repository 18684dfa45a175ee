"""Batch commands on the page: those of one mission reach its UAVs alone, and Live asks of which mission, with nothing chosen."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from examples.companion.link import HttpLink
from tests.browser.conftest import Site, Visitor
from tests.browser.flying.uav_over_http import Flyer
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.regions import region
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = [pytest.mark.browser, pytest.mark.long]  # UAVs fly in real time

FLEET = {"South": ("Tern", "Kite"), "North": ("Crow", "Rook")}


Flown = tuple[str, list[Flyer]]


def sent(page: Page, site: Site, name: str, row: int) -> Flown:
    """A mission that is sent to its two UAVs, which have taken it, and the UAVs."""
    towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=5")["features"]
    uavs = []
    for column, uav in enumerate(FLEET[name]):
        at = [region.east[0] + 0.012 * column, region.east[1] - 0.006 * row]
        uavs.append(
            writes(
                page, "POST", "/uavs", {"name": uav, "position": at, "is_simulated": True, "type": unlimited_type(page), "link": "http"}
            )["id"]
        )
    tokens = [writes(page, "POST", f"/uavs/{uav}/credentials", {"kind": "link-token"})["secret"] for uav in uavs]
    body = {
        "name": name, "uavs": [{"id": uav, "most_targets": 2} for uav in uavs], "targets": [{"asset": tower["id"]} for tower in towers[:3]],
        "objective": "makespan", "return_to_start": True, "plan": True,
    }  # fmt: skip
    mission = writes(page, "POST", "/missions", body)["id"]
    writes(page, "POST", f"/missions/{mission}/approve")
    writes(page, "POST", f"/missions/{mission}/dispatch")
    flyers = [Flyer(HttpLink(site.address, token)) for token in tokens]
    for flyer in flyers:
        flyer.obeys()
    return mission, flyers


def ends(visitor: Visitor, mission: str, flyers: list[Flyer]) -> None:
    page = visitor.signs_in("ada")
    if asks(page, f"/missions/{mission}")["state"] in {"dispatched", "active"}:
        writes(page, "POST", f"/missions/{mission}/abort")
        for flyer in flyers:
            flyer.obeys()
    for flyer in flyers:
        if flyer.content is not None:
            flyer.reports(0.0, is_in_air=False, is_armed=False)  # else it is waited for by the starts of the next test
    for uav in asks(page, f"/missions/{mission}")["uavs"]:
        writes(page, "PATCH", f"/uavs/{uav['id']}", {"state": "retired", "name": f"Flown {uav['id']}"})
    page.context.close()


@pytest.fixture
def two(visitor: Visitor, site: Site) -> Iterator[dict[str, Flown]]:
    """Two missions in flight with two UAVs each."""
    page = visitor.signs_in("ada")
    flown = {name: sent(page, site, name, row) for row, name in enumerate(FLEET)}
    for mission, flyers in flown.values():
        for uav, flyer in zip(asks(page, f"/missions/{mission}")["uavs"], flyers, strict=True):
            writes(page, "POST", f"/uavs/{uav['id']}/commands", {"kind": "start", "parameters": {"out_of_slot": True}})
            flyer.obeys()
            flyer.reports(20.0)
    page.context.close()
    yield flown
    for mission, flyers in flown.values():
        ends(visitor, mission, flyers)


@pytest.fixture
def waiting(visitor: Visitor, site: Site) -> Iterator[Flown]:
    """A mission whose two UAVs wait for their start."""
    page = visitor.signs_in("ada")
    flown = sent(page, site, "South", 0)
    page.context.close()
    yield flown
    ends(visitor, *flown)


def opened(page: Page, path: str) -> Page:
    page.goto(path)
    wait_for_map(page)
    return page


def reported(flyers: list[Flyer]) -> list[list[str]]:
    for flyer in flyers:
        flyer.obeys()
    return [[kind for kind in flyer.reported if kind in {"hold", "return"}] for flyer in flyers]


def test_return_all_on_the_page_of_a_mission_reaches_that_mission_alone(visitor: Visitor, two: dict, picture: Picture) -> None:
    (south, of_south), (_north, of_north) = two["South"], two["North"]
    page = opened(visitor.signs_in("opal"), f"/missions/{south}/fly")
    expect(page.locator("#uav-cards .card")).to_have_count(2)
    page.get_by_role("button", name="Return all").click()
    question = page.get_by_role("dialog", name="Return all 2 UAVs?")
    expect(question).to_contain_text(re.compile("Tern, Kite|Kite, Tern"))
    expect(question).to_contain_text("Return path of Tern unknown: its companion computer decides. Nothing on it is checked.")
    with page.expect_request(lambda request: request.method == "POST") as sent:
        question.get_by_role("button", name="Return: 2").click()
    assert sent.value.url.endswith(f"/missions/{south}/commands")
    expect(page.locator(".toast")).to_contain_text("Sending to 2 UAVs.")
    assert reported(of_south) == [["return"], ["return"]]
    assert reported(of_north) == [[], []]


def test_live_asks_of_which_mission_with_nothing_chosen(visitor: Visitor, two: dict, picture: Picture) -> None:
    (_south, of_south), (_north, of_north) = two["South"], two["North"]
    page = opened(visitor.signs_in("opal"), "/live")
    for name in (*FLEET["South"], *FLEET["North"]):
        expect(page.locator("#uav-cards .card").filter(has_text=name)).to_have_count(1)
    page.get_by_role("button", name="Return all").click()
    question = page.get_by_role("dialog", name="Return all: of which mission?")
    expect(question.get_by_role("radio")).to_have_count(3)
    expect(question.locator("input:checked")).to_have_count(0)
    expect(question.get_by_role("button", name="Return all")).to_be_disabled()
    page.keyboard.press("Enter")
    expect(question).to_be_visible()
    in_both_themes(page, picture, "live-batch")
    assert faults(page) == []
    question.get_by_role("radio", name=re.compile("^North")).check()
    question.get_by_role("button", name="Return all").click()
    expect(page.locator(".toast")).to_contain_text("Sending to 2 UAVs.")
    assert reported(of_south) == [[], []]
    assert reported(of_north) == [["return"], ["return"]]


def test_starts_in_planned_order_go_on_without_the_page_and_are_stopped_from_another(
    visitor: Visitor, waiting: Flown, picture: Picture
) -> None:
    mission, flyers = waiting
    page = opened(visitor.signs_in("opal"), f"/missions/{mission}/fly")
    for flyer in flyers:
        flyer.reports(0.0, is_in_air=False, is_armed=False)
    page.get_by_role("checkbox", name=re.compile("Looked at on site")).check()
    page.get_by_role("button", name="Start 2 UAVs").click()
    question = page.get_by_role("dialog", name="Start 2 UAVs in planned order?")
    expect(question).to_contain_text("in 10 s")
    question.get_by_role("button", name="Start in planned order").click()
    starts = page.locator("#planned-starts")
    expect(starts.locator("li").first).to_contain_text(re.compile(r"in 0:0\d"))
    in_both_themes(page, picture, "live-starts")
    assert faults(page) == []
    page.context.close()

    other = opened(visitor.signs_in("rory"), "/live")
    row = other.locator("#planned-starts")
    expect(row.get_by_text("Start given").first).to_be_visible(timeout=20_000)
    for flyer in flyers:
        flyer.obeys()
    assert sorted(flyer.reported.count("start") for flyer in flyers) in ([0, 1], [1, 1])
    if row.get_by_role("button", name="Stop starting").count():
        row.get_by_role("button", name="Stop starting").click()
        expect(row).to_contain_text("No further UAV is started")
