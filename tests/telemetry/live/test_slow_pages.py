"""A page that is slow is told the latest, and costs nobody else anything."""

import json
import time

import pytest

from telemetry.live.reader import Reader, SaysNonsense
from telemetry.services import store_records
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from tests.telemetry.live.page import Page
from tests.telemetry.records import record
from tests.workspace.live.proxied_site import Endpoint

LAST = 30


def a_reader() -> Reader:
    reader = Reader(1, None, "en")
    reader.begin()
    return reader


def test_a_reader_has_two_unconfirmed_messages_at_most_and_then_the_latest_of_each_object() -> None:
    reader = a_reader()
    assert reader.take() == (1, None)
    reader.note([("uavs", "1")])
    assert reader.is_due
    assert reader.take() == (2, frozenset({("uavs", "1")}))
    for _ in range(1_000):
        reader.note([("uavs", "1"), ("uavs", "2")])
        assert not reader.is_due
    reader.confirm(1)
    assert reader.is_due
    assert reader.take() == (3, frozenset({("uavs", "1"), ("uavs", "2")}))
    assert not reader.is_due


def test_a_reader_that_has_lost_count_is_given_everything_but_not_all_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now_s)
    reader = a_reader()
    reader.take()
    reader.note([("uavs", "1")])
    reader.take()
    reader.again()
    assert not reader.is_due
    now_s += 1.0
    assert reader.is_due
    assert reader.take() == (3, None)
    with pytest.raises(SaysNonsense):
        reader.confirm(4)


@pytest.mark.long
@pytest.mark.django_db(transaction=True)
def test_a_page_that_confirms_nothing_is_told_twice_and_in_the_end_the_latest_alone(here: Endpoint) -> None:
    uavs = [a_uav("Tern"), a_uav("Gull")]
    store_records([record(uav, 1) for uav in uavs])
    quick, slow = Page(here.open("/ws/live", user=a_user())), Page(here.open("/ws/live", user=a_user()))
    quick.take(), slow.receive()
    for second in range(2, LAST + 1):
        store_records([record(uav, second, longitude_deg=10.0 + second / 100) for uav in uavs])
        quick.take_until(lambda page, second=second: page.shows["uavs"][uavs[1].pk]["measured"]["position"][0] == 10.0 + second / 100)
    slow.receive()
    assert slow.sequence == 2
    assert slow.shows["uavs"][uavs[0].pk]["measured"]["position"][0] < 10.0 + LAST / 100
    slow.report({"type": "ack", "sequence": 1})
    slow.receive()
    assert slow.sequence == 3
    assert slow.shows == quick.shows
    slow.report({"type": "ack", "sequence": 3})
    slow.socket.settimeout(1.5)
    with pytest.raises(Exception, match="timed out"):
        slow.receive()


@pytest.mark.long
@pytest.mark.django_db(transaction=True)
def test_a_page_that_asks_again_is_whole_again(here: Endpoint) -> None:
    uav = a_uav("Tern")
    store_records([record(uav, 1)])
    page = Page(here.open("/ws/live", user=a_user()))
    page.take()
    store_records([record(uav, 2, longitude_deg=10.5)])
    lost = json.loads(page.socket.recv())  # between here and there
    assert lost["type"] == "changes"
    page.report({"type": "resync"})
    answer = page.take()
    assert (answer["type"], answer["sequence"]) == ("snapshot", 3)
    assert page.shows["uavs"][uav.pk]["measured"]["position"] == [10.5, 55.0]
    store_records([record(uav, 3, longitude_deg=10.6)])
    page.take_until(lambda page: page.shows["uavs"][uav.pk]["measured"]["position"] == [10.6, 55.0])
