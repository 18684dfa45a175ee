"""A working day of a team, played by Locust: who does what, and how often. deploy/load/soak.py starts it against an installation.

    SPANWISE_DAY=FOLDER SPANWISE_DAY_AUTHORITY=ca.crt locust -f deploy/load/working_day.py --headless --host https://localhost:PORT -u 80

One line of the table is one thing that somebody does, with how often an hour each of them does it, and why so often. The first users are
those of a fixed number; what is more of `-u` are people at desks, by their weights. UAVs that speak MAVLink are a process of their own
(deploy/load/day/fleet.py).
"""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from locust import User, between

from deploy.load.day.book import Book
from deploy.load.day.client import Client
from deploy.load.day.companions import Companion
from deploy.load.day.flying import FlyingOperator
from deploy.load.day.site import Site
from deploy.load.day.users import (
    Administers,
    AsksForPlans,
    KeepsZones,
    LeadsShift,
    PlansMissions,
    Watches,
    gives_up_quietly,
)

FOLDER = Path(os.environ["SPANWISE_DAY"])
SITE = Site.read(FOLDER)
Client.site, Client.book = SITE, Book(FOLDER)

FIXED, WEIGHT = "fixed", "weight"
# who | how many | what: times an hour | why
DAY: list[tuple[type[User], tuple[str, int], dict[str, int], str]] = [
    (Companion, (FIXED, len(SITE.desks)), {"step": 0},
     "a record a second, a batch each 10 s, asks each 5 s: docs/uav-link.md"),
    (FlyingOperator, (FIXED, len(SITE.desks)), {"fly_or_go_on": 20},
     "a short flight every three minutes: a busy shift, one UAV a desk"),
    (AsksForPlans, (FIXED, 4), {"plan": 240, "ask_live": 1_200},
     "a program that plans its customers' wishes as they come, and follows what flies where it has no websocket"),
    (KeepsZones, (FIXED, 1), {"zone_comes_and_goes": 20},
     "short-lived zones of a busy day; each changes the ground for everybody"),
    (Administers, (FIXED, 1), {"edit_users": 30, "edit_uavs": 30},
     "somebody new, somebody who left, a battery that was replaced"),
    (PlansMissions, (WEIGHT, 5),
     {"plan_small": 60, "save_and_edit": 30, "plan_large": 6, "open_mission": 40, "list_missions": 20, "tiles": 80},
     "somebody who plans tries each wish; a plan a minute, every second one is kept, a long line each ten minutes"),
    (Watches, (WEIGHT, 3), {"read_record": 12, "read_log": 12, "read_alerts": 30, "open_mission": 10, "tiles": 40},
     "mostly looks at the live page, which is told once a second; looks something up every half minute"),
    (LeadsShift, (WEIGHT, 2), {"acknowledge": 40, "change_speed": 20, "read_record": 6, "tiles": 20},
     "an alert every one and a half minutes is all that one can take in"),
]  # fmt: skip


def played(who: type[User], many: tuple[str, int], does: dict[str, int]) -> type[User]:
    """A Locust user that does each of these so often an hour, at random moments."""
    per_hour = sum(does.values())
    every_s = 3_600.0 / per_hour if per_hour else 0.0
    number = {"fixed_count": many[1]} if many[0] == FIXED else {"weight": many[1]}
    waits = {"wait_time": between(0.5 * every_s, 1.5 * every_s)} if per_hour else {"wait_time": between(0.0, 0.0)}
    tasks = {gives_up_quietly(getattr(who, name)): max(often, 1) for name, often in does.items()}
    return type(f"{who.__name__}OfDay", (who,), {"abstract": False, "tasks": tasks, **number, **waits})


if sum(many[1] for _, many, _, _ in DAY if many[0] == FIXED) != SITE.fixed_users:
    raise SystemExit("the table has another number of fixed users than day/site.py says")
for _who, _many, _does, _why in DAY:
    globals()[f"{_who.__name__}OfDay"] = played(_who, _many, _does)
