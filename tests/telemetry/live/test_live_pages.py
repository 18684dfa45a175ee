"""What live pages are told, through the real front door."""

import pytest

from telemetry.services import store_records
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from tests.telemetry.live.page import Page
from tests.telemetry.records import record
from tests.workspace.live.proxied_site import Endpoint

pytestmark = pytest.mark.django_db(transaction=True)


def test_a_page_is_told_everything_and_then_what_changes(here: Endpoint) -> None:
    uav = a_uav("Tern")
    store_records([record(uav, 1, battery_percent=80.0)])
    page = Page(here.open("/ws/live", user=a_user()))
    first = page.take()
    assert (first["type"], first["sequence"]) == ("snapshot", 1)
    assert page.shows["uavs"][uav.pk]["measured"]["battery_percent"] == 80.0
    store_records([record(uav, 2, longitude_deg=10.5)])
    reported = page.take_until(lambda page: page.sequence == 2 and page.shows["uavs"][uav.pk]["measured"])
    assert (reported["position"], reported["battery_percent"]) == ([10.5, 55.0], 80.0)
    assert reported["measured_at_of"]["battery"] < reported["measured_at_of"]["position"] == reported["measured_at"]
