"""From a folder of photos to findings on an asset: dropped on a report, reviewed by keys, found again on the asset's record."""

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, asks, stores_mission
from tests.browser.test_accessibility import faults
from tests.results.photos import dji_photo

pytestmark = pytest.mark.browser

PHONE: dict[str, Any] = {"theme": "dark", "size": (390, 844), "touch": True}
READ_MS = 60_000  # three photos, by a worker


def photos_of(page: Page, mission: str, folder: Path, day: int = 1) -> list[Path]:
    """Three photos at the first target's tower, and a file that is no photo."""
    [target, *_] = asks(page, mission)["targets"]
    lon, lat = asks(page, f"/assets/{target['asset']}")["geometry"]["coordinates"]
    paths = [folder / f"DJI_000{number}.JPG" for number in range(3)]
    for number, path in enumerate(paths):
        path.write_bytes(dji_photo(lon, lat, size=(800, 600), UTCAtExposure=f"2026-06-0{day}T08:00:0{number}"))
    (folder / "notes.jpg").write_text("<html>" + " " * 200)
    return [*paths, folder / "notes.jpg"]


def test_photos_are_sent_reviewed_by_keys_and_found_on_their_asset(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.signs_in("opal")
    mission = stores_mission(page, "Photos of two towers")
    page.goto(f"{mission}/report")
    files = page.locator("#report-photos input[type=file]")
    files.set_input_files(photos_of(page, mission, tmp_path))
    expect(page.locator(".photo-facts")).to_have_text("3 files uploaded. 1 failed.")
    expect(page.get_by_role("alert").filter(has_text="notes.jpg")).to_contain_text("none of the supported kinds")
    expect(page.locator("#report-photos .photo-thumb img")).to_have_count(3, timeout=READ_MS)
    files.set_input_files(sorted(tmp_path.glob("DJI*")))
    expect(page.locator(".photo-facts")).to_have_text("3 files uploaded. 1 failed.")  # those that are sent already are not sent again

    page.get_by_role("link", name="Review photos").click()
    expect(page.locator("#review-count")).to_have_text("1 of 3")
    label = asks(page, mission)["targets"][0]["label"]
    expect(page.locator("#review-placement")).to_contain_text(f"{label} Nearest target")
    assert faults(page) == []
    area = page.locator(".review-overlay").bounding_box()
    assert area is not None
    x, y, width, height = area["x"], area["y"], area["width"], area["height"]
    page.mouse.move(x + 0.25 * width, y + 0.25 * height)
    page.mouse.down()
    page.mouse.move(x + 0.5 * width, y + 0.5 * height, steps=3)
    page.mouse.up()
    page.keyboard.press("c")
    page.keyboard.type("ne")
    page.keyboard.press("Enter")
    page.keyboard.press("1")
    expect(page.locator("#review-findings")).to_contain_text("Nest")
    page.keyboard.press("j")
    expect(page.locator("#review-count")).to_have_text("2 of 3")
    page.keyboard.press("x")
    expect(page.locator("#review-count")).to_have_text("3 of 3")
    page.keyboard.press("s")
    expect(page.locator("#review-findings")).to_contain_text("Nest")

    first, second = asks(page, f"/findings?mission={mission.rpartition('/')[2]}")["results"][::-1]
    [mark] = first["evidence"]
    for name, expected in {"x": 200, "y": 150, "width": 200, "height": 150}.items():
        assert mark["shape"][name] == pytest.approx(expected, abs=2), name
    assert (first["severity"], first["asset_label"], second["evidence"][0]["shape"]) == (1, label, None)
    assert {one["review"] for one in asks(page, f"/media?asset={first['asset']}")["results"]} == {"findings", "nothing"}

    page.goto("/assets")
    page.locator("#record-text").fill(label)
    page.get_by_text(label, exact=True).first.click()
    expect(page.locator("#record-show .finding-list li")).to_have_count(2)
    expect(page.locator("#record-show .photo-thumb")).to_have_count(3)
    page.get_by_role("button", name="Look again at 2 findings").click()
    expect(page).to_have_title(re.compile(re.escape(f"Look again: {label}")))
    [again] = asks(page, f"/missions/{page.url.rpartition('/')[2].split('?')[0]}")["targets"]
    assert again["asset"] == first["asset"]
    visitor.complaints[:] = [words for words in visitor.complaints if "422" not in words]  # the file that is no photo


@pytest.mark.long
def test_a_viewer_on_a_phone_sees_photos_and_can_change_nothing(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.signs_in("opal")
    mission = stores_mission(page, "Photos for a viewer")
    page.goto(f"{mission}/report")
    page.locator("#report-photos input[type=file]").set_input_files(photos_of(page, mission, tmp_path, day=2)[:1])
    expect(page.locator("#report-photos .photo-thumb img")).to_have_count(1, timeout=READ_MS)
    page = visitor.signs_in("vera", **PHONE)
    page.goto(f"/review?mission={mission.rpartition('/')[2]}")
    expect(page.locator(".review-image")).to_be_visible()
    assert page.locator("#review-form").is_hidden() and page.locator("#review-nothing").is_hidden()
    assert faults(page) == [] and page.evaluate(TOO_WIDE) == []
    page.goto(f"{mission}/report")
    expect(page.locator("#report-photos .photo-thumb")).to_have_count(1)
    expect(page.locator("#report-photos input[type=file]")).to_have_count(0)


def test_findings_are_listed_worst_first_filtered_worked_on_and_looked_at_again(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    mission = stores_mission(page, "Findings to settle")
    target = asks(page, mission)["targets"][1]  # the tests above make findings at the first
    label, asset = target["label"], target["asset"]
    token = next(one["value"] for one in page.context.cookies() if one["name"] == "csrftoken")
    for severity, due in ((3, "2999-01-01"), (1, "2026-01-02"), (2, "2999-01-01")):
        body = {"category": "tower-corrosion", "severity": severity, "asset": asset, "due_on": due}
        assert page.request.post("/api/v1/findings", data=body, headers={"X-CSRFToken": token}).status == 201
    page.goto("/findings")
    rows = page.locator("#finding-rows tr")
    of_asset = rows.filter(has_text=label)
    expect(of_asset).to_have_count(3)
    expect(of_asset.first).to_contain_text("Danger")
    page.get_by_label("Overdue").check()
    expect(of_asset).to_have_count(1)
    expect(of_asset).to_contain_text("overdue since 2 Jan")
    of_asset.get_by_role("combobox").select_option("work_ordered")
    expect(page.locator("#toasts")).to_contain_text("Work ordered")
    page.reload()
    expect(of_asset.get_by_role("combobox")).to_have_value("work_ordered")
    page.get_by_label("Overdue").uncheck()
    of_asset.nth(0).get_by_role("checkbox").check()
    of_asset.nth(1).get_by_role("checkbox").check()
    expect(page.locator("#chosen-bar")).to_contain_text("2 findings chosen")
    assert faults(page) == []
    page.get_by_role("button", name="Look again at 2 findings").click()
    expect(page).to_have_title(re.compile(re.escape(f"Look again: {label}")))

    page.get_by_role("button", name="Layers").click()
    with page.expect_response(lambda answer: "/findings.geojson" in answer.url and answer.ok):
        page.get_by_role("checkbox", name="Open findings").check()
    page.keyboard.press("Escape")
    expect(page.locator("#legend")).to_contain_text("Findings: danger")
