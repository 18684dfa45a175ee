"""Buffer of received data for the database: keeps it during an outage, up to a limit."""

import logging
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.services.captures import NewCapture
from telemetry.services.ingest import NewRecord
from telemetry.services.links.gateway_messages import ReceivedBatch, ReceivedText, store_received
from telemetry.services.links.links import LinkState
from telemetry.services.links.sightings import Sighting

logger = logging.getLogger(__name__)

RECORDS_AT_ONCE = 2_000
MAX_TEXTS = 10_000
MAX_CAPTURES = 20_000
CAPTURES_AT_ONCE = 200


@dataclass
class Store:
    """The buffer. `links` returns the vehicles' states at each store; `unsaved` receives those that could not be stored."""

    database: DatabaseThread
    holder: str
    most_records: int
    links: Callable[[], list[LinkState]]
    unsaved: Callable[[Sequence[LinkState]], None]
    records: deque[NewRecord] = field(default_factory=deque)
    texts: deque[ReceivedText] = field(default_factory=lambda: deque(maxlen=MAX_TEXTS))
    sightings: dict[int, Sighting] = field(default_factory=dict)
    captures: deque[NewCapture] = field(default_factory=lambda: deque(maxlen=MAX_CAPTURES))
    stored: int = 0
    duplicates: int = 0
    lost: int = 0  # for lack of room, or because they could not be stored
    is_away: bool = False

    def note_sighting(self, sighting: Sighting) -> None:
        """Keep the newest sighting of each system id."""
        self.sightings[sighting.system] = sighting

    async def flush(self) -> bool:
        """Store a batch. Returns whether more is waiting; False while the database is unavailable."""
        self._drop_overflow()
        records = [self.records.popleft() for _ in range(min(len(self.records), RECORDS_AT_ONCE))]
        texts, self.texts = self.texts, deque(maxlen=MAX_TEXTS)
        sightings, self.sightings = self.sightings, {}
        captures = [self.captures.popleft() for _ in range(min(len(self.captures), CAPTURES_AT_ONCE))]
        received = ReceivedBatch(records, self.links(), list(texts), list(sightings.values()), captures)
        if not received:
            return False
        is_stored = False
        try:
            await self._store(received)
            is_stored = True
        except DatabaseUnavailable as error:
            self._notify(is_away=True, why=str(error))
            return False
        finally:
            if not is_stored:  # also when the loop is cancelled; storing twice is harmless
                self.records.extendleft(reversed(records))
                self.texts.extendleft(reversed(texts))
                self.captures.extendleft(reversed(captures))
                self.sightings = sightings | self.sightings
                self.unsaved(received.links)
        self._notify(is_away=False)
        return bool(self.records or self.captures)

    async def _store(self, received: ReceivedBatch) -> None:
        try:
            counted = await self.database.run(store_received, received=received, holder=self.holder)
        except DatabaseUnavailable:
            raise
        except Exception:
            await self._store_what_can_be(received)
        else:
            self.stored += counted.stored
            self.duplicates += counted.duplicates

    async def _store_what_can_be(self, received: ReceivedBatch) -> None:
        """Store in parts, so that one value that the database refuses does not block the rest."""
        for part in _parts(received):
            if len(part.records) <= 1 and part == received:
                logger.exception("this could not be stored: %s", received.records or received)
                self.lost += len(received.records)
            else:
                await self._store(part)

    def _drop_overflow(self) -> None:
        """Drop the oldest records of the UAVs that have most, so that a UAV that sends too much does not displace others."""
        before = len(self.records)
        if before <= self.most_records:
            return
        waiting = Counter(record.uav_id for record in self.records)
        most_of_each = _most_of_each(waiting.values(), self.most_records)
        kept = []
        for record in self.records:
            if waiting[record.uav_id] <= most_of_each:
                kept.append(record)
            else:
                waiting[record.uav_id] -= 1
        self.records.clear()
        self.records.extend(kept)
        self.lost += before - len(kept)

    def _notify(self, *, is_away: bool, why: str = "") -> None:
        if is_away != self.is_away:
            self.is_away = is_away
            logger.warning("the database is %s; %s records wait. %s", "away" if is_away else "back", len(self.records), why)


def _most_of_each(numbers: Iterable[int], most: int) -> int:
    """Return the number to which each is cut so that at most `most` remain in total."""
    room = most
    by_size = sorted(numbers)
    for place, number in enumerate(by_size):
        share = room // (len(by_size) - place)
        if number > share:
            return share
        room -= number
    return most


def _parts(received: ReceivedBatch) -> Sequence[ReceivedBatch]:
    """Return halves of the records; without records, links, texts, sightings and photos one by one."""
    if len(received.records) > 1 or (received.records and received != ReceivedBatch(received.records)):
        middle = max(len(received.records) // 2, 1)
        halves = [ReceivedBatch(records) for records in (received.records[:middle], received.records[middle:]) if records]
        rest = replace(received, records=())
        return [*halves, rest] if rest else halves
    if received.records:
        return [received]
    kinds = ("links", "texts", "sightings", "captures")
    return [ReceivedBatch(**{kind: [entry]}) for kind in kinds for entry in getattr(received, kind)]
