"""The companion itself: what is done when. It reads no clock and never sleeps: whoever runs it calls `step` about once a second.

Nothing that was measured is forgotten before the server has answered that it is stored. A request whose answer was lost is sent
again as it was; by stream and number the server knows what it has. The autopilot flies on whatever the link does. But nothing is set in
motion that the server does not want at this moment: after a crash somebody may stand beside the UAV.
"""

import math
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

from examples.companion.autopilot import Autopilot, Refused
from examples.companion.content import content_sha256
from examples.companion.journal import DONE, OPEN, UNDER_WAY, Journal
from examples.companion.link import Answer, Link, LinkDown

RECORDS_AT_ONCE, RESULTS_AT_ONCE, ACKNOWLEDGEMENTS_AT_ONCE, CAPTURES_AT_ONCE = 500, 20, 50, 100
TIMEOUT_S = 60.0  # after which a command that is not seen to be done has failed
SETS_IN_MOTION = {"arm", "take-off", "start", "resume"}
LATER = {408, 425, 429}  # try again; 5xx likewise


class Companion:
    """`step` never raises for what the link or the server do."""

    def __init__(
        self,
        link: Link,
        journal: Journal,
        autopilot: Autopilot,
        *,
        poll_every_s: float = 5.0,
        report_every_s: float = 10.0,
        notify: Callable[[str], None] = lambda words: None,
    ) -> None:
        self._link, self._journal, self._autopilot, self._notify = link, journal, autopilot, notify
        self._poll_every_s, self._report_every_s = poll_every_s, report_every_s
        self._poll_at_s = self._report_at_s = 0.0
        self._wait_until_s = 0.0  # the server asked for it
        self._is_up = False
        self._asked_at_s = -math.inf  # and answered: what waits was wanted then
        self._begun_at_s: dict[str, float] = {}

    def step(self, now_s: float) -> None:
        """`now_s` is Unix time [s]."""
        self._note_events(now_s)
        if now_s >= self._report_at_s:
            self._report_at_s = now_s + self._report_every_s
            self._journal.add_record({"measured_at": _time(now_s), **self._autopilot.report(now_s)})
        if now_s >= max(self._poll_at_s, self._wait_until_s):
            self._poll_at_s = now_s + self._poll_every_s
            self._is_up = self._poll(now_s)
        self._carry_out(now_s)
        if self._is_up and now_s >= self._wait_until_s:
            self._is_up = self._send_all(now_s)

    # --- what the server gives ---

    def _poll(self, now_s: float) -> bool:
        etag = self._journal.etag
        answer = self._ask(now_s, "GET", "route", headers={"If-None-Match": etag} if etag else {})
        if answer is None:
            return False
        if answer.status in {200, 204}:
            self._journal.take(answer.body, answer.headers.get("etag", ""))
        if answer.status not in {200, 204, 304}:
            return False
        self._asked_at_s = now_s
        return True

    def _carry_out(self, now_s: float) -> None:
        for command, state in self._journal.commands():
            key = command["id"]
            if state == OPEN:
                self._journal.move_command(key, UNDER_WAY, {"command": key, "state": "acknowledged"})
            try:
                if state == OPEN or key not in self._begun_at_s:  # also after a crash: it sets a state, so once more changes nothing
                    if not self._is_wanted(command, now_s):
                        continue
                    self._begun_at_s[key] = now_s
                    if self._begin(command, now_s):
                        continue
                if self._autopilot.has_done(command["kind"], now_s):
                    self._end(key, {"state": "applied"})
                elif now_s - self._begun_at_s[key] > TIMEOUT_S:
                    self._end(key, {"state": "failed", "reason": f"Not seen to be done in {TIMEOUT_S:.0f} s."})
            except Refused as error:
                self._end(key, {"state": "failed", "reason": str(error)[:500]})

    def _is_wanted(self, command: dict[str, Any], now_s: float) -> bool:
        """Whether to begin it now. Raises Refused for what came too late."""
        if command["kind"] not in SETS_IN_MOTION:
            return True
        if command["expires_at"] is not None and datetime.fromisoformat(command["expires_at"]).timestamp() <= now_s:
            raise Refused("It came too late: nobody may expect it any more.")
        return now_s - self._asked_at_s < self._poll_every_s

    def _begin(self, command: dict[str, Any], now_s: float) -> bool:
        """Whether it has ended at once."""
        key, kind = command["id"], command["kind"]
        if kind == "upload-mission":
            route = (self._journal.given or {}).get("route")
            if route is None or route["command"] != key:
                raise Refused("Another mission was given in the meantime.")
            if content_sha256(route["content"]) != route["content_sha256"]:
                raise Refused("What came is not what was approved.")
            held = self._autopilot.load(route["content"], now_s)
            self._journal.keep("flies", {"approval": route["approval"], "flight": route["content"]["flight"]})
            self._end(key, {"state": "applied", "content_sha256": content_sha256(held)})
            return True
        if kind == "clear-mission":
            self._autopilot.clear(now_s)
            self._end(key, {"state": "applied"})
            return True
        self._autopilot.command(kind, command["parameters"], now_s)
        return False

    def _end(self, key: str, what: dict[str, Any]) -> None:
        self._journal.move_command(key, DONE, {"command": key} | what)
        self._begun_at_s.pop(key, None)

    # --- what the server is told ---

    def _note_events(self, now_s: float) -> None:
        events = self._autopilot.events(now_s)
        for taken_s, photo in events.photos:
            self._journal.add_capture({"taken_at": _time(taken_s), **photo})
        flies = self._journal.kept("flies")
        if flies is None:
            return
        for place, outcome, note in events.targets:
            self._journal.add_result(
                {"approval": flies["approval"], "place": place, "outcome": outcome, "measured_at": _time(now_s), "note": note}
            )
        if events.flight_ended is not None:
            self._journal.add_flight(flies | {"outcome": events.flight_ended})

    def _send_all(self, now_s: float) -> bool:
        """Whether the link is still there; what is short and urgent goes first."""
        return self._send_acknowledgements(now_s) and self._send_records(now_s) and self._send_results(now_s) and self._send_photos(now_s)

    def _send_acknowledgements(self, now_s: float) -> bool:
        while waiting := self._journal.waiting("acknowledgements", ACKNOWLEDGEMENTS_AT_ONCE):
            body = {"acknowledgements": [entry for _, entry in waiting]}
            answer = self._ask(now_s, "POST", "acknowledgements", body)
            if answer is None or answer.status != 200:
                return False
            self._journal.reported("acknowledgements", [number for number, _ in waiting])
        return True

    def _send_records(self, now_s: float) -> bool:
        while waiting := self._journal.waiting("records", RECORDS_AT_ONCE):
            records = [{"sequence": number, **record} for number, record in waiting]
            answer = self._ask(now_s, "POST", "telemetry", {"stream": self._journal.stream, "records": records})
            if answer is None or answer.status != 200:
                return False
            self._settle("records", [number for number, _ in waiting], answer)
        return True

    def _send_photos(self, now_s: float) -> bool:
        while waiting := self._journal.waiting("captures", CAPTURES_AT_ONCE):
            captures = [{"sequence": number, **capture} for number, capture in waiting]
            answer = self._ask(now_s, "POST", "captures", {"stream": self._journal.stream, "captures": captures})
            if answer is None or answer.status != 200:
                return False
            self._settle("captures", [number for number, _ in waiting], answer)
        return True

    def _send_results(self, now_s: float) -> bool:
        while True:
            waiting, flights = self._journal.waiting("results", RESULTS_AT_ONCE), self._journal.waiting("flights", RESULTS_AT_ONCE)
            if not waiting and not flights:
                return True
            results = [{"sequence": number, **result} for number, result in waiting]
            body = {"stream": self._journal.stream, "results": results, "flights": [flight for _, flight in flights]}
            answer = self._ask(now_s, "POST", "results", body)
            if answer is None or answer.status != 200:
                return False
            self._settle("results", [number for number, _ in waiting], answer)
            self._journal.reported("flights", [number for number, _ in flights])

    def _settle(self, table: str, numbers: list[int], answer: Answer) -> None:
        faults = {numbers[refused["index"]]: refused["faults"] for refused in answer.body["refused"]}
        for number, fault in faults.items():
            self._notify(f"the server refuses number {number} of {table}: {fault}")
        self._journal.refuse(table, faults)
        self._journal.reported(table, [number for number in numbers if number not in faults])

    def _ask(self, now_s: float, method: str, what: str, body: Any = None, headers: dict[str, str] | None = None) -> Answer | None:
        """None where there was no answer, or one that says to come later."""
        try:
            answer = self._link.ask(method, what, body, headers)
        except LinkDown as error:
            self._notify(f"no link: {error}")
            return None
        if answer.status >= 500 or answer.status in LATER:
            self._wait_until_s = now_s + _seconds(answer.headers.get("retry-after"))
            self._notify(f"{what}: the server answers {answer.status}")
            return None
        if answer.status >= 400:
            self._notify(f"{what}: the server answers {answer.status}; kept, and sent again")
        return answer


def _seconds(retry_after: str | None) -> float:
    return min(float(retry_after), 60.0) if retry_after and retry_after.isdigit() else 0.0


def _time(now_s: float) -> str:
    return datetime.fromtimestamp(now_s, UTC).isoformat(timespec="milliseconds")
