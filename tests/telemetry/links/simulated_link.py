"""A companion's link to the real server, within one process and in simulated time, that breaks when a test says so."""

import json
from collections.abc import Callable
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

from django.test import Client

from examples.companion.client import Companion
from examples.companion.journal import Journal
from examples.companion.kinematic import KinematicAutopilot
from examples.companion.link import Answer, LinkDown
from missions.models import Approval, CommandKind, Mission, Uav
from missions.services.commands.outbox import queue_command
from telemetry.models import TelemetryRecord
from tests.missions.worlds import UAV_AT
from tests.telemetry.links.uav_clients import LINK, UavClient

LONG_AGO_S = 3_600.0  # simulated time begins so long before now, so that nothing comes from the future


class SimulatedLink:
    """`is_down(now_s)`: no request arrives. `loses_answers(now_s)`: requests arrive, answers do not. `answers`: what comes instead."""

    def __init__(self, uav: UavClient) -> None:
        self._uav, self._client = uav, Client(raise_request_exception=False)
        self.now_s = 0.0
        self.is_down: Callable[[float], bool] = lambda now_s: False
        self.loses_answers: Callable[[float], bool] = lambda now_s: False
        self.instead: Callable[[str, float], Answer | None] = lambda what, now_s: None
        self.asked: list[tuple[float, str, bool]] = []  # when, what, whether an answer came

    def ask(self, method: str, what: str, body: Any = None, headers: dict[str, str] | None = None) -> Answer:
        down, lost = self.is_down(self.now_s), self.loses_answers(self.now_s)
        self.asked.append((self.now_s, what, not down and not lost))
        if down:
            raise LinkDown("no network")
        if (other := self.instead(what, self.now_s)) is not None:
            return other
        options: dict[str, Any] = {"headers": {**self._uav.headers, **(headers or {})}}
        if body is not None:
            options |= {"data": json.dumps(body), "content_type": "application/json"}
        response = getattr(self._client, method.lower())(f"{LINK}/{what}", **options)
        if lost:
            raise LinkDown("the answer was lost")
        content = json.loads(response.content) if response.content and response.status_code == 200 else None
        return Answer(response.status_code, content, {name.lower(): value for name, value in response.items()})


class Flight:
    """A companion on its UAV, its autopilot, its link and its journal; `restart` is a crash: only file and autopilot outlive it."""

    def __init__(self, uav: UavClient, folder: Path) -> None:
        self.uav, self._path = uav, folder / "journal.sqlite"
        self.autopilot = KinematicAutopilot((UAV_AT.lon, UAV_AT.lat))
        self.link = SimulatedLink(uav)
        self.now_s = self.link.now_s = self.begin_s = datetime.now(UTC).timestamp() - LONG_AGO_S
        self.restart()

    def restart(self) -> None:
        self.journal = Journal(self._path)
        self.companion = Companion(self.link, self.journal, self.autopilot)

    def fly(self, seconds: float) -> None:
        """A step a second."""
        for _ in range(int(seconds)):
            self.now_s += 1.0
            self.link.now_s = self.now_s
            self.companion.step(self.now_s)

    def fly_until(self, happened: Callable[[], bool], *, most_s: int = 3_000) -> None:
        for _ in range(most_s):
            if happened():
                return
            self.fly(1)
        raise AssertionError(f"did not happen in {most_s} s")

    def give(self, kind: CommandKind, **parameters: Any) -> Any:
        mission = Mission.objects.get()
        return queue_command(
            uav=self.uav.uav, kind=kind, actor=None, mission=mission, approval=Approval.objects.get(), parameters=parameters
        )

    def take_off(self) -> None:
        """The mission was sent; it is started, and the UAV is on its way."""
        self.fly(10)
        self.give(CommandKind.START, flight=1)
        self.fly_until(lambda: self.autopilot.is_in_air, most_s=20)

    def first_poll_after(self, seconds: float) -> float:
        """How long after this time the UAV asked and was answered."""
        return min(at_s for at_s, what, answered in self.link.asked if what == "route" and answered and at_s >= seconds) - seconds


def nothing_lost_or_doubled(flight: Flight) -> list[TelemetryRecord]:
    """Every record that was ever made is stored exactly once, at the time at which it was measured."""
    flight.fly(30)
    made = flight.journal.added("records")
    rows = list(TelemetryRecord.objects.filter(uav=Uav.objects.get(pk=flight.uav.uav.pk)).order_by("sequence"))
    assert [row.sequence for row in rows] == list(range(1, made + 1))
    assert {row.stream.key for row in rows} == {flight.journal.stream}
    assert flight.journal.waiting("records", 1) == []
    assert flight.journal.refused("records") == []
    times = [row.measured_at.timestamp() - flight.begin_s for row in rows]
    assert all(9.0 <= later - before <= 11.0 for before, later in pairwise(times)), times
    return rows
