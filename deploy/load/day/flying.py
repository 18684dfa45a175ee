"""An operator who plans, saves, approves, sends and flies missions with one UAV, and watches each on its page."""

import random
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from typing import Any
from uuid import uuid4

import gevent

from deploy.load.day import book as kinds
from deploy.load.day.client import Browser, GaveUp, trusted
from deploy.load.day.live_page import LivePage
from deploy.load.day.site import Desk

SEEN_WITHIN_S = 300.0  # on the page: that the UAV has its mission, that it flies, that it is down
STALE_SHARE = 0.2  # of edits made from a second window that has not seen the first one's
_numbers = count()


class FlyingOperator(Browser):
    """One at each desk."""

    abstract = True

    def on_start(self) -> None:
        self.desk: Desk = self.site.desks[next(_numbers) % len(self.site.desks)]
        self.name = self.desk.operator
        self.draw = random.Random(self.desk.uav + 1)
        self.flown = 0
        super().on_start()

    def fly_a_mission(self) -> None:
        """From the list of missions to the report of the one that was flown."""
        self.ask("GET", "/", "page: missions")
        self.get("missions?limit=50", "missions: list")
        self.pause()
        body = self.wishes()
        self.ask("GET", "/missions/new", "page: new mission")
        for zoom, column, row in self.site.places[self.site.desks.index(self.desk)]:
            self.look(f"/api/v1/tiles/{zoom}/{column}/{row}", "map: tile")
        plan = {name: body[name] for name in ("uavs", "targets", "return_to_start")}
        self.ask("POST", "/api/v1/plans", "plan: small", plan)
        self.pause()
        mission, tag = self.save(body)
        tag = self.edit(mission, tag)
        self.pause()
        tag = self.approve(mission, tag)
        if not tag:
            return
        page = LivePage(str(self.host), f"/ws/missions/{mission}/live", self.cookies(), trusted(), self.book, self.name)
        watching = gevent.spawn(page.run)
        try:
            self.fly(mission, tag, page)
        finally:
            watching.kill()
        self.ask("GET", f"/missions/{mission}/report", "page: report")
        self.get(f"missions/{mission}/record", "record of a mission")

    def wishes(self) -> dict[str, Any]:
        towers = self.draw.sample(self.desk.towers[:8], self.draw.randint(2, 4))
        self.flown += 1
        return {
            "name": f"Desk {self.desk.uav} {self.flown} {uuid4().hex[:8]}",
            "uavs": [{"id": self.desk.uav, "end_action": "return"}],
            "targets": [{"asset": tower} for tower in towers],
            "return_to_start": True,
        }

    def save(self, body: dict[str, Any]) -> tuple[str, str]:
        """The mission and its ETag."""
        answer = self.ask("POST", "/api/v1/missions", "mission: save and plan", {**body, "plan": True}, ok=(201,))
        made = answer.json()
        self.book.note(kinds.MISSION, id=made["id"], name=made["name"], revision=made["revision"])
        return made["id"], answer.headers["ETag"]

    def edit(self, mission: str, tag: str) -> str:
        """A new name; sometimes from a window that has not seen it, which is told so and takes what is there."""
        path, name = f"/api/v1/missions/{mission}", f"Edited {uuid4().hex[:12]}"
        answer = self.ask("PATCH", path, "mission: edit", {"name": name}, ok=(200, 412), **{"If-Match": tag})
        if answer.status_code == 412:  # the first try was done, and its answer lost
            answer = self.ask("GET", path, "mission: open")
            if answer.json()["name"] != name:
                return str(answer.headers["ETag"])
        self.book.note(kinds.EDIT, mission=mission, revision=answer.json()["revision"], name=name)
        if self.draw.random() < STALE_SHARE:
            self.ask("PATCH", path, "mission: edit, too late", {"name": "Nobody's"}, ok=(412,), **{"If-Match": tag})
        return str(answer.headers["ETag"])

    def approve(self, mission: str, tag: str) -> str:
        """The new ETag; planned again once where the ground has changed since; empty: it may not be flown."""
        path = f"/api/v1/missions/{mission}"
        for again in (True, False):
            answer = self.ask("POST", f"{path}/approve", "mission: approve", {}, ok=(200, 409, 412), **{"If-Match": tag})
            if answer.status_code == 200:
                approval = self.get(f"missions/{mission}/approval", "mission: approval")
                self.book.note(kinds.APPROVAL, mission=mission, approval=approval["id"], sha256=approval["content_sha256"])
                return str(answer.headers["ETag"])
            if again:
                self.ask("POST", f"{path}/plan", "mission: plan again", ok=(200, 409, 503), **{"If-Match": "*"})
                tag = str(self.ask("GET", path, "mission: open").headers["ETag"])
        self.delete_mission(mission)
        return ""

    def fly(self, mission: str, tag: str, page: LivePage) -> None:
        path = f"/api/v1/missions/{mission}"
        self.ask("GET", f"/missions/{mission}/fly", "page: fly")
        sent = self.ask("POST", f"{path}/dispatch", "mission: dispatch", {}, ok=(200, 409), **{"If-Match": tag})
        if sent.status_code == 409:  # the ground has changed in this moment
            self.delete_mission(mission)
            return
        commands = [command["id"] for command in sent.json()["commands"]]
        for command in sent.json()["commands"]:
            self.book.note(kinds.COMMAND, id=command["id"], uav=command["uav"]["id"], kind=command["kind"], key="")
        is_there = self.seen("page sees: loaded", lambda: all(self.state_of(page, key) == "applied" for key in commands))
        if is_there:
            self.pause()
            self.command("start")
            is_there = self.seen("page sees: flown", lambda: page.shown["missions"].get(mission, {}).get("state") == "completed")
        if not is_there:
            self.ask("POST", f"{path}/abort", "mission: abort", {"why": "It takes too long."}, ok=(200, 409))

    def command(self, kind: str) -> None:
        key = str(uuid4())
        answer = self.ask("POST", f"/api/v1/uavs/{self.desk.uav}/commands", "command: start", {"kind": kind}, ok=(201, 409), key=key)
        if answer.status_code == 201:
            self.book.note(kinds.COMMAND, id=answer.json()["id"], uav=self.desk.uav, kind=kind, key=key)

    def state_of(self, page: LivePage, command: str) -> str:
        return str(page.shown["commands"].get(command, {}).get("state", ""))

    def seen(self, name: str, is_so: Callable[[], bool]) -> bool:
        """Whether the page shows it in time."""
        began_s = time.monotonic()
        while not is_so() and time.monotonic() - began_s < SEEN_WITHIN_S:
            gevent.sleep(0.2)
        if not is_so():
            self.blame(name, TimeoutError(f"not in {SEEN_WITHIN_S:.0f} s"))
            return False
        self.note_visible(name, time.monotonic() - began_s)
        return True

    def pause(self) -> None:
        gevent.sleep(self.draw.uniform(1.0, 4.0))

    def fly_or_go_on(self) -> None:
        with suppress(GaveUp):  # it is counted
            self.fly_a_mission()
