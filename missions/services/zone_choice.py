"""Which zones a plan keeps clear of: all that can be in force while it is flown, or fewer where that brings a better plan."""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from inspection.zones.reach import BoolArray, ZoneTable
from missions.flight_plan.rules import FlightRules


@dataclass(frozen=True, eq=False)
class ZoneChoice:
    """widest, narrowest (z,): the zones that are in force at any moment of the flight, and those that are so all the time.

    Zones that do not reach the heights of a flight are in both: they bar nothing.
    """

    table: ZoneTable
    widest: BoolArray
    narrowest: BoolArray

    @property
    def changes(self) -> bool:
        """Whether a zone comes into force, or goes out of it, while the plan is flown."""
        return bool((self.widest != self.narrowest).any())

    def with_zones(self, chosen: BoolArray, ids: Collection[int]) -> BoolArray:
        """The mask, and the zones with these primary keys."""
        mask: BoolArray = chosen | np.isin(self.table.ids, list(ids))
        return mask


def zone_choice(table: ZoneTable, departs_at: datetime | None, flight: FlightRules) -> ZoneChoice:
    """Without a departure every zone counts as in force at any time."""
    if departs_at is None:
        always = np.ones(len(table), dtype=bool)
        return ZoneChoice(table, always, always)
    from_s = departs_at.timestamp()
    to_s = from_s + flight.longest_flight_s
    no_matter = ~table.reaching(0.0, flight.max_agl_m)
    return ZoneChoice(table, table.active_within(from_s, to_s) | no_matter, table.active_throughout(from_s, to_s) | no_matter)
