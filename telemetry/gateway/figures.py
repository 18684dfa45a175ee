"""Metrics of a gateway, read from its state on each scrape."""

import time
from collections import Counter
from collections.abc import Mapping
from typing import Protocol

from operation.snapshots import Described, SnapshotCollector, Values
from telemetry.gateway.session import RECEIVED_WITHIN_S, Session
from telemetry.gateway.store import Store

LINKS, LOSSES, RECORDS = "spanwise_gateway_links", "spanwise_gateway_losses", "spanwise_gateway_records"
WAITING, AWAY = "spanwise_gateway_records_waiting", "spanwise_gateway_database_away"
DESCRIBED = (
    Described(LINKS, "UAVs that this gateway serves, heard within 5 s or silent, and those that another one serves", ["state"]),
    Described(LOSSES, "Frames that were not taken, by cause", ["cause"], is_counter=True),
    Described(RECORDS, "Records of telemetry by what became of them", ["outcome"], is_counter=True),
    Described(WAITING, "Records in memory that wait for the database"),
    Described(AWAY, "1 while the database is away from this gateway"),
)


class ReportedValue(Protocol):
    """The part of a gateway that this module uses."""

    store: Store
    lost_here: Counter[str]
    damages: Counter[str]
    sessions: dict[int, Session]

    def dropped(self) -> Mapping[str, int]:
        """Return the counts of received data that was not a UAV's frame, by cause."""


def figures_of(gateway: ReportedValue) -> SnapshotCollector:
    """Return the collector, which is registered while its context is entered."""
    return SnapshotCollector(DESCRIBED, lambda: _read(gateway))


def _read(gateway: ReportedValue) -> Mapping[str, Values]:
    now_s, store = time.time(), gateway.store
    links = Counter({"heard": 0, "silent": 0, "elsewhere": 0})
    for session in list(gateway.sessions.values()):
        state = "elsewhere" if not session.is_held else "heard" if now_s - session.last_message_s <= RECEIVED_WITHIN_S else "silent"
        links[state] += 1
    losses = Counter(gateway.dropped()) + Counter(gateway.lost_here)
    return {
        LINKS: {(state,): number for state, number in links.items()},
        LOSSES: {(str(cause),): number for cause, number in losses.items()},
        RECORDS: {("stored",): store.stored, ("duplicate",): store.duplicates, ("lost",): store.lost},
        WAITING: {(): len(store.records)},
        AWAY: {(): float(store.is_away)},
    }
