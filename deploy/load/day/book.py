"""The client's own book: a line for each write that was acknowledged, kept where no server can lose it.

Several processes append to one file, each whole lines at once. A line has `what` (a kind below), `at` (Unix time [s]) and what it takes
to look for the thing in the database. What was asked and never answered is written down as well: it may be there, and need not.
"""

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import orjson

FILE = "book.jsonl"

MISSION = "mission"  # id, name, revision
EDIT = "edit"  # mission, revision, name
ASKED = "asked"  # thing: a mission or zone is to go or to come back, and nobody knows until the next line about it
DELETION = "deletion"  # mission
RESTORATION = "restoration"  # mission
JOB = "job"  # id: a promise to plan
PLAN = "plan"  # job: what it promised was fetched
APPROVAL = "approval"  # mission, approval, sha256
COMMAND = "command"  # id, uav, kind; key where a person gave it
COMMAND_END = "command-end"  # id, state: as the UAV told it and was noted
RECORDS = "records"  # uav, stream, sequences
RESULTS = "results"  # uav, stream, sequences
FLIGHT = "flight"  # uav, approval, flight
ACKNOWLEDGEMENT = "acknowledgement"  # alert
NOTE = "note"  # alert, id, text
ZONE = "zone"  # id, name
ZONE_GONE = "zone-gone"  # id
SENT = "sent"  # uav, datagrams: MAVLink, which nobody acknowledges
UNANSWERED = "unanswered"  # method, path, key: given up
RETRIED = "retried"  # name, why: failed, and was tried again
SEEN = "seen"  # name, took_s: until somebody saw what was to come
GAP = "gap"  # a page saw one: by, expected, got
WATCHED = "watched"  # a page: by, messages, gaps, opened


class Book:
    """To append to. Safe for several processes and greenlets: O_APPEND, one write a line."""

    def __init__(self, folder: Path) -> None:
        self._file = os.open(folder / FILE, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)

    def note(self, what: str, **facts: Any) -> None:
        os.write(self._file, orjson.dumps({"what": what, "at": time.time(), **facts}) + b"\n")


def lines(folder: Path) -> Iterator[dict[str, Any]]:
    """Of the whole book, in the order in which it was written."""
    path = folder / FILE
    if not path.exists():
        return
    with path.open("rb") as written:
        for line in written:
            if line.endswith(b"\n"):  # the last one may be cut off where the client was killed
                yield orjson.loads(line)
