"""A plan is made again from the file of its context, without a database and without Django's models."""

import io
import json
import os
import random
import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
from django.core.management import CommandError, call_command

from missions.selectors.planning_context import planning_context, read_targets
from missions.services import PlanRequest, create_mission, make_plan
from missions.services.planning import planner
from planning.checks.constraints import ZoneNotAvoided
from planning.context_file import NotAContextFile, read_context, write_context
from planning.plan_json import plan_to_json
from planning.planner import MAX_SOLVER_CALLS, plan
from tests.accounts.users import a_user
from tests.missions.property_tests.random_flights import airs, approve_some, bring_in, departures, flight, put_zones
from tests.missions.property_tests.random_missions import Region
from tests.missions.worlds import request, world

pytestmark = pytest.mark.django_db

ROOT = Path(__file__).resolve().parents[3]
# The cache of compiled code is found by a module of `config`, whose __init__ loads Celery: that is left out.
REPLAY = """
import sys, types
sys.modules["config"] = types.ModuleType("config")
sys.modules["config"].__path__ = ["config"]
class NoDjango:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {"django", "rest_framework", "celery", "redis", "psycopg"}:
            raise ImportError(f"{name} is absent")
sys.meta_path.insert(0, NoDjango())
import json, pathlib
from planning.context_file import read_context
from planning.plan_json import plan_to_json
from planning.planner import plan
context, request = read_context(pathlib.Path(sys.argv[1]))
print(json.dumps(plan_to_json(plan(context, request))))
"""


def written(asked: PlanRequest, path: Path) -> Path:
    write_context(path, planning_context(asked, *read_targets(asked)), asked)
    return path


@pytest.mark.long
def test_random_plans_are_made_again_as_they_were(region_file: Any, tmp_path: Path) -> None:
    bring_in(region_file("quillmoor.osm.pbf"), tmp_path, random.Random(3), is_hilly=True)
    draw = random.Random(3)
    put_zones(300, draw)
    region, author, every_air, times = Region(), a_user(), airs(draw), departures(draw, 2)
    for departs_at in times[1:]:
        approve_some(region, draw, draw.choice(every_air), departs_at, author)
    calls = []
    for number in range(12):
        asked = flight(region, draw, draw.choice(every_air), draw.choice(times), author)
        path = written(asked, tmp_path / f"{number}.zip")
        context, again = read_context(path)
        made = plan(context, again)
        calls.append(made.solver_calls)
        assert plan_to_json(made) == make_plan(request=asked)
    assert all(1 <= count <= MAX_SOLVER_CALLS for count in calls)


@pytest.mark.long
def test_a_plan_is_made_again_with_django_absent(tmp_path: Path) -> None:
    here = world()
    asked = request(here.towers[5], here.bridge, here.line)
    path = written(asked, tmp_path / "plan.zip")
    command = [sys.executable, "-c", REPLAY, str(path)]
    surroundings = {name: value for name, value in os.environ.items() if name != "DJANGO_SETTINGS_MODULE"}
    again = subprocess.run(command, cwd=ROOT, env=surroundings, capture_output=True, text=True, check=False)  # noqa: S603 - our own Python
    assert again.returncode == 0, again.stderr
    assert json.loads(again.stdout) == json.loads(json.dumps(make_plan(request=asked)))


def test_the_commands_write_and_replay_a_mission(tmp_path: Path) -> None:
    here, author = world(), a_user()
    mission = create_mission(organisation=author.organisation, author=author, name="Line", request=request(here.towers[2], here.bridge))
    reported = io.StringIO()
    call_command("write_plan_context", str(mission.pk), str(tmp_path / "plan.zip"), stdout=reported)
    call_command("replay_plan", str(tmp_path / "plan.zip"), "--json", str(tmp_path / "plan.json"), stdout=reported, stderr=io.StringIO())
    assert "2 targets, 1 UAVs" in reported.getvalue()
    assert "2 of 2 targets" in reported.getvalue()
    assert json.loads((tmp_path / "plan.json").read_text())["total_length_m"] > 0


@pytest.mark.parametrize("mission", ["no-uuid", "00000000-0000-0000-0000-000000000000"])
def test_a_mission_that_is_not_there_is_named(mission: str, tmp_path: Path) -> None:
    with pytest.raises(CommandError, match="There is no mission"):
        call_command("write_plan_context", mission, str(tmp_path / "plan.zip"))


@pytest.mark.parametrize("damage", ["cut", "other", "empty", "layout"])
def test_a_file_that_is_no_context_is_refused(damage: str, tmp_path: Path) -> None:
    path = written(request(world().towers[2]), tmp_path / "plan.zip")
    content = path.read_bytes()
    path.write_bytes({"cut": content[: len(content) // 2], "other": b"{}", "empty": b"", "layout": content}[damage])
    if damage == "layout":
        with mock.patch("planning.context_file.LAYOUT", 3), pytest.raises(NotAContextFile, match="layout 2"):
            read_context(path)
    else:
        with pytest.raises(NotAContextFile):
            read_context(path)
        with pytest.raises(CommandError):
            call_command("replay_plan", str(path))


def test_the_context_of_a_plan_that_fails_is_kept_and_of_a_few_alone(settings: Any, tmp_path: Path) -> None:
    asked = request(world().towers[2])
    settings.PLAN_CONTEXT_DIR = tmp_path / "failed"
    for _ in range(3):
        failing = mock.patch.object(planner, "plan", side_effect=ZoneNotAvoided)
        with mock.patch.object(planner, "MAX_KEPT_CONTEXTS", 2), failing, pytest.raises(ZoneNotAvoided):
            make_plan(request=asked)
    kept = list((tmp_path / "failed").glob("*.zip"))
    assert len(kept) == 2
    assert read_context(kept[0])[1] == asked
