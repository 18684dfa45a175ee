"""The reference companion against the real server: it flies on when the link breaks, and nothing is lost or doubled (R4)."""

import random
import socket
import threading
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from examples.companion.client import Companion
from examples.companion.journal import Journal
from examples.companion.kinematic import KinematicAutopilot
from examples.companion.link import Answer, HttpLink, LinkDown
from missions.models import CommandKind, CommandState, Mission, MissionState, TargetState, UavCommand
from missions.services import TargetRequest
from missions.services.commands.dispatch import abort_mission
from planning.task import Task, TaskKind
from telemetry.models import Capture, InspectionResult, TelemetryRecord, UavLink
from telemetry.views.uav_authentication import UavRate
from tests.cases import long
from tests.missions.flights import an_operator, dispatched
from tests.missions.worlds import UAV_AT, World, world
from tests.telemetry.links.simulated_link import Flight, nothing_lost_or_doubled
from tests.telemetry.links.uav_clients import UavClient, linked_uav

pytestmark = pytest.mark.django_db


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def kite() -> UavClient:
    return linked_uav("Kite", is_simulated=True)


@pytest.fixture
def flight(here: World, kite: UavClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Flight:
    """Sent to the UAV, not started: there and back along the line, some minutes."""
    monkeypatch.setattr(UavRate, "THROTTLE_RATES", {"uav-link": None})  # simulated time is fast
    dispatched(an_operator(), [kite.uav], [here.towers[2], here.bridge, here.towers[5]])
    return Flight(kite, tmp_path)


def mission_now() -> Mission:
    return Mission.objects.get()


def test_a_whole_mission_is_flown_over_the_link(flight: Flight) -> None:
    flight.fly(10)
    link = UavLink.objects.get()
    assert (UavCommand.objects.get().state, link.loaded_sha256 != "") == (CommandState.APPLIED, True)
    flight.take_off()
    flight.fly(10)
    assert mission_now().state == MissionState.ACTIVE
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    rows = nothing_lost_or_doubled(flight)
    assert mission_now().state == MissionState.COMPLETED
    assert set(mission_now().targets.values_list("state", flat=True)) == {TargetState.COMPLETE}
    assert InspectionResult.objects.count() == 3
    assert {row.mission_id for row in rows if row.is_in_air} == {mission_now().pk}
    assert not any(row.is_from_future or row.is_late for row in rows)
    polls = [at_s for at_s, what, _ in flight.link.asked if what == "route"]
    assert {later - before for before, later in pairwise(polls)} == {5.0}


@pytest.mark.long
def test_photos_are_reported_once_also_after_a_lost_link(
    here: World, kite: UavClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(UavRate, "THROTTLE_RATES", {"uav-link": None})
    photo = Task(TaskKind.PHOTO, 4.0)
    dispatched(an_operator(), [kite.uav], [TargetRequest(here.towers[2].pk, task=photo), TargetRequest(here.towers[5].pk, task=photo)])
    flight = Flight(kite, tmp_path)
    flight.take_off()
    flight.fly_until(lambda: flight.journal.added("captures") == 1)
    until_s = flight.now_s + 30.0
    flight.link.loses_answers = lambda now_s: now_s < until_s
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    flight.fly(20)
    rows = list(Capture.objects.order_by("taken_at"))
    assert [(row.image_index, row.pitch_deg, row.is_taken) for row in rows] == [(0, -90.0, True), (1, -90.0, True)]
    assert {row.mission_id for row in rows} == {mission_now().pk} and len({row.waypoint_sequence for row in rows}) == 2
    assert flight.journal.waiting("captures", 10) == flight.journal.refused("captures") == []


@pytest.mark.long
@pytest.mark.parametrize("down_s", [5, *long(60, 600)])
@pytest.mark.parametrize("answers_only", [False, True], ids=["no request arrives", "no answer arrives"])
def test_a_uav_without_a_link_flies_on_asks_again_at_once_and_loses_nothing(flight: Flight, down_s: int, answers_only: bool) -> None:
    flight.take_off()
    if down_s == 600:
        flight.give(CommandKind.CHANGE_SPEED, speed_mps=2.0)  # so that it is still in the air after ten minutes
    flight.fly_until(lambda: flight.autopilot.next == 1)
    flight.fly(3)
    down_at_s, before = flight.now_s, flight.autopilot.place

    def is_down(now_s: float) -> bool:
        return down_at_s < now_s <= down_at_s + down_s

    if answers_only:
        flight.link.loses_answers = is_down
    else:
        flight.link.is_down = is_down
    flight.fly(down_s)
    assert (flight.autopilot.mode, flight.autopilot.is_in_air) == ("Mission", True)
    assert flight.autopilot.place != before
    assert not TelemetryRecord.objects.filter(measured_at__gt=datetime.fromtimestamp(down_at_s + 5, UTC)).exists() or answers_only
    flight.fly(10)
    assert flight.first_poll_after(down_at_s + down_s) <= 5.0
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    rows = nothing_lost_or_doubled(flight)
    meanwhile = [row.position.coords for row in rows if down_at_s < row.measured_at.timestamp() <= down_at_s + down_s]
    assert len(meanwhile) >= down_s // 10
    assert len(set(meanwhile)) >= len(meanwhile) / 2  # it moved, but for its tasks
    assert mission_now().state == MissionState.COMPLETED
    assert InspectionResult.objects.count() == 3


@pytest.mark.long
def test_a_link_that_comes_and_goes_loses_nothing(flight: Flight) -> None:
    chance = random.Random(7)
    flight.take_off()
    flight.link.is_down = lambda now_s: chance.random() < 0.3
    flight.link.loses_answers = lambda now_s: chance.random() < 0.3
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    flight.link.is_down = flight.link.loses_answers = lambda now_s: False
    nothing_lost_or_doubled(flight)
    assert mission_now().state == MissionState.COMPLETED
    assert UavCommand.objects.exclude(state=CommandState.APPLIED).count() == 0


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 5))])
def test_a_companion_that_crashes_at_any_request_loses_nothing(flight: Flight, seed: int) -> None:
    """Killed before the request arrives, or after it was stored and before that was noted; then started anew from its file."""
    chance = random.Random(seed)
    ask, crashes = flight.link.ask, 0

    class Killed(BaseException):
        pass

    def deadly(*asked: Any) -> Answer:
        nonlocal crashes
        fate = chance.random()
        if fate < 0.05:
            crashes += 1
            raise Killed
        answer = ask(*asked)
        if fate > 0.95:
            crashes += 1
            raise Killed
        return answer

    flight.link.ask = deadly  # type: ignore[method-assign]
    for second in range(600):
        if second == 20:
            flight.give(CommandKind.START, flight=1)
        try:
            flight.fly(1)
        except Killed:
            flight.journal.close()
            flight.restart()
    flight.link.ask = ask  # type: ignore[method-assign]
    assert crashes >= 5
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    flight.fly(30)
    rows = list(TelemetryRecord.objects.order_by("sequence").values_list("sequence", flat=True))
    assert rows == list(range(1, flight.journal.added("records") + 1))
    assert InspectionResult.objects.count() == 3
    assert mission_now().state == MissionState.COMPLETED


ERRORS = [Answer(500), Answer(503, None, {"retry-after": "2"}), Answer(429, None, {"retry-after": "7"}), Answer(401)]


@pytest.mark.long
@pytest.mark.parametrize("answer", [*ERRORS[1::2], *long(*ERRORS[::2])], ids=lambda answer: str(answer.status))
def test_a_server_that_answers_with_an_error_is_asked_again_and_nothing_is_lost(flight: Flight, answer: Answer) -> None:
    flight.take_off()
    ill_at_s = flight.now_s
    flight.link.instead = lambda what, now_s: answer if now_s <= ill_at_s + 40 else None
    flight.fly(60)
    assert flight.autopilot.is_in_air
    assert flight.first_poll_after(ill_at_s + 41) <= 7.0
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    nothing_lost_or_doubled(flight)


def test_what_the_server_refuses_is_kept_and_holds_up_nothing(flight: Flight) -> None:
    report = flight.autopilot.report
    flight.autopilot.report = lambda now_s: report(now_s) | {"battery_percent": 130.0}  # type: ignore[method-assign]
    flight.fly(25)
    flight.autopilot.report = report  # type: ignore[method-assign]
    flight.fly(25)
    refused = flight.journal.refused("records")
    assert [number for number, _ in refused] == [1, 2, 3]
    assert "battery_percent" in refused[0][1]
    assert TelemetryRecord.objects.count() == flight.journal.added("records") - 3 > 0


def test_what_is_no_number_is_told_as_not_known(flight: Flight) -> None:
    report = flight.autopilot.report
    flight.autopilot.report = lambda now_s: report(now_s) | {"hdop": float("nan")}  # type: ignore[method-assign]
    flight.fly(3)
    assert TelemetryRecord.objects.get().hdop is None


def test_a_uav_is_paused_resumed_and_called_back(flight: Flight) -> None:
    flight.take_off()
    flight.fly_until(lambda: flight.autopilot.next == 1)
    pause = flight.give(CommandKind.PAUSE)
    flight.fly(8)
    place = flight.autopilot.place
    flight.fly(20)
    assert flight.autopilot.place == place
    assert UavCommand.objects.get(pk=pause.pk).state == CommandState.APPLIED
    flight.give(CommandKind.CHANGE_SPEED, speed_mps=4.0)
    flight.give(CommandKind.RESUME)
    flight.fly(10)
    assert (flight.autopilot.speed_mps, flight.autopilot.place != place) == (4.0, True)
    abort_mission(mission=mission_now(), actor=an_operator(), why="test")
    flight.fly_until(lambda: not flight.autopilot.is_in_air)
    flight.fly(20)
    assert mission_now().state == MissionState.ABORTED
    assert set(UavCommand.objects.values_list("state", flat=True)) == {CommandState.APPLIED}
    nothing_lost_or_doubled(flight)


def test_a_command_that_was_overtaken_while_there_was_no_link_is_not_carried_out(flight: Flight) -> None:
    flight.take_off()
    flight.link.is_down = lambda now_s: True
    pause = flight.give(CommandKind.PAUSE)
    flight.fly(20)
    flight.give(CommandKind.RETURN)
    flight.link.is_down = lambda now_s: False
    flight.fly(8)
    assert flight.autopilot.mode == "Return"
    assert UavCommand.objects.get(pk=pause.pk).state == CommandState.EXPIRED


def test_a_refusal_is_told_in_the_autopilots_words(flight: Flight) -> None:
    flight.fly(10)
    pause = flight.give(CommandKind.PAUSE)
    flight.fly(10)
    command = UavCommand.objects.get(pk=pause.pk)
    assert (command.state, command.outcome) == (CommandState.FAILED, "It is not flying.")


def test_a_route_that_came_damaged_is_not_flown(flight: Flight) -> None:
    take = flight.journal.take

    def damaged(given: Any, etag: str) -> None:
        if given:
            given["route"]["content"]["waypoints"][0]["altitude_relative_m"] += 1.0
        take(given, etag)

    flight.journal.take = damaged  # type: ignore[method-assign]
    flight.fly(10)
    assert (UavCommand.objects.get().state, flight.autopilot.held) == (CommandState.FAILED, None)


# --- over real sockets -------------------------------------------------------------------------------------------------------------


@pytest.mark.django_db(transaction=True)
def test_the_companion_works_over_real_http(live_server: Any, here: World, kite: UavClient, tmp_path: Path) -> None:
    dispatched(an_operator(), [kite.uav], [here.towers[1]])
    link, journal = HttpLink(live_server.url, kite.token), Journal(tmp_path / "journal.sqlite")
    companion = Companion(link, journal, KinematicAutopilot((UAV_AT.lon, UAV_AT.lat)))
    begin_s = datetime.now(UTC).timestamp() - 60
    for second in range(30):
        companion.step(begin_s + second)
    assert UavCommand.objects.get().state == CommandState.APPLIED
    assert list(TelemetryRecord.objects.order_by("sequence").values_list("sequence", flat=True)) == [1, 2, 3]
    assert link.ask("GET", "route", None, {"If-None-Match": str(journal.etag)}).status == 304
    assert HttpLink(live_server.url, "spu_wrong").ask("GET", "route").status == 401


def test_a_server_that_never_answers_is_given_up_after_the_timeout() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        link = HttpLink(f"http://127.0.0.1:{silent.getsockname()[1]}", "spu_x", timeout_s=0.2)
        with pytest.raises(LinkDown):
            link.ask("GET", "route")


@pytest.mark.parametrize(
    "stated", [b"", b'HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\n{"a"', b"not http at all\r\n\r\n", b"HTTP/1.1 200 OK\r\n\r\n<html>"]
)
def test_an_answer_that_cannot_be_read_is_none(stated: bytes) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            connection, _ = server.accept()
            with connection:
                connection.recv(4_096)
                connection.sendall(stated)

        thread = threading.Thread(target=answer)
        thread.start()
        with pytest.raises(LinkDown):
            HttpLink(f"http://127.0.0.1:{server.getsockname()[1]}", "spu_x", timeout_s=2.0).ask("GET", "route")
        thread.join(5)


def test_a_token_is_not_taken_along_to_another_server() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, socket.create_server(("127.0.0.1", 0)) as other:
        other.settimeout(0.2)
        there = f"http://127.0.0.1:{other.getsockname()[1]}/api/v1/uav-link/route"

        def answer() -> None:
            connection, _ = server.accept()
            with connection:
                connection.recv(4_096)
                connection.sendall(f"HTTP/1.1 302 Found\r\nLocation: {there}\r\nContent-Length: 0\r\n\r\n".encode())

        thread = threading.Thread(target=answer)
        thread.start()
        assert HttpLink(f"http://127.0.0.1:{server.getsockname()[1]}", "spu_x", timeout_s=2.0).ask("GET", "route").status == 302
        thread.join(5)
        with pytest.raises(TimeoutError):
            other.accept()


@pytest.mark.parametrize("server", ["http://spanwise.example", "ftp://spanwise.example", "spanwise.example"])
def test_a_token_is_not_sent_in_the_clear(server: str) -> None:
    with pytest.raises(ValueError, match="https"):
        HttpLink(server, "spu_x")


def test_a_start_is_not_carried_out_after_a_crash_when_nobody_wants_it_any_more(flight: Flight) -> None:
    """The computer goes out as it takes the command, and on again when somebody stands beside the UAV and there is no link."""

    class Killed(BaseException):
        pass

    def die(*_: Any) -> None:
        raise Killed

    flight.fly(10)
    start, command = flight.give(CommandKind.START, flight=1), flight.autopilot.command
    flight.autopilot.command = die  # type: ignore[method-assign]
    with pytest.raises(Killed):
        flight.fly(10)
    flight.autopilot.command = command  # type: ignore[method-assign]
    flight.restart()
    flight.link.is_down = lambda now_s: True
    flight.fly(60)
    assert not flight.autopilot.is_in_air
    UavCommand.objects.filter(pk=start.pk).update(expires_at=datetime.fromtimestamp(0, UTC))
    flight.link.is_down = lambda now_s: False
    flight.fly(10)
    assert not flight.autopilot.is_in_air and not flight.autopilot.is_armed


def test_a_start_whose_time_is_over_by_the_companions_clock_is_refused(flight: Flight) -> None:
    flight.fly(10)
    start = flight.give(CommandKind.START, flight=1)
    flight.now_s += 7_200.0
    flight.fly(10)
    start.refresh_from_db()
    assert (start.state, flight.autopilot.is_in_air) == (CommandState.FAILED, False), start.outcome
    assert "too late" in start.outcome
