"""A tower among its wires and neighbours: what a detail inspection flies around."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from inspection.scene.forms import Form
from inspection.scene.supports import DrawnSupport
from planning.views.keep_out import ClearanceRules, KeepOut, Span, clearance_m, keep_out, no_floor
from planning.views.solids import FloatArray, Solid
from planning.views.tower_solid import tower_solid


@dataclass(frozen=True)
class StandingSupport:
    """A support and its foot: x east, y north and height of the ground over that of the inspected one [m]."""

    support: DrawnSupport
    east_m: float
    north_m: float
    ground_m: float = 0.0


@dataclass(frozen=True)
class HungSpan:
    """Wires between two supports, by their places in the site; sag_m as it is drawn."""

    start: int
    end: int
    sag_m: float


@dataclass(frozen=True, eq=False)
class TowerSite:
    """The inspected tower, which is supports[0] and stands at the origin, and what is kept from it and its surroundings."""

    supports: tuple[StandingSupport, ...]
    solid: Solid
    clearance_m: float
    keep_out: KeepOut

    @property
    def tower(self) -> DrawnSupport:
        return self.supports[0].support


def tower_site(
    supports: Sequence[StandingSupport],
    spans: Sequence[HungSpan],
    rules: ClearanceRules,
    floor: Callable[[FloatArray], FloatArray] = no_floor,
) -> TowerSite:
    """Return the site of the first of the supports. The clearance is that of the highest voltage there; a support without one counts."""
    kept_m = max(clearance_m(own.support.voltage_v, rules) for own in supports)
    solids = [_placed(own) for own in supports if own.support.form is not Form.STAKE]
    wires = [_span(supports[span.start], supports[span.end], span.sag_m) for span in spans]
    return TowerSite(tuple(supports), _placed(supports[0]), kept_m, keep_out(solids, wires, kept_m, floor))


def _placed(own: StandingSupport) -> Solid:
    return tower_solid(own.support).turned(own.support.bearing_deg).moved((own.east_m, own.north_m, own.ground_m))


def _span(start: StandingSupport, end: StandingSupport, sag_m: float) -> Span:
    """As wide as the wider of both ends, as it is not known which wire leads to which side."""
    reach_m = max(abs(across) for own in (start, end) for across in _across(own))
    tops_m = [own.ground_m + max([height for _, height in (*own.support.arms.slots, *own.support.arms.earth)], default=own.support.height_m)
              for own in (start, end)]  # fmt: skip
    return Span((start.east_m, start.north_m), (end.east_m, end.north_m), -reach_m, reach_m, tops_m[0], tops_m[1], sag_m)


def _across(own: StandingSupport) -> list[float]:
    return [across for across, _ in (*own.support.arms.slots, *own.support.arms.earth)] or [0.0]


def floor_over(heights_m: Callable[[FloatArray], FloatArray], min_height_m: float) -> Callable[[FloatArray], FloatArray]:
    """The floor [m] that keeps this height over ground of which heights_m tells the height at places; unknown ground counts as level."""

    def floor(places: FloatArray) -> FloatArray:
        ground_m = heights_m(places)
        least: FloatArray = np.where(np.isnan(ground_m), 0.0, ground_m) + min_height_m
        return least

    return floor
