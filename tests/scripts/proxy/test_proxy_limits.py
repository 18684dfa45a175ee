"""What nginx refuses of one network address, and what it does not."""

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from scripts.places import WEB_PROGRAMS, CannotStart, Places
from scripts.proxy.proxy import configuration
from tests.scripts.proxy.served_site import application_at, fetch, served_site

MISSION = "/api/v1/missions/0b0c6f6c-7a53-4d0e-a6a6-0a4c3d6b0c11"
COSTLY = ["/api/schema", "/api/v1/tiles/10/530/340", "/api/v1/scene?bbox=7,50,7.1,50.1", f"{MISSION}/record.zip",
          f"{MISSION}/telemetry.csv", "/api/v1/uavs/3/telemetry.gpx", "/api/v1/uavs/3/flight-logs/4/file"]  # fmt: skip
CHEAP = ["/api/v1/missions", MISSION, f"{MISSION}/record", "/api/v1/uav-link/route", "/", "/readyz"]


@pytest.fixture
def site(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The proxy's address, for as many operators behind one address as the parameter says."""
    monkeypatch.delenv("SPANWISE_OPERATORS_PER_ADDRESS", raising=False)
    if request.param is not None:
        monkeypatch.setenv("SPANWISE_OPERATORS_PER_ADDRESS", request.param)
    monkeypatch.setenv("SPANWISE_HTTPS", "1")  # a proxy in front names the visitor
    with served_site() as (address, folder), application_at(folder / f"{WEB_PROGRAMS[0]}.sock"):
        yield address


def statuses(site: str, paths: list[str], visitor: str) -> list[int]:
    with ThreadPoolExecutor(16) as pool:
        headers = {"X-Forwarded-For": visitor, "X-Forwarded-Proto": "https"}
        return list(pool.map(lambda path: fetch(site + path, headers=headers)[0], paths))


@pytest.mark.parametrize("site", ["1"], indirect=True)
@pytest.mark.parametrize("path", COSTLY)
def test_an_address_that_asks_too_much_is_refused_and_others_are_not(site: str, path: str) -> None:
    found = statuses(site, [path] * 100, "192.0.2.7")
    assert set(found) == {200, 429}
    assert statuses(site, CHEAP, "192.0.2.7") == [200] * len(CHEAP)
    assert statuses(site, [path], "192.0.2.8") == [200]


@pytest.mark.parametrize("site", ["1"], indirect=True)
def test_a_refusal_has_the_common_shape_and_says_when_to_ask_again(site: str) -> None:
    statuses(site, ["/api/schema"] * 20, "192.0.2.7")
    status, headers, body = fetch(f"{site}/api/schema", headers={"X-Forwarded-For": "192.0.2.7", "X-Forwarded-Proto": "https"})
    assert (status, headers["Retry-After"], json.loads(body)["error"]["code"]) == (429, "5", "throttled")


@pytest.mark.parametrize("site", ["1"], indirect=True)
def test_nobody_is_somebody_else_by_naming_addresses_or_by_another_address_of_their_ipv6_network(site: str) -> None:
    assert 429 in statuses(site, ["/api/schema"] * 20, "192.0.2.7")
    assert statuses(site, ["/api/schema"], "198.51.100.9, 192.0.2.7") == [429]
    assert 429 in statuses(site, ["/api/schema"] * 20, "2001:db8:1:2:3::1")
    assert statuses(site, ["/api/schema"], "198.51.100.9, 2001:db8:1:2:ffff::9") == [429]
    assert statuses(site, ["/api/schema"], "2001:db8:1:3:3::1") == [200]


@pytest.mark.long
@pytest.mark.parametrize("site", [None], indirect=True)
def test_fifty_operators_behind_one_address_work_at_once(site: str) -> None:
    """Each opens a map (30 tiles), a 3D view and the document, and exports two files."""
    asked = [f"/api/v1/tiles/10/{column}/340" for column in range(30)] + COSTLY[2:3] + COSTLY[:1] + COSTLY[3:5]
    assert statuses(site, asked * 50, "192.0.2.7") == [200] * len(asked) * 50


@pytest.mark.parametrize("site", ["0"], indirect=True)
def test_a_site_whose_visitors_have_no_addresses_of_their_own_sets_no_limits_by_address(site: str) -> None:
    assert statuses(site, ["/api/schema"] * 60, "192.0.2.7") == [200] * 60


@pytest.mark.parametrize("wrong", ["many", "-1"])
def test_what_is_no_number_of_operators_is_refused(wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPANWISE_OPERATORS_PER_ADDRESS", wrong)
    with pytest.raises(CannotStart, match="SPANWISE_OPERATORS_PER_ADDRESS"):
        configuration(Places(tmp_path), tmp_path, 8000)
