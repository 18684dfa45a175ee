"""Which zones a plan keeps clear of: all that can be in force while it is flown, or fewer where that brings a better plan."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from inspection.geodesy import LonLat
from inspection.zones.reach import BoolArray, ZoneTable
from planning.rules import FlightRules

NEAR_SHARE = 0.5  # of what a plan extends over, on each side; ways lead farther round only where nothing nearer is left
NEAR_DEG = 0.15  # some 15 km


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


def zone_choice(
    table: ZoneTable, departs_at: datetime | None, flight: FlightRules, positions: Sequence[LonLat] | None = None
) -> ZoneChoice:
    """Without a departure every zone counts as in force at any time; with positions, so does a zone far from all of them.

    A network that is cleared of one more zone far away is most often there already, for others, or for another departure.
    """
    if departs_at is None:
        always = np.ones(len(table), dtype=bool)
        return ZoneChoice(table, always, always)
    from_s = departs_at.timestamp()
    to_s = from_s + flight.longest_flight_s
    no_matter = ~table.reaching(0.0, flight.max_agl_m)
    if positions is not None:
        no_matter |= ~near_positions(table, positions)
    some = ~no_matter
    widest, narrowest = no_matter.copy(), no_matter.copy()
    asked = table.only(some)
    widest[some] = asked.active_within(from_s, to_s)
    narrowest[some] = asked.active_throughout(from_s, to_s)
    return ZoneChoice(table, widest, narrowest)


def near_positions(table: ZoneTable, positions: Sequence[LonLat]) -> BoolArray:
    """Which zones come near the box of the positions, (z,)."""
    at = np.array(positions, dtype=np.float64).reshape(-1, 2)
    low, high = at.min(axis=0), at.max(axis=0)
    about = np.maximum(NEAR_SHARE * (high - low), NEAR_DEG)
    low, high = low - about, high + about
    box = table.box
    near: BoolArray = (box[:, 0] <= high[0]) & (box[:, 2] >= low[0]) & (box[:, 1] <= high[1]) & (box[:, 3] >= low[1])
    return near
