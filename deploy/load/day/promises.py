"""What was acknowledged to clients, as their book has it, gathered for the checks."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from deploy.load.day import book as kinds


@dataclass
class Promises:
    """By kind of thing; `sequences` by UAV and stream. `retried` and `unanswered` are counts by what was asked."""

    missions: dict[str, str] = field(default_factory=dict)  # id, name when it was made
    edits: list[tuple[str, int, str]] = field(default_factory=list)  # mission, revision, name
    deleted: set[str] = field(default_factory=set)
    unsure: set[str] = field(default_factory=set)  # missions and zones of which nobody was told whether they went or came back
    jobs: set[str] = field(default_factory=set)
    plans: set[str] = field(default_factory=set)  # jobs of which the plan was fetched
    approvals: dict[str, tuple[str, str]] = field(default_factory=dict)  # by id: mission, SHA-256
    commands: dict[str, str] = field(default_factory=dict)  # id, key or ""
    ends: dict[str, str] = field(default_factory=dict)  # command, state that its UAV told and was noted
    records: dict[tuple[int, str], set[int]] = field(default_factory=lambda: defaultdict(set))
    results: dict[tuple[int, str], set[int]] = field(default_factory=lambda: defaultdict(set))
    flights: set[tuple[int, str, int]] = field(default_factory=set)  # UAV, approval, flight
    acknowledged: set[int] = field(default_factory=set)  # alerts
    notes: dict[int, str] = field(default_factory=dict)
    zones: dict[int, str] = field(default_factory=dict)
    zones_gone: set[int] = field(default_factory=set)
    sent: dict[int, int] = field(default_factory=dict)  # UAV, reports by MAVLink, unacknowledged
    seen_s: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))  # how long until somebody saw what was to come
    gaps: list[str] = field(default_factory=list)
    live_messages: int = 0
    pages_opened: int = 0
    retried: int = 0
    unanswered: list[str] = field(default_factory=list)

    @property
    def count(self) -> int:
        """Of acknowledged items."""
        single = (
            self.missions, self.edits, self.deleted, self.jobs, self.plans, self.approvals, self.commands, self.ends, self.flights,
            self.acknowledged, self.notes, self.zones, self.zones_gone,
        )  # fmt: skip
        numbered = sum(len(sequences) for stored in (self.records, self.results) for sequences in stored.values())
        return sum(map(len, single)) + numbered


def promises_of(lines: Iterable[dict[str, Any]]) -> Promises:
    found = Promises()
    for line in lines:
        _take(found, line)
    return found


def _take(found: Promises, line: dict[str, Any]) -> None:
    match line["what"]:
        case kinds.MISSION:
            found.missions[line["id"]] = line["name"]
        case kinds.EDIT:
            found.edits.append((line["mission"], line["revision"], line["name"]))
        case kinds.ASKED:
            found.unsure.add(line["thing"])
        case kinds.DELETION:
            found.deleted.add(line["mission"])
            found.unsure.discard(line["mission"])
        case kinds.RESTORATION:
            found.deleted.discard(line["mission"])
            found.unsure.discard(line["mission"])
        case kinds.JOB:
            found.jobs.add(line["id"])
        case kinds.PLAN:
            found.plans.add(line["job"])
        case kinds.APPROVAL:
            found.approvals[line["approval"]] = (line["mission"], line["sha256"])
        case kinds.COMMAND:
            found.commands[line["id"]] = line["key"]
        case kinds.COMMAND_END:
            found.ends[line["id"]] = line["state"]
        case kinds.RECORDS:
            found.records[line["uav"], line["stream"]].update(line["sequences"])
        case kinds.RESULTS:
            found.results[line["uav"], line["stream"]].update(line["sequences"])
        case kinds.FLIGHT:
            found.flights.add((line["uav"], line["approval"], line["flight"]))
        case kinds.ACKNOWLEDGEMENT:
            found.acknowledged.add(line["alert"])
        case kinds.NOTE:
            found.notes[line["id"]] = line["text"]
        case kinds.ZONE:
            found.zones[line["id"]] = line["name"]
        case kinds.ZONE_GONE:
            found.zones_gone.add(line["id"])
            found.unsure.discard(str(line["id"]))
        case kinds.SENT:
            found.sent[line["uav"]] = found.sent.get(line["uav"], 0) + line["reports"]
        case kinds.SEEN:
            found.seen_s[line["name"]].append(line["took_s"])
        case kinds.GAP:
            found.gaps.append(f"{line['by']}: {line['expected']} was to come, and {line['got']} came")
        case kinds.WATCHED:
            found.live_messages += line["messages"]
            found.pages_opened += line["opened"]
        case kinds.RETRIED:
            found.retried += 1
        case kinds.UNANSWERED:
            found.unanswered.append(f"{line['method']} {line['path']}: {line['status']}")
