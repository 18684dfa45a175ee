"""Reports in the order of their arrival: each once, and none missed that was stored late."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from telemetry.selectors.watched import StoredReport, last_record_id, reports_stored_after

OPEN_FOR_S = 30.0  # a store that took its ids earlier than others may end later than them, by so much


@dataclass
class NewReports:
    """Ids are given before a store ends, so what lies behind the newest may still come: it is asked for again for a while."""

    _behind: int = -1  # all up to this id have been seen, or were there before
    _seen: deque[tuple[float, int]] = field(default_factory=deque)

    def begin(self) -> None:
        """From now on, at the first call."""
        if self._behind < 0:
            self._behind = last_record_id()

    def read(self, uav_ids: Sequence[int], now_s: float) -> list[StoredReport]:
        """Of these UAVs, since the last call. now_s: any clock that only goes on."""
        found = reports_stored_after(self._behind, but=[key for _, key in self._seen], uav_ids=uav_ids)
        self._seen.extend((now_s, report.id) for report in found)
        while self._seen and self._seen[0][0] < now_s - OPEN_FOR_S:
            self._behind = max(self._behind, self._seen.popleft()[1])
        return found
