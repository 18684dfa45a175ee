"""A full disk does not end the supervisor, and with it every program."""

import sys
from contextlib import suppress
from pathlib import Path

import pytest
from supervisor.loggers import FileHandler, LogRecord

from scripts.supervision.supervisor_program import Forgiving

FULL = Path("/dev/full")  # Linux's own full disk
pytestmark = pytest.mark.skipif(not FULL.exists(), reason="there is no /dev/full here")


def line() -> LogRecord:
    return LogRecord(20, "a program has said something\n")


def test_a_line_that_cannot_be_kept_is_lost_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    handler = FileHandler(str(FULL))
    with suppress(OSError), FULL.open("w") as words:  # which cannot be closed properly either
        monkeypatch.setattr(sys, "stderr", Forgiving(words))
        for number in range(3):
            handler.emit(line())
            reported = number
    assert reported == 2


def test_what_can_be_written_is_written(tmp_path: Path) -> None:
    with (tmp_path / "words").open("w") as words:
        stream = Forgiving(words)
        print("one", file=stream)
        assert stream.fileno() == words.fileno()
    assert (tmp_path / "words").read_text() == "one\n"
