"""The command line of ./run: what it refuses before anything is installed or started."""

import socket
import sys
from pathlib import Path
from typing import NoReturn

import pytest

from scripts import run
from scripts.options import parse, port_problem
from tests.scripts.ports import free_port


def test_a_file_that_is_not_there_is_refused_with_its_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        parse(["--osm", "nowhere.osm.pbf"], tmp_path)
    assert ended.value.code == 2
    assert "no such file: nowhere.osm.pbf" in capsys.readouterr().err


@pytest.mark.parametrize("port", ["0", "65536", "-1", "8000x", "٨٠٠٠", ""])
def test_what_is_no_port_is_refused(port: str, tmp_path: Path) -> None:
    with pytest.raises(SystemExit) as ended:
        parse([f"--port={port}"], tmp_path)
    assert ended.value.code == 2


def test_detach_status_and_stop_exclude_each_other(tmp_path: Path) -> None:
    with pytest.raises(SystemExit):
        parse(["--status", "--stop"], tmp_path)


def test_stopping_sets_nothing_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SPANWISE_VAR", str(tmp_path))
    monkeypatch.setattr(run, "PYTHON", Path(sys.executable))

    def set_up(*_command: object, **_options: object) -> NoReturn:
        raise AssertionError("set-up was called")

    monkeypatch.setattr(run.subprocess, "run", set_up)
    assert run.set_up(["--stop", "--var", str(tmp_path)]) == 0
    with pytest.raises(AssertionError, match="set-up was called"):
        run.set_up(["--var", str(tmp_path), f"--port={free_port()}"])


def test_a_shortened_option_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SystemExit):
        parse(["--det"], tmp_path)


def test_files_may_be_repeated_and_become_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("one.osm", "two.osm"):
        (tmp_path / name).touch()
    monkeypatch.chdir(tmp_path)
    assert parse(["--osm", "one.osm", "--osm", "two.osm"], tmp_path).osm == [tmp_path / "one.osm", tmp_path / "two.osm"]


def test_the_state_folder_is_the_option_else_the_variable_else_var(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_VAR", raising=False)
    assert parse([], tmp_path).var == tmp_path / "var"
    monkeypatch.setenv("SPANWISE_VAR", str(tmp_path / "from variable"))
    assert parse([], tmp_path).var == tmp_path / "from variable"
    assert parse(["--var", str(tmp_path / "from option")], tmp_path).var == tmp_path / "from option"


def test_a_port_in_use_is_told_and_a_free_one_is_not() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert f"port {port} is in use" in (port_problem(port) or "")
    assert port_problem(port) is None
