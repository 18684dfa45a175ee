"""Static files are collected beside the load of the data, and a failure of either ends the start; migrations that replace others."""

import subprocess
import sys

import pytest
from django.core.management import CommandError
from django.db import connection
from django.db.migrations.loader import MigrationLoader
from django.db.migrations.recorder import MigrationRecorder

from operation.readiness import NO_MIGRATIONS, Readiness
from scripts import prepare


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen]:
    """The process that collects; it runs the code in its place."""
    processes = []
    popen = subprocess.Popen

    def start(command: list[str], **options) -> subprocess.Popen:
        assert command[1:] == ["-m", "scripts.prepare", "--static-files"]
        processes.append(popen([sys.executable, "-c", start.code], **options))
        return processes[-1]

    start.code = ""
    monkeypatch.setattr(prepare.subprocess, "Popen", start)
    processes.append(start)
    return processes


def test_what_it_says_is_printed_after_what_was_done_meanwhile(started, capsys):
    started.pop().code = "print('Static files … 2.0 s')"
    with prepare.static_files_meanwhile():
        print("Database migrations … 3.0 s")
    assert capsys.readouterr().out.splitlines() == ["Database migrations … 3.0 s", "Static files … 2.0 s"]


def test_its_failure_fails_the_start_with_its_words(started):
    started.pop().code = "print('images.js could not be found'); raise SystemExit(1)"
    with pytest.raises(CommandError, match=r"images\.js could not be found"), prepare.static_files_meanwhile():
        pass


def test_a_failure_meanwhile_ends_it(started):
    started.pop().code = "import time; time.sleep(60)"
    with pytest.raises(CommandError, match="no such file"), prepare.static_files_meanwhile():
        raise CommandError("no such file")
    assert started[0].returncode is not None


@pytest.mark.django_db
def test_an_installation_that_has_applied_what_a_migration_replaces_can_work():
    squashed = {key: migration.replaces for key, migration in MigrationLoader(None).disk_migrations.items() if migration.replaces}
    recorder = MigrationRecorder(connection)
    for key, replaces in squashed.items():
        recorder.record_unapplied(*key)
        for replaced in replaces:
            recorder.record_applied(*replaced)
    prepare.migrate()
    assert squashed.keys() <= recorder.applied_migrations().keys()
    assert NO_MIGRATIONS not in Readiness().faults()


def test_the_data_wait_for_the_core_and_its_failure_ends_the_start(monkeypatch, capsys):
    def fail() -> None:
        raise subprocess.CalledProcessError(1, "search")

    monkeypatch.setattr(prepare, "compile_core", fail)
    monkeypatch.setattr(prepare, "is_core_compiled", lambda: True)
    prepare.wait_for_core()
    assert capsys.readouterr().out == ""
    monkeypatch.setattr(prepare, "is_core_compiled", lambda: False)
    with pytest.raises(CommandError, match="search"):
        prepare.wait_for_core()
