"""People at their screens: who plans, who watches, who leads a shift, who keeps zones and people in order; and programs."""

import random
from contextlib import suppress
from itertools import count
from typing import Any, ClassVar
from uuid import uuid4

import gevent

from deploy.load.day import book as kinds
from deploy.load.day.client import Bearer, Browser, GaveUp, trusted
from deploy.load.day.live_page import LivePage

JOB_INTERVAL_S, JOB_WITHIN_S = 1.0, 180.0
LARGE_PLAN = 16  # targets: above 12 a worker plans
_turns = count()


class Person(Browser):
    """Somebody of a role; people of one role take their names in turn. With `watches` a live page stays open all day."""

    abstract = True
    role = "viewer"
    watches = False
    _takers: ClassVar[dict[str, Any]] = {}

    def on_start(self) -> None:
        names = self.site.users_with_role(self.role)
        taken = Person._takers.setdefault(self.role, count(len(self.site.desks) if self.role == "operator" else 0))
        self.name = names[next(taken) % len(names)]
        self.draw = random.Random(next(_turns))
        super().on_start()
        if self.watches:
            self.ask("GET", "/live", "page: live")
            page = LivePage(str(self.host), "/ws/live", self.cookies(), trusted(), self.book, self.name)
            self.page, self.watching = page, gevent.spawn(page.run)

    def on_stop(self) -> None:
        if self.watches:
            self.watching.kill()

    def tiles(self) -> None:
        for zoom, column, row in self.draw.choice(self.site.places):
            self.look(f"/api/v1/tiles/{zoom}/{column}/{row}", "map: tile")

    def missions(self) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = self.get("missions?limit=50", "missions: list")["results"]
        return found

    def list_missions(self) -> None:
        self.ask("GET", "/", "page: missions")
        self.get("missions/filters", "missions: filters")
        self.missions()

    def open_mission(self) -> None:
        found = self.missions()
        if found:
            mission = self.draw.choice(found)["id"]
            self.ask("GET", f"/missions/{mission}", "page: mission", ok=(200, 404))
            self.look(f"/api/v1/missions/{mission}", "mission: open", ok=(200, 304, 404))  # somebody else may just have deleted it
            self.tiles()

    def wishes(self, targets: int, uavs: int = 1) -> dict[str, Any]:
        """UAVs of no fleet at one of the places, and towers there."""
        desk = self.draw.choice(self.site.desks)
        lon, lat = desk.position
        towers = [*desk.towers, *self.draw.sample(self.site.towers, max(0, targets - len(desk.towers)))]
        return {
            "uavs": [{"name": f"UAV {number + 1}", "position": [lon + number * 1e-3, lat]} for number in range(uavs)],
            "targets": [{"asset": tower} for tower in self.draw.sample(towers, targets)],
            "return_to_start": False,
        }


class PlansMissions(Person):
    """An operator at the drawing board."""

    abstract = True
    role = "operator"

    def plan_small(self) -> None:
        self.ask("GET", "/missions/new", "page: new mission")
        self.tiles()
        self.get("assets?kind=tower&text=1&limit=20", "assets: find")
        self.ask("POST", "/api/v1/plans", "plan: small", self.wishes(self.draw.randint(3, 8), 2))

    def plan_large(self) -> None:
        answer = self.ask("POST", "/api/v1/plans", "plan: large", self.wishes(LARGE_PLAN, 3), ok=(202,))
        job = answer.json()["job"]
        self.book.note(kinds.JOB, id=job)
        waited_s = 0.0
        while waited_s < JOB_WITHIN_S:
            gevent.sleep(JOB_INTERVAL_S)
            waited_s += JOB_INTERVAL_S
            reported = self.get(f"jobs/{job}", "plan: job")
            if reported["state"] in {"done", "failed", "cancelled"}:
                break
        if reported["state"] == "done":
            self.note_visible("plan: large, done", waited_s)
            self.book.note(kinds.PLAN, job=job)
        else:
            self.blame("plan: large, done", TimeoutError(f"{reported['state']} after {waited_s:.0f} s: {reported.get('error')}"))

    def save_and_edit(self) -> None:
        """Two windows on one mission: the second one that saves is told that it has changed, and saves on top."""
        name = f"Drawn {uuid4().hex[:12]}"
        body = {"name": name, "plan": True, **self.wishes(self.draw.randint(2, 6))}
        answer = self.ask("POST", "/api/v1/missions", "mission: save and plan", body, ok=(201,))
        made, tag = answer.json(), answer.headers["ETag"]
        self.book.note(kinds.MISSION, id=made["id"], name=name, revision=made["revision"])
        path = f"/api/v1/missions/{made['id']}"
        for place, windows_tag in enumerate((tag, tag)):
            new = f"{name} {place + 1}"
            answer = self.ask("PATCH", path, "mission: edit", {"name": new}, ok=(200, 412), **{"If-Match": windows_tag})
            if answer.status_code == 412:
                seen = self.ask("GET", path, "mission: open")
                answer = seen
                if seen.json()["name"] != new:
                    answer = self.ask("PATCH", path, "mission: edit", {"name": new}, ok=(200, 412), **{"If-Match": seen.headers["ETag"]})
            if answer.status_code == 200:
                self.book.note(kinds.EDIT, mission=made["id"], revision=answer.json()["revision"], name=new)
        self.get(f"missions/{made['id']}/history", "mission: history")
        if self.draw.random() < 0.5:
            self.delete(made["id"])

    def delete(self, mission: str) -> None:
        """Half of them are brought back at once: that was a mistake."""
        if self.delete_mission(mission) and self.draw.random() < 0.5:
            self.book.note(kinds.ASKED, thing=mission)
            self.ask("POST", f"/api/v1/missions/{mission}/restore", "mission: undo deletion", ok=(200, 404))
            self.book.note(kinds.RESTORATION, mission=mission)


class Watches(Person):
    """A wall screen with somebody in front of it."""

    abstract = True
    role = "viewer"
    watches = True

    def read_record(self) -> None:
        flown = [mission for mission in self.missions() if mission["state"] == "completed"]
        if flown:
            mission = self.draw.choice(flown)["id"]
            self.ask("GET", f"/missions/{mission}/report", "page: report")
            self.get(f"missions/{mission}/record", "record of a mission")

    def read_log(self) -> None:
        uav = self.draw.choice(self.site.in_air).uav if self.site.in_air else self.site.desks[0].uav
        self.get(f"telemetry?uav={uav}&every_s=10&limit=100", "log of a UAV")

    def read_alerts(self) -> None:
        self.get("alerts?state=open", "alerts: list")


class LeadsShift(Watches):
    """Acknowledges alerts, writes notes, tells UAVs another speed."""

    abstract = True
    role = "operator"

    def acknowledge(self) -> None:
        waiting = self.get("alerts?state=open&acknowledged=false&limit=20", "alerts: list")["results"]
        if not waiting:
            return
        alert = self.draw.choice(waiting)["id"]
        reported = self.ask("POST", f"/api/v1/alerts/{alert}/acknowledge", "alert: acknowledge", {}).json()
        if reported["acknowledged_at"]:
            self.book.note(kinds.ACKNOWLEDGEMENT, alert=alert)
        text = f"Seen {uuid4().hex[:12]}"
        note = self.ask("POST", f"/api/v1/alerts/{alert}/notes", "alert: note", {"text": text}, ok=(201,)).json()
        self.book.note(kinds.NOTE, alert=alert, id=note["id"], text=text)

    def change_speed(self) -> None:
        if not self.site.in_air:
            return
        uav, key = self.draw.choice(self.site.in_air), str(uuid4())
        speed_mps = round(self.draw.uniform(6.0, uav.speed_mps), 1)
        body = {"kind": "change-speed", "parameters": {"speed_mps": speed_mps}}
        answer = self.ask("POST", f"/api/v1/uavs/{uav.uav}/commands", "command: speed", body, ok=(201, 409), key=key)
        if answer.status_code == 201:
            self.book.note(kinds.COMMAND, id=answer.json()["id"], uav=uav.uav, kind="change-speed", key=key)


class KeepsZones(Person):
    """A curator who draws a small zone far from everything, and takes it away again: maps, graph and approvals follow."""

    abstract = True
    role = "curator"

    def zone_comes_and_goes(self) -> None:
        west, south, _, _ = self.site.box
        lon, lat, half = west - 0.2, south - 0.2, 0.001
        corners = [[lon - half, lat - half], [lon + half, lat - half], [lon + half, lat + half], [lon - half, lat + half]]
        name = f"Works {uuid4().hex[:8]}"
        body = {"name": name, "geometry": {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}}
        answer = self.ask("POST", "/api/v1/zones", "zone: draw", body, ok=(201,))
        zone, tag = answer.json()["id"], answer.headers["ETag"]
        self.book.note(kinds.ZONE, id=zone, name=name)
        gevent.sleep(self.draw.uniform(20.0, 40.0))
        self.book.note(kinds.ASKED, thing=str(zone))
        self.ask("DELETE", f"/api/v1/zones/{zone}", "zone: take away", ok=(204, 404), **{"If-Match": tag})
        self.book.note(kinds.ZONE_GONE, id=zone)


class Administers(Person):
    abstract = True
    role = "administrator"

    def edit_users(self) -> None:
        self.ask("GET", "/administration", "page: administration")
        self.get("users?limit=50", "users: list")
        self.get("sign-ins?limit=50", "sign-ins: list")
        self.get("history?limit=50", "history: list")

    def edit_uavs(self) -> None:
        self.ask("GET", "/uavs", "page: UAVs")
        self.get("uavs?limit=100", "UAVs: list")


class AsksForPlans(Bearer):
    """A program that plans by the API and follows what flies."""

    abstract = True

    def on_start(self) -> None:
        turn = next(_turns)
        self.token = self.site.programs[turn % len(self.site.programs)]
        self.draw = random.Random(turn)
        self.tag = ""

    wishes = Person.wishes

    def plan(self) -> None:
        self.ask("POST", "/api/v1/plans", "plan: small, program", self.wishes(self.draw.randint(2, 6), 2))

    def ask_live(self) -> None:
        headers = {"If-None-Match": self.tag} if self.tag else {}
        answer = self.ask("GET", "/api/v1/live", "live: asked", ok=(200, 304), **headers)
        self.tag = answer.headers.get("ETag", self.tag)


def gives_up_quietly(action: Any) -> Any:
    """For Locust: what was given up is counted already."""

    def acted(user: Any) -> None:
        with suppress(GaveUp):
            action(user)

    acted.__name__ = getattr(action, "__name__", "acted")
    return acted
