"""Steps of a set-up run side by side where they can, and the reason of a failure is told."""

import sys
import threading
from pathlib import Path

import pytest

from scripts.installation import install, system_packages
from scripts.installation.install import Step, about_s, carry_out
from scripts.installation.python_libraries import CannotInstall


def test_steps_without_an_order_run_side_by_side(capsys):
    meeting = threading.Barrier(2, timeout=20.0)
    carry_out([Step("one", 1.0, lambda step: meeting.wait() and None), Step("two", 1.0, lambda step: meeting.wait() and None)])
    lines = capsys.readouterr().out.splitlines()
    assert sorted(line.split(" … ")[0] for line in lines) == ["one", "two"]
    assert all(line.endswith(" s") for line in lines)


def test_a_step_waits_for_those_before_it_that_are_to_be_done():
    order: list[str] = []
    steps = [
        Step("last", 1.0, lambda step: order.append("last"), ["middle"]),
        Step("middle", 1.0, lambda step: order.append("middle"), ["first", "done before"]),
        Step("first", 1.0, lambda step: order.append("first")),
    ]
    carry_out(steps)
    assert order == ["first", "middle", "last"]


def test_after_a_failure_what_runs_ends_nothing_else_begins_and_the_reason_is_told(capsys):
    failed, done = threading.Event(), []

    def fail(step: Step) -> None:
        failed.set()
        raise CannotInstall("no space left on device")

    def go_on(step: Step) -> None:
        assert failed.wait(20.0)
        done.append(step.text)

    with pytest.raises(CannotInstall):
        carry_out([Step("fails", 1.0, fail), Step("apt", 1.0, go_on), Step("later", 1.0, go_on, ["fails"])])
    assert done == ["apt"]
    assert "no space left on device" in capsys.readouterr().err


def test_it_is_said_beforehand_how_long_it_takes(capsys):
    def nothing(step: Step) -> None: ...

    steps = [Step("libraries", 15.0, nothing), Step("core", 70.0, nothing, ["libraries"]), Step("packages", 20.0, nothing)]
    assert about_s(steps) == 85.0
    carry_out(steps)
    assert capsys.readouterr().out.splitlines()[0] == "To be set up, about 85 s, less after another checkout: libraries, core, packages"


def test_what_goes_on_is_said_now_and_then(capsys, monkeypatch):
    monkeypatch.setattr(install, "LOG_INTERVAL_S", 0.0)
    monkeypatch.setattr(install, "TERMINAL_INTERVAL_S", 0.01)
    reported = threading.Event()

    def compile_core(step: Step) -> None:
        step.detail = "graph, 1 of 4 parts"
        reported.wait(0.5)

    carry_out([Step("core", 1.0, compile_core)])
    assert "core (graph, 1 of 4 parts)" in capsys.readouterr().out


def test_a_command_that_fails_fails_with_what_it_said():
    with pytest.raises(CannotInstall, match="no such option"):
        install._call(["sh", "-c", "echo no such option; exit 2"])


def test_a_failed_step_ends_with_one(monkeypatch):
    def fail(step: Step) -> None:
        raise CannotInstall("apt-get failed")

    monkeypatch.setattr(system_packages, "missing_packages", lambda purpose: [])
    monkeypatch.setattr(install, "steps_to_do", lambda *arguments: [Step("Debian packages", 1.0, fail)])
    assert install.main("run") == 1


@pytest.mark.parametrize(("purpose", "options"), [("run", ["--detach"]), ("check", []), ("image", [])])
def test_only_a_start_leaves_the_core_to_a_process_in_the_background(monkeypatch, purpose, options):
    commands = []
    monkeypatch.setattr(install, "_call", lambda command, on_line=None: commands.append(command))
    monkeypatch.setattr(install.python_libraries, "is_installed", lambda *arguments: False)
    step = next(step for step in install.steps_to_do(purpose, sys.executable) if step.text.startswith(install.CORE))
    step.run(step)
    assert [command[1:] for command in commands] == [["-m", "scripts.compile_core", *options]]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in (
        "package.json",
        "package-lock.json",
        "scripts/installation/install.py",
        "scripts/installation/world_outline.py",
        "scripts/development/build_icons.py",
        "static/img/icons/one.svg",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    (tmp_path / "node_modules").mkdir()
    monkeypatch.setattr(install, "PROJECT_DIR", tmp_path)
    monkeypatch.setattr(install, "NODE_MODULES", tmp_path / "node_modules")
    return tmp_path


@pytest.mark.parametrize(
    ("installed_for_checks", "for_checks", "is_enough"),
    [(True, True, True), (True, False, True), (False, False, True), (False, True, False)],
)
def test_page_libraries_for_checks_are_enough_to_run_but_not_the_reverse(checkout, installed_for_checks, for_checks, is_enough):
    assert not install._page_libraries_are_there(for_checks)
    (checkout / "node_modules" / ".stamp").write_text("\n".join(install._page_stamp(installed_for_checks)))
    assert install._page_libraries_are_there(for_checks) == is_enough
    (checkout / "static" / "img" / "icons" / "one.svg").write_text("changed")
    assert not install._page_libraries_are_there(for_checks)
