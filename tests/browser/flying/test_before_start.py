"""From approved to the start of all UAVs on the Fly page: one button that names the next act, with its checks, in four clicks."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from examples.companion.link import HttpLink
from tests.browser.conftest import Site, Visitor
from tests.browser.flying.test_batch_commands import ends
from tests.browser.flying.uav_over_http import Flyer
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.regions import region
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = pytest.mark.browser


MAX_REPORTS = 45
Approved = tuple[str, list[tuple[Flyer, list[float]]]]


@pytest.fixture
def approved(visitor: Visitor, site: Site) -> Iterator[Approved]:
    """A mission of two UAVs that nobody has sent, with where each one takes off; their companions were not heard yet."""
    page = visitor.signs_in("ada")
    towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=5")["features"]
    places = [[region.east[0] + 0.012 * column, region.east[1]] for column in range(2)]
    uavs = [
        writes(page, "POST", "/uavs", {"name": name, "position": at, "is_simulated": True, "type": unlimited_type(page), "link": "http"})[
            "id"
        ]
        for name, at in zip(("Bunting", "Pipit"), places, strict=True)
    ]
    tokens = [writes(page, "POST", f"/uavs/{uav}/credentials", {"kind": "link-token"})["secret"] for uav in uavs]
    body: dict[str, Any] = {
        "name": "South", "uavs": [{"id": uav, "most_targets": 2} for uav in uavs],
        "targets": [{"asset": tower["id"]} for tower in towers[:3]], "objective": "makespan", "return_to_start": True, "plan": True,
    }  # fmt: skip
    mission = writes(page, "POST", "/missions", body)["id"]
    writes(page, "POST", f"/missions/{mission}/approve")
    page.context.close()
    flyers = [Flyer(HttpLink(site.address, token)) for token in tokens]
    standing = list(zip(flyers, places, strict=True))
    yield mission, standing
    switched_on(standing)  # on the ground, so that no batch of another test reaches them
    ends(visitor, mission, flyers)


def switched_on(standing: list[tuple[Flyer, list[float]]]) -> None:
    for flyer, at in standing:
        flyer.stands(at)


def uploads(page: Page, standing: list[tuple[Flyer, list[float]]], received: int) -> Locator:
    """Presses Upload while the first UAVs report, as often as the service asks for; returns the panel once they take the mission."""
    panel = page.get_by_role("region", name="Before start")
    upload = panel.get_by_role("button", name="Upload to 2 UAVs")
    is_uploading = panel.get_by_role("button", name="Uploading")
    for button in (upload, is_uploading):
        for _ in range(MAX_REPORTS):
            switched_on(standing[:received])
            if button.count():
                break
            page.wait_for_timeout(1000)  # a UAV reports once a second
        if button is upload:
            upload.click()
    expect(is_uploading).to_be_disabled()
    return panel


def test_four_clicks_lead_from_approved_to_the_start_of_all(visitor: Visitor, approved: Approved, picture: Picture) -> None:
    mission, standing = approved
    page = visitor.signs_in("opal")
    page.goto(f"/missions/{mission}/fly")
    wait_for_map(page)
    panel = page.get_by_role("region", name="Before start")
    expect(panel.get_by_role("button", name="Fly in simulation")).to_be_enabled()  # whose simulated UAVs would connect by themselves
    expect(panel).to_contain_text("It connects by itself once its simulation runs.")

    uploads(page, standing, 2)  # 1
    for flyer, _at in standing:
        flyer.obeys()
    switched_on(standing)
    start = panel.get_by_role("button", name="Start 2 UAVs")
    expect(start).to_be_disabled()
    panel.locator("summary").first.click()
    in_both_themes(page, picture, "fly-before-start")
    assert faults(page) == []
    switched_on(standing)
    panel.get_by_role("checkbox", name=re.compile("Looked at on site")).check()  # 2
    start.click()  # 3
    switched_on(standing)
    question = page.get_by_role("dialog", name="Start 2 UAVs in planned order?")
    question.get_by_role("button", name="Start in planned order").click()  # 4
    expect(page.locator("#planned-starts li").first).to_contain_text(re.compile(r"in 0:0\d"))
    began = asks(page, f"/missions/{mission}/planned-starts")["starts"]
    assert {start["state"] for start in began["uavs"]} == {"waiting"}
    page.get_by_role("button", name="Stop starting").click()
    expect(page.locator("#planned-starts")).to_contain_text("No further UAV is started")


@pytest.mark.long
def test_a_uav_in_another_place_is_left_with_its_reason(visitor: Visitor, approved: Approved) -> None:
    mission, standing = approved
    page: Page = visitor.signs_in("opal")
    page.goto(f"/missions/{mission}/fly")
    wait_for_map(page)
    panel = uploads(page, standing, 2)
    for flyer, _at in standing:
        flyer.obeys()
    (away, (lon, lat)), (other, at) = standing
    away.stands([lon + 0.01, lat])
    other.stands(at)
    panel.get_by_role("checkbox", name=re.compile("Looked at on site")).check()
    expect(panel.get_by_role("button", name="Start 1 of 2 UAVs")).to_be_enabled()
    expect(panel.locator("#preflight-why")).to_contain_text("from its planned take-off place. Carry it there")
    other.stands([at[0] + 0.01, at[1]])
    expect(panel.locator("#preflight-why")).to_contain_text("Blocked:")
    expect(panel.get_by_role("button", name="Start 2 UAVs")).to_be_disabled()


@pytest.mark.long
def test_one_that_is_not_connected_is_left_and_named_and_the_others_start(visitor: Visitor, approved: Approved, picture: Picture) -> None:
    mission, standing = approved
    page: Page = visitor.signs_in("opal")
    names = [uav["name"] for uav in asks(page, f"/missions/{mission}")["uavs"]]
    page.goto(f"/missions/{mission}/fly")
    wait_for_map(page)
    panel = uploads(page, standing, 1)
    standing[0][0].obeys()
    switched_on(standing[:1])
    panel.get_by_role("checkbox", name=re.compile("Looked at on site")).check()
    expect(panel.locator("#preflight-why")).to_have_text(f"{names[1]} is not connected.")
    in_both_themes(page, picture, "fly-one-is-left")
    switched_on(standing[:1])
    panel.get_by_role("button", name="Start 1 of 2 UAVs").click()
    question = page.get_by_role("dialog", name="Start 1 UAV in planned order?")
    expect(question).to_contain_text(f"Not started: {names[1]} is not connected.")
    question.get_by_role("button", name="Start in planned order").click()
    expect(page.locator("#planned-starts li")).to_have_count(1)
    expect(panel).to_contain_text(f"{names[1]}")  # what is being started is not offered again
    expect(panel).not_to_contain_text(names[0])
    page.get_by_role("button", name="Stop starting").click()
    expect(page.locator("#planned-starts")).to_contain_text("No further UAV is started")
