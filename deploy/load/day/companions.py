"""Companion computers: each reports every second in batches, asks what to fly every 5 s, flies it and tells what it found.

As docs/uav-link.md asks of them: a record is numbered when it is measured and kept until it was answered. A few batches are sent twice, as
after a lost answer, and a few after the next one.
"""

import random
import time
from datetime import UTC, datetime
from itertools import count
from typing import Any
from uuid import uuid4

import gevent

from deploy.load.day import book as kinds
from deploy.load.day.client import Bearer, GaveUp
from deploy.load.day.site import Desk
from examples.companion.content import content_sha256

RECORD_INTERVAL_S, REPORT_INTERVAL_S, POLL_INTERVAL_S = 1.0, 10.0, 5.0
FLIGHT_S = 40.0
TWICE, LATE = 0.03, 0.03  # of batches
MAX_CONCURRENT = 500
_numbers = count()


class Companion(Bearer):
    """The on-board computer of one desk's UAV."""

    abstract = True

    def on_start(self) -> None:
        self.desk: Desk = self.site.desks[next(_numbers) % len(self.site.desks)]
        self.token = self.desk.token
        self.stream = f"day-{uuid4().hex[:12]}"
        self.draw = random.Random(self.desk.uav)
        self.sequence = self.result_sequence = 0
        self.journal: list[dict[str, Any]] = []
        self.held_back: list[dict[str, Any]] = []
        self.tag = ""
        self.loaded: dict[str, Any] | None = None
        self.lands_at_s = 0.0
        self.flying: dict[str, Any] | None = None
        self.record_at_s = self.poll_at_s = time.monotonic()
        self.report_at_s = self.record_at_s + self.draw.uniform(0.0, REPORT_INTERVAL_S)

    def step(self) -> None:
        """What is due now, and a short sleep."""
        now_s = time.monotonic()
        while self.record_at_s <= now_s:
            self.record_at_s += RECORD_INTERVAL_S
            self.measure()
        try:
            if now_s >= self.poll_at_s:
                self.poll_at_s = now_s + POLL_INTERVAL_S
                self.poll()
            if self.flying is not None and now_s >= self.lands_at_s:
                self.report_results()
            if now_s >= self.report_at_s:
                self.report_at_s = now_s + REPORT_INTERVAL_S
                self.report()
        except GaveUp:
            pass  # it is counted; everything is kept and sent again
        gevent.sleep(max(0.05, min(self.record_at_s, self.poll_at_s, self.report_at_s) - time.monotonic()))

    def measure(self) -> None:
        self.sequence += 1
        lon, lat = self.desk.position
        is_flying = self.flying is not None
        self.journal.append({
            "sequence": self.sequence, "measured_at": datetime.now(UTC).isoformat(), "position": [lon + self.sequence % 100 * 1e-6, lat],
            "altitude_relative_m": 30.0 if is_flying else 0.0, "battery_percent": 80.0, "mode": "mission" if is_flying else "hold",
            "is_armed": is_flying, "is_in_air": is_flying,
        })  # fmt: skip

    def report(self) -> None:
        sent = self.journal[:MAX_CONCURRENT]
        chance = self.draw.random()
        if chance < LATE and not self.held_back:
            self.held_back, self.journal = sent, self.journal[len(sent) :]
            return
        self.send(sent)
        if chance > 1.0 - TWICE:
            self.send(sent)
        self.journal = self.journal[len(sent) :]
        if self.held_back:
            self.send(self.held_back)
            self.held_back = []

    def send(self, records: list[dict[str, Any]]) -> None:
        if not records:
            return
        answer = self.ask("POST", "/api/v1/uav-link/telemetry", "companion: records", {"stream": self.stream, "records": records}).json()
        if answer["refused"] or answer["stored"] + answer["known"] != len(records):
            self.blame("companion: records", AssertionError(f"sound records were refused: {answer['refused'][:1]}"))
            return
        self.book.note(kinds.RECORDS, uav=self.desk.uav, stream=self.stream, sequences=[record["sequence"] for record in records])

    def poll(self) -> None:
        headers = {"If-None-Match": self.tag} if self.tag else {}
        answer = self.ask("GET", "/api/v1/uav-link/route", "companion: asks", ok=(200, 204, 304), **headers)
        if answer.status_code == 304:
            return
        self.tag = answer.headers.get("ETag", "")
        if answer.status_code == 200:
            given = answer.json()
            for command in given["commands"]:
                self.carry_out(command, given["route"])

    def carry_out(self, command: dict[str, Any], route: dict[str, Any] | None) -> None:
        reported: dict[str, Any] = {"command": command["id"], "state": "applied"}
        if command["kind"] == "upload-mission":
            if route is None or route["command"] != command["id"]:
                return
            self.loaded = route
            reported["content_sha256"] = content_sha256(route["content"])
        elif command["kind"] == "start":
            self.flying, self.lands_at_s = self.loaded, time.monotonic() + FLIGHT_S
        elif command["kind"] in {"abort", "return", "land", "clear-mission"}:
            self.flying = None
        answer = self.ask("POST", "/api/v1/uav-link/acknowledgements", "companion: done", {"acknowledgements": [reported]}).json()
        if answer["results"][0]["noted"]:
            self.book.note(kinds.COMMAND_END, id=command["id"], state=answer["results"][0]["state"])

    def report_results(self) -> None:
        """Of each target, and that the flight is over; asked again as it was until it is answered."""
        route = self.flying
        if route is None:
            return
        if "told" not in route:
            results = []
            for target in route["targets"]:
                self.result_sequence += 1
                results.append({
                    "sequence": self.result_sequence, "approval": route["approval"], "place": target["place"], "outcome": "complete",
                    "measured_at": datetime.now(UTC).isoformat(), "note": "seen",
                })  # fmt: skip
            flight = {"approval": route["approval"], "flight": route["content"]["flight"], "outcome": "flown"}
            route["told"] = {"stream": self.stream, "results": results, "flights": [flight]}
        answer = self.ask("POST", "/api/v1/uav-link/results", "companion: results", route["told"]).json()
        reported, self.flying = route["told"], None
        if answer["refused"] or answer["refused_flights"]:
            refused = f"refused: {answer['refused'][:1]} {answer['refused_flights'][:1]}"
            self.blame("companion: results", AssertionError(refused))
            return
        sequences = [result["sequence"] for result in reported["results"]]
        self.book.note(kinds.RESULTS, uav=self.desk.uav, stream=self.stream, sequences=sequences)
        self.book.note(kinds.FLIGHT, uav=self.desk.uav, approval=route["approval"], flight=reported["flights"][0]["flight"])
