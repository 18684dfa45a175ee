"""Gateways are killed, the database goes away, links break: what was received is stored, once."""

import random
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise

import psycopg
import pytest
from django.db import connection

from mavlink.signing import FrameWriter
from telemetry.models import Alert, TelemetryRecord, TelemetryStream, UavLink
from telemetry.selectors.alert_words import alert_words
from tests.telemetry.gateway.program import free_port, gateway_program
from tests.telemetry.gateway.station import Link, gateway_at_work, heartbeat, port_of, position, unsigned_uav, wait_for

pytestmark = pytest.mark.django_db(transaction=True)


def sequences() -> list[int]:
    return list(TelemetryRecord.objects.order_by("measured_at", "pk").values_list("sequence", flat=True))


@contextmanager
def reporting(link: Link, *, every_s: float = 0.02) -> Iterator[list[int]]:
    """A vehicle that reports without end; what it has sent, as times since boot."""
    sent: list[int] = []
    stop = threading.Event()
    booted_s = time.monotonic() - 100

    def run() -> None:
        number = 0
        while not stop.wait(every_s):
            boot_ms = int((time.monotonic() - booted_s) * 1000)
            with suppress(ConnectionError):  # nobody listens; the report is lost
                link.send(*([heartbeat()] if number % 20 == 0 else []), position(boot_ms))
            sent.append(boot_ms)
            number += 1

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield sent
    finally:
        stop.set()
        thread.join()


@pytest.mark.long
def test_a_killed_gateway_loses_no_more_than_what_it_had_not_stored(tmp_path):
    unsigned_uav()
    port = free_port()
    with Link(port) as link, reporting(link) as sent:
        for _ in range(3):
            before = TelemetryRecord.objects.count()
            with gateway_program(port, tmp_path) as program:
                wait_for(lambda before=before: TelemetryRecord.objects.count() > before + 20)
                program.send_signal(signal.SIGKILL)
                program.wait()
        with gateway_program(port, tmp_path) as program:
            last = wait_for(lambda: len(sent) > 0 and sent[-1])
            wait_for(lambda: TelemetryRecord.objects.filter(sequence__gte=last).exists())
            stopped = list(sent)
            wait_for(lambda: TelemetryRecord.objects.filter(sequence__gte=stopped[-1]).exists())
            program.terminate()
            began_s = time.monotonic()
            assert program.wait(15) == 0
            assert time.monotonic() - began_s < 10
    stored = sequences()
    assert stored == sorted(set(stored)), "each once, in order"
    assert TelemetryStream.objects.count() == 1, "the same boot for every run"
    lost = sorted(set(stopped) - set(stored) - {number for number in stopped if number < stored[0]})
    runs = [[lost[0]]] if lost else []
    for earlier, later in pairwise(lost):
        if stopped.index(later) == stopped.index(earlier) + 1:
            runs[-1].append(later)
        else:
            runs.append([later])
    assert len(runs) <= 3, "nothing was lost but around the three kills"
    assert UavLink.objects.get().holder == "", "the last one ended as it should"


def test_the_database_goes_away_and_comes_back(tmp_path):
    unsigned_uav()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as link:
        with reporting(link) as sent:
            wait_for(lambda: TelemetryRecord.objects.count() > 10)
            with database_away():
                wait_for(lambda: gateway.store.is_away)
                wait_for(lambda: len(gateway.store.records) > 50)
        wait_for(lambda: TelemetryRecord.objects.count() == len(sent))
    assert sequences() == sent


@contextmanager
def database_away() -> Iterator[None]:
    """Nobody is connected to the test's database, and nobody can connect."""
    at = connection.settings_dict
    name = at["NAME"]
    server = {"host": at["HOST"], "user": at["USER"], "password": at["PASSWORD"] or None, "port": at["PORT"] or None}
    connection.close()
    with psycopg.connect(**server, dbname="postgres", autocommit=True) as other:
        other.execute(f'ALTER DATABASE "{name}" ALLOW_CONNECTIONS false')
        other.execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = %s", [name])
        try:
            yield
        finally:
            other.execute(f'ALTER DATABASE "{name}" ALLOW_CONNECTIONS true')


def test_what_does_not_fit_is_dropped_the_oldest_first(tmp_path):
    unsigned_uav()
    with gateway_at_work(tmp_path, most_records=30) as gateway, Link(port_of(gateway)) as link:
        with reporting(link, every_s=0.005) as sent:
            wait_for(lambda: TelemetryRecord.objects.count() > 10)
            with database_away():
                wait_for(lambda: gateway.store.lost > 50)
        wait_for(lambda: TelemetryRecord.objects.filter(sequence=sent[-1]).exists())
        assert TelemetryRecord.objects.count() + gateway.store.lost == len(sent)


def test_another_gateway_takes_over_a_vehicle_that_moves_to_it(tmp_path):
    unsigned_uav()
    with gateway_at_work(tmp_path, name="one") as one, gateway_at_work(tmp_path, name="two") as two, Link(port_of(one)) as link:
        with reporting(link, every_s=0.05) as sent:
            wait_for(lambda: UavLink.objects.filter(holder__startswith="one/").exists())
            wait_for(lambda: TelemetryRecord.objects.count() > 10)
            link.socket.connect(("127.0.0.1", port_of(two)))
            wait_for(lambda: UavLink.objects.filter(holder__startswith="two/").exists())
        wait_for(lambda: TelemetryRecord.objects.count() == len(sent))
    assert sequences() == sent
    assert TelemetryStream.objects.count() == 1


def test_two_gateways_that_hear_the_same_store_it_once(tmp_path):
    unsigned_uav()
    with (
        gateway_at_work(tmp_path, name="one") as one,
        gateway_at_work(tmp_path, name="two") as two,
        Link(port_of(one)) as first,
        Link(port_of(two)) as second,
    ):
        for number in range(100):
            frames = [first.frame(message) for message in (heartbeat(), position(1_000 + number * 200))]
            first.send_raw(*frames)
            second.send_raw(*frames)
        wait_for(lambda: TelemetryRecord.objects.count() == 100)
        time.sleep(0.3)  # what is stored twice would come now
    assert sequences() == [1_000 + number * 200 for number in range(100)]
    assert UavLink.objects.count() == 1


def test_of_two_senders_with_one_system_id_the_first_is_kept_and_both_are_named(tmp_path):
    uav = unsigned_uav()
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as link, Link(port_of(gateway)) as other:
        link.send(heartbeat(), position(1_000))
        wait_for(lambda: TelemetryRecord.objects.count() == 1)
        other.send(heartbeat(), position(2_000, lon=20.0))

        def reported():
            link.send(heartbeat())
            other.send(position(2_200, lon=20.0))
            return Alert.objects.filter(uav=uav, code="second-sender", closed_at=None).first()

        alert = wait_for(reported)
        ports = [str(sender.socket.getsockname()[1]) for sender in (link, other)]
    assert TelemetryRecord.objects.count() == 1
    assert all(port in alert_words(alert.message, alert.values) for port in ports)
    assert UavLink.objects.get().losses["second-sender"] >= 1


RATE = 120.0  # the vehicle's seconds a second
REPORTS_HZ = 5.0


@pytest.mark.long
@pytest.mark.parametrize("order", ["kept first", pytest.param("mixed", marks=pytest.mark.long)])
@pytest.mark.parametrize("lost_s", [5, 60, pytest.param(600, marks=pytest.mark.long)])
def test_a_buffering_vehicle_loses_and_doubles_nothing(lost_s, order, tmp_path):
    """Its time runs 120 times as fast. While the link is lost it flies on and keeps its reports; then it sends them, some twice."""
    unsigned_uav()
    chance = random.Random(lost_s)
    frames = FrameWriter(1, 1)
    with gateway_at_work(tmp_path) as gateway, Link(port_of(gateway)) as link:
        booted_s = time.monotonic()

        def boot_ms() -> int:
            return int((time.monotonic() - booted_s) * RATE * 1000)

        sent, kept, at_ms = [], [], 1_000
        lost_from_ms = 700_000
        back_ms = lost_from_ms + lost_s * 1000
        end_ms = back_ms + 200_000
        while at_ms < end_ms:
            while at_ms <= boot_ms():
                report = position(at_ms)
                sent.append(at_ms)
                if lost_from_ms <= at_ms < back_ms:
                    kept.append(report)
                else:
                    link.send_raw(frames.frame_of(report, 0.0))
                    burst = (20 if order == "mixed" else len(kept)) if at_ms >= back_ms else 0
                    for old in [kept.pop(0) for _ in range(min(burst, len(kept)))]:
                        link.send_raw(*[frames.frame_of(old, 0.0)] * (2 if chance.random() < 0.2 else 1))
                if at_ms % 60_000 < 1000 / REPORTS_HZ:
                    link.send_raw(frames.frame_of(heartbeat(is_armed=True), 0.0))
                at_ms += int(1000 / REPORTS_HZ)
            time.sleep(0.002)
        wait_for(lambda: TelemetryRecord.objects.count() >= len(sent))
    assert sorted(sequences()) == sent
    assert TelemetryStream.objects.count() == 1
    kept_part = [number for number in sequences() if lost_from_ms <= number < back_ms]
    assert kept_part == sorted(kept_part)
