"""Where logs are JSON, whatever a program writes is: what it prints, raises, warns of, in threads and forks, before logging is set up."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from scripts import commands
from scripts.places import PROJECT_DIR

TALKATIVE = """
import logging, os, sys, threading, warnings
print("plain")
print("no end yet", end="")
child = os.fork()
if not child:
    print("of a fork")
    sys.stdout.flush()
    os._exit(0)
os.waitpid(child, 0)
print(", now")
print('{"message": "an object already"}')
print("{no object}")
sys.__stdout__.write("beside it\\n")
warnings.warn("mind\\nthis")
thread = threading.Thread(target=lambda: 1 / 0)
thread.start()
thread.join()
logging.getLogger("lib").error("before set-up, Bearer abcdefghijklmnop")
raise ValueError("token=abcdefghijkl")
"""


def written(*command: str) -> tuple[list[dict[str, Any]], int]:
    """What each line says. Raises ValueError where one is no JSON."""
    environment = os.environ | {"SPANWISE_LOG_FORMAT": "json", "SPANWISE_PROGRAM": "tried", "PYTHONPATH": str(PROJECT_DIR)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, timeout=120)
    return [json.loads(line) for line in (done.stdout + done.stderr).splitlines()], done.returncode


def test_every_line_is_json_and_none_has_a_secret(tmp_path: Path) -> None:
    script = tmp_path / "talkative.py"
    script.write_text(TALKATIVE)
    lines, code = written(sys.executable, "-m", "operation.json_lines", str(script))
    assert code == 1
    stated = [line["message"] for line in lines]
    assert stated[:6] == ["plain", "of a fork", "no end yet, now", "an object already", "{no object}", "beside it"]
    assert stated[6].startswith("UserWarning: mind\nthis")
    assert stated[7] == "ZeroDivisionError was not caught"
    assert "division by zero" in lines[7]["exception"]
    assert stated[8] == "before set-up, Bearer ..."
    assert stated[9] == "ValueError was not caught"
    assert lines[9]["exception"].endswith("token=...")
    assert {line.get("program") for line in lines if line["message"] != "an object already"} == {"tried"}


def test_granian_tells_of_a_start_that_fails_in_json() -> None:
    command = [sys.executable, "-m", "operation.json_lines", "granian", "--interface", "wsgi", "--uds", "/nowhere/x.sock", "--log-config"]
    lines, code = written(*command, str(commands.GRANIAN_LOG), "no.such:application")
    assert code != 0
    assert {"_granian", "python"} & {line["logger"] for line in lines}


@pytest.mark.parametrize("make", [commands.web, commands.live, commands.beat, lambda: commands.worker("data", 1)])
def test_programs_are_started_that_way_where_logs_are_json_and_only_there(make: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_LOG_FORMAT", raising=False)
    assert "operation.json_lines" not in make()
    monkeypatch.setenv("SPANWISE_LOG_FORMAT", "json")
    assert make()[:3] == [sys.executable, "-m", "operation.json_lines"]
