"""manage.py plan_file: neither database nor queue, and one line for what is wrong."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from django.core.management import CommandError, call_command

from config.private_servers import PROJECT_DIR
from tests.planning.test_file_plans import graph_file

MISSIONS = [{"uavs": [[55.049, 10.001], [54.951, 9.999]], "targets": [0, 13, 5, 10]}]


@pytest.fixture
def files(tmp_path: Path) -> dict[str, Path]:
    (tmp_path / "graph.npz").write_bytes(graph_file().getvalue())
    (tmp_path / "missions.json").write_text(json.dumps(MISSIONS))
    return {"graph": tmp_path / "graph.npz", "missions": tmp_path / "missions.json", "json": tmp_path / "plans.json"}


@pytest.mark.long
def test_it_plans_where_neither_database_nor_queue_answers(files):
    options = [part for name, path in files.items() for part in (f"--{name}", str(path))]
    nowhere = os.environ | {"DATABASE_URL": "postgis://nobody@127.0.0.1:1/nothing", "REDIS_URL": "redis://127.0.0.1:1/0"}
    command = [sys.executable, str(PROJECT_DIR / "manage.py"), "plan_file", *options, "--objective", "max"]
    done = subprocess.run(command, env=nowhere, capture_output=True, text=True, check=False)  # noqa: S603 (our own program)
    assert done.returncode == 0, done.stderr
    assert "16 nodes" in done.stdout
    (plan,) = json.loads(files["json"].read_bytes())
    assert sorted(plan) == ["cost_m", "makespan_m", "ms", "routes", "waypoints"]
    assert sorted(plan["ms"]) == ["assign", "expand", "matrix", "nearest", "total"]


def test_no_missions_give_no_plans(files):
    files["missions"].write_text("[]")
    call_command("plan_file", **files)
    assert json.loads(files["json"].read_bytes()) == []


@pytest.mark.parametrize(("name", "content"), [("graph", b"no npz"), ("missions", b"{"), ("missions", b"{}"), ("missions", b"[{}]")])
def test_a_faulty_file_is_refused(files, name, content):
    files[name].write_bytes(content)
    with pytest.raises(CommandError, match=r"not a|Expecting"):
        call_command("plan_file", **files)
    assert not files["json"].exists()
