"""Which zones a plan keeps clear of: all that can be in force while it is flown, or fewer where that brings a better plan."""

from dataclasses import dataclass
from datetime import datetime

import numpy as np
from inspection.zones.reach import ZoneTable
from numpy.typing import NDArray

from missions.flight_plan.rules import FlightRules

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class ZoneChoice:
    """Zones that reach the heights of the flight. widest, narrowest (z,): in force at any moment of the window, through all of it."""

    table: ZoneTable
    widest: BoolArray
    narrowest: BoolArray

    @property
    def changes(self) -> bool:
        """Whether a zone comes into force, or goes out of it, while the plan is flown."""
        return bool((self.widest & ~self.narrowest).any())

    def numbers_of(self, ids: set[int]) -> BoolArray:
        """Which zones have one of these primary keys, (z,)."""
        mask: BoolArray = np.isin(self.table.ids, list(ids))
        return mask


def zone_choice(table: ZoneTable, departs_at: datetime | None, flight: FlightRules) -> ZoneChoice:
    """Without a departure every zone counts as in force at any time."""
    near = table.only(table.reaching(0.0, flight.max_agl_m))
    if departs_at is None:
        always = np.ones(len(near), dtype=bool)
        return ZoneChoice(near, always, always)
    from_s = departs_at.timestamp()
    to_s = from_s + flight.longest_flight_s
    return ZoneChoice(near, near.active_within(from_s, to_s), near.active_throughout(from_s, to_s))
