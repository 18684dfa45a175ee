"""nginx as a program whose lines others read: JSON, and without what stands behind a question mark."""

import json
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from scripts.installation.system_packages import find_program
from scripts.places import PROJECT_DIR, Places
from scripts.proxy import proxy_lines
from scripts.proxy.proxy import configuration
from tests.telemetry.gateway.program import free_port

FAULT = (
    '2026/11/22 13:03:15 [error] 11#11: *398 connect() failed, client: 10.0.0.1, request: "GET /sign-in?token=abc HTTP/1.1", '
    'upstream: "http://10.0.0.2:8000/sign-in?token=abc", host: "x"'
)


def test_a_fault_is_told_without_the_query(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_LOG_FORMAT", raising=False)
    assert "abc" not in proxy_lines.reported(FAULT)
    monkeypatch.setenv("SPANWISE_LOG_FORMAT", "json")
    reported = json.loads(proxy_lines.reported(FAULT))
    assert (reported["level"], reported["logger"]) == ("ERROR", "nginx")
    assert "/sign-in?..." in reported["message"]
    assert "abc" not in reported["message"]


@pytest.mark.parametrize("form", ["json", "line"])
def test_nginx_writes_requests_and_faults_without_queries(form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    monkeypatch.setenv("SPANWISE_LOG_FORMAT", form)
    monkeypatch.setenv("PYTHONPATH", str(PROJECT_DIR))
    places, port = Places(tmp_path), free_port()
    places.process("proxy").mkdir(parents=True)
    path = tmp_path / "nginx.conf"
    path.write_text(configuration(places, tmp_path, port))
    with (tmp_path / "log").open("wb") as log:
        command = [sys.executable, "-m", "scripts.proxy.proxy_lines", nginx, "-e", "stderr", "-p", str(tmp_path), "-c", str(path)]
        process = subprocess.Popen(command, stdout=log, stderr=log)
        end_s = time.monotonic() + 60
        while time.monotonic() < end_s:
            try:
                urllib.request.urlopen(f"http://127.0.0.1:{port}/sign-in?token=abc", timeout=10)
            except urllib.error.HTTPError as answer:
                assert answer.code == 503
                break
            except OSError:
                time.sleep(0.1)
        reported = {"json": '"status": 503', "line": '/sign-in?..." 503'}[form]
        while reported not in (tmp_path / "log").read_text():  # requests are written once a second
            assert time.monotonic() < end_s
            time.sleep(0.05)
        process.terminate()
        assert process.wait(60) == 0
    lines = (tmp_path / "log").read_text().splitlines()
    assert "abc" not in "\n".join(lines)
    assert any("/sign-in?..." in line for line in lines)
    if form == "json":
        objects = [json.loads(line) for line in lines]
        assert [one["status"] for one in objects if one["logger"] == "requests"] == [503]
        assert {"ERROR", "CRITICAL"} & {one["level"] for one in objects if one["logger"] == "nginx"}
