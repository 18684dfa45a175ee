"""A planned mission is approved, frozen, and taken back; Plan leads to Fly, where it is sent and steered."""

import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, asks, unlimited_type, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser

STARTS = {"Petrel": region.west, "Skua": region.east}


def posts(page: Page, path: str, body: dict[str, Any], *, method: str = "POST") -> Any:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    return page.request.fetch(f"/api/v1{path}", method=method, data=body, headers={"X-CSRFToken": token, "If-Match": "*"})


@pytest.fixture
def mission(visitor: Visitor) -> Iterator[str]:
    """The address of a planned mission of two simulated UAVs of the fleet, which are free again afterwards."""
    page = visitor.signs_in("ada")
    known = {uav["properties"]["name"]: uav["id"] for uav in asks(page, "/uavs?limit=200")["features"]}
    for name, position in STARTS.items():
        if name not in known:
            made = posts(page, "/uavs", {"name": name, "position": position, "is_simulated": True, "type": unlimited_type(page)})
            assert made.status == 201, made.text()
            known[name] = made.json()["id"]
    towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=2")["features"]
    body = {
        "name": "South belt, by night", "uavs": [{"id": known[name], "most_targets": 1} for name in STARTS],
        "targets": [{"asset": tower["id"]} for tower in towers],
        "objective": "makespan", "return_to_start": True, "plan": True,
    }  # fmt: skip
    made = posts(page, "/missions", body)
    assert made.status == 201, made.text()
    address = f"/missions/{made.json()['id']}"
    page.close()
    yield address
    page = visitor.signs_in("ada")
    if asks(page, address)["state"] in {"dispatched", "active"}:
        assert posts(page, f"{address}/abort", {}).ok


def opened(page: Page, mission: str) -> None:
    page.goto(mission)
    wait_for_map(page)


def answers(page: Page, act: str) -> None:
    page.get_by_role("dialog").get_by_role("button", name=act, exact=True).click()
    expect(page.get_by_role("dialog")).to_have_count(0)


def cannot_be_reported(page: Page, name: str) -> None:
    """One that never connected: every command says why not."""
    page.locator("#uav-cards .card").filter(has_text=name).get_by_role("button", name=re.compile(name)).click()
    bar = page.get_by_role("group", name=f"Commands to {name}")
    for act in ("Hold", "Return", "Land here", "Abort"):
        expect(bar.get_by_role("button", name=act, exact=True)).to_be_disabled()
    expect(bar).to_contain_text(f"{name} never connected.")
    bar.get_by_role("button", name="More").click()
    menu = page.locator(".menu")
    start = menu.get_by_role("button", name="Start", exact=True)
    expect(start).to_be_disabled()
    expect(start).to_have_attribute("title", f"{name} does not have its mission yet.")
    expect(menu.get_by_role("button", name="Upload again")).to_be_disabled()
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Abort the mission")).to_be_visible()


def test_a_mission_is_approved_frozen_sent_and_revoked(visitor: Visitor, mission: str, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    opened(page, mission)
    state = page.locator("#mission-state")
    expect(state).to_have_text("Planned")
    page.get_by_role("button", name="Approve", exact=True).click()
    question = page.get_by_role("dialog", name="Approve “South belt, by night”?")
    expect(question).to_contain_text("2 UAVs fly")
    expect(question).to_contain_text("RehearsalNot rehearsed")
    picture(page, "approve-light")
    answers(page, "Approve")

    expect(state).to_have_text("Approved")
    wait_for_map(page)
    expect(page.locator("#flying-said")).to_have_text(
        re.compile(r"Approved by opal .* Nothing of it can be changed until that is revoked\.")
    )
    expect(page.get_by_role("button", name=re.compile("^Plan|^Save$|Add a UAV"))).to_have_count(0)
    expect(page.get_by_role("textbox", name="Name of the mission")).to_have_attribute("readonly", "")
    assert posts(page, f"/missions/{mission.split('/')[-1]}", {"name": "Other"}, method="PATCH").status == 409

    expect(page.get_by_role("button", name=re.compile("^Send|^Upload|^Start|^Hold|^Abort"))).to_have_count(0)
    expect(page.get_by_role("link", name="Fly in simulation")).to_have_class(re.compile("primary"))
    assert posts(page, f"/missions/{mission.split('/')[-1]}/dispatch", {}).ok  # before they are switched on
    expect(state).to_have_text("Uploaded")
    uavs = page.get_by_role("list", name="UAVs of this mission").get_by_role("listitem")
    expect(uavs).to_have_count(2)
    for number in range(2):
        expect(uavs.nth(number)).to_contain_text("Waiting for the UAV")
    assert [command["kind"] for command in asks(page, f"{mission}/commands")["results"]] == ["upload-mission"] * 2
    page.locator("#commands summary").click()
    expect(page.get_by_role("list", name="Commands").get_by_role("listitem")).to_have_count(2)
    picture(page, "flying-light")
    page.get_by_role("link", name="Fly in simulation").click()
    wait_for_map(page)
    cannot_be_reported(page, "Petrel")
    page.go_back()
    wait_for_map(page)

    page.get_by_role("button", name="Revoke").click()
    question = page.get_by_role("dialog")
    question.get_by_role("textbox").fill("Storm is coming")
    answers(page, "Revoke")
    expect(state).to_have_text("Planned")
    wait_for_map(page)
    expect(page.get_by_role("button", name="Approve", exact=True)).to_be_enabled()
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="History").click()
    history = page.get_by_role("list", name="History")
    expect(history.get_by_role("listitem").first).to_contain_text("Approval revoked")
    expect(history.get_by_role("listitem").first).to_contain_text("Storm is coming")


@pytest.mark.long
def test_a_plan_that_reaches_no_target_cannot_be_approved(visitor: Visitor, mission: str) -> None:
    page = visitor.signs_in("opal")
    uavs = [{"name": uav["name"], "position": uav["position"], "max_range_m": 20.0} for uav in asks(page, mission)["uavs"]]
    assert posts(page, mission, {"uavs": uavs, "plan": True}, method="PATCH").ok
    opened(page, mission)
    approve = page.get_by_role("button", name="Approve", exact=True)
    expect(approve).to_be_disabled()
    expect(page.locator("#mission-state")).to_have_text("Not possible")
    expect(approve).to_have_attribute("title", "The plan reaches no target: there is nothing to approve.")


def test_what_is_refused_is_said_with_every_reason(visitor: Visitor, mission: str) -> None:
    page = visitor.signs_in("opal")
    uavs = [{"name": uav["name"], "position": uav["position"], "most_targets": 1} for uav in asks(page, mission)["uavs"]]
    assert posts(page, mission, {"uavs": uavs, "plan": True}, method="PATCH").ok
    opened(page, mission)
    page.get_by_role("button", name="Approve", exact=True).click()
    why = page.get_by_label("Why it is approved without a passed rehearsal")  # aircraft that no simulation has flown
    expect(why).to_be_focused()
    page.get_by_role("dialog").get_by_role("button", name="Approve", exact=True).click()
    expect(page.get_by_role("dialog")).to_be_visible()
    why.fill("Flown last week, unchanged")
    answers(page, "Approve")
    notices = page.locator("#notices")
    expect(notices).to_contain_text("Not approved.")
    expect(notices).to_contain_text("Petrel would fly as over flat ground")
    expect(notices).to_contain_text("Skua would fly as over flat ground")
    expect(page.locator("#mission-state")).to_have_text("Planned")
    visitor.complaints.clear()  # the refusal itself, which the browser writes into its log


@pytest.mark.long
@pytest.mark.parametrize(
    ("theme", "size", "name"),
    [("light", (390, 844), "flying-phone"), pytest.param("dark", (1440, 900), "flying-dark", marks=pytest.mark.long)],
)
def test_a_mission_on_its_way_fits_every_window(
    visitor: Visitor, mission: str, picture: Callable[[Page, str], None], theme: str, size: tuple[int, int], name: str
) -> None:
    page = visitor.signs_in("opal", theme=theme, size=size, touch=size[0] < 721)
    key = mission.split("/")[-1]
    assert posts(page, f"/missions/{key}/approve", {}).ok
    sent = posts(page, f"/missions/{key}/dispatch", {}).json()
    posts(page, f"/uavs/{sent['commands'][0]['uav']['id']}/commands", {"kind": "abort"})  # an earlier abort holds back all else
    opened(page, mission)
    if size[0] < 721:
        page.get_by_role("button", name="Panel height").click()
    expect(page.get_by_text("Waiting for the UAV").first).to_be_visible()
    expect(page.locator(".flyer-board").filter(has_text="Abort: waiting")).to_be_visible()
    assert page.evaluate(TOO_WIDE) == []
    picture(page, name)
    assert posts(page, f"/missions/{key}/abort", {"why": "Over"}).ok
    expect(page.locator("#mission-state")).to_have_text("Aborted")
    expect(page.get_by_role("button", name="Save a copy")).to_be_visible()


@pytest.mark.long
def test_viewers_see_a_mission_on_its_way_and_have_no_buttons(visitor: Visitor, mission: str) -> None:
    operator = visitor.signs_in("opal")
    key = mission.split("/")[-1]
    assert posts(operator, f"/missions/{key}/approve", {}).ok
    assert posts(operator, f"/missions/{key}/dispatch", {}).ok
    page = visitor.signs_in("vera")
    opened(page, mission)
    expect(page.get_by_text("Waiting for the UAV").first).to_be_visible()
    expect(page.get_by_role("button", name=re.compile("^Hold|^Revoke|^Abort|^Send"))).to_have_count(0)
    expect(page.get_by_role("link", name=re.compile("^Fly: "))).to_have_count(0)
    assert posts(operator, f"/missions/{key}/revoke", {"reason": "Over"}).ok
    expect(page.locator("#mission-state")).to_have_text("Planned")
