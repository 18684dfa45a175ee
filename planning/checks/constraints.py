"""Constraints that the checks of candidate plans add: what the next candidate has to keep to beyond the request."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from inspection.geodesy import LonLat
from inspection.network.build.obstacles import at_all_heights, with_obstacles
from inspection.network.zones.zone_index import ZoneIndex
from inspection.zones.reach import BoolArray
from operation.reasons import Reason
from planning.airspace import ZoneChoice
from planning.assignment.candidate_plan import CandidatePlan
from planning.checks.battery import battery_overruns, not_lasting_for, without_overruns
from planning.checks.wires import (
    barring_spans,
    targets_barred,
    targets_barred_after_others,
    walls_of_spans,
    wires_after_others,
    wires_in_the_way,
    with_wires,
    without_routes_barred,
)
from planning.context import PlanningContext
from planning.plan import PlannedRoute

MAX_ROUND = 6  # candidates in one airspace; after the last one UAVs whose routes cannot be flown stay on the ground
SHARES_FROM = MAX_ROUND - 2  # from this candidate on a battery counts as smaller, and no target is kept from its UAV for it any more

TargetsOfUavs = Mapping[int, frozenset[int]]


class ZoneNotAvoided(RuntimeError):
    """A finished route meets zones that the planner has kept clear of: a fault of the planner. The plan does not leave."""


@dataclass(frozen=True, eq=False)
class Constraints:
    """zones, closed_zones (z,): kept clear of at the heights that they reach, and at all heights. is_by_length: on the shortest paths.

    usable_share and kept_from as in `assignment`. spans: by their numbers those to be passed round, closed_spans those of them that are
    passed round with the towers at their ends. wires: from which UAV targets are kept for wires, and why. number: of the candidate in
    this airspace, from 0 on.
    """

    zones: BoolArray
    closed_zones: BoolArray
    is_by_length: bool = False
    usable_share: Mapping[int, float] = field(default_factory=dict)
    kept_from: TargetsOfUavs = field(default_factory=dict)
    spans: frozenset[int] = frozenset()
    closed_spans: frozenset[int] = frozenset()
    wires: Mapping[int, tuple[int, Reason]] = field(default_factory=dict)
    number: int = 0

    @property
    def is_relaxed(self) -> bool:
        """Whether the search can count on all batteries and all paths."""
        return not (self.usable_share or self.kept_from or self.spans or self.wires)

    def obstacles(self, context: PlanningContext, terminals: Sequence[LonLat]) -> ZoneIndex | None:
        """Return what is passed round at all heights. terminals: where UAVs start, land and inspect."""
        closed = at_all_heights(context.zone_index(self.closed_zones)) if self.closed_zones.any() else None
        if not self.spans:
            return closed
        wires = walls_of_spans(context.network, self.spans, self.closed_spans, terminals)
        return wires if closed is None else with_obstacles(closed, wires)

    def on_shortest_paths(self) -> "Constraints":
        """The same zones on the shortest paths; nothing has been shown there yet."""
        return Constraints(self.zones, self.closed_zones, is_by_length=True)

    def clear_of(self, met: frozenset[int], choice: ZoneChoice) -> "Constraints":
        """Keep clear of these zones, too, by their keys; at all heights where they were kept clear of at those they reach.

        What rises over wires in a valley may come into a zone under which its path was to lead. Raises ZoneNotAvoided.
        """
        zones = choice.with_zones(self.zones, met)
        if (zones != self.zones).any():
            return Constraints(zones, self.closed_zones)
        closed = choice.with_zones(self.closed_zones, met)
        if (closed == self.closed_zones).all():
            raise ZoneNotAvoided(sorted(met))
        return Constraints(zones, closed)

    def after(self, found: CandidatePlan, conflicts: "Conflicts") -> "Constraints":
        """What this candidate's conflicts add."""
        more = replace(self, number=self.number + 1)
        if conflicts.spans:
            more = more._after_wires(found, conflicts.spans)
        if conflicts.overruns:
            more = more._after_overruns(found, conflicts, is_firm=self.number >= SHARES_FROM)
        return more

    def _after_wires(self, found: CandidatePlan, barring: TargetsOfUavs) -> "Constraints":
        """First the wires are passed round; then what is to be inspected at them is kept from the UAV; then their towers are passed
        round, too; and at last a UAV keeps to the first targets of its route."""
        spans = frozenset[int]().union(*barring.values())
        if not spans <= self.spans:
            return replace(self, spans=self.spans | spans)
        barred, reason = targets_barred(found, barring), wires_in_the_way
        if not barred and not spans <= self.closed_spans:
            return replace(self, closed_spans=self.closed_spans | spans)
        if not barred:
            barred, reason = targets_barred_after_others(found, barring), wires_after_others
        why = {target: (uav, reason(found.request.uavs[uav].name)) for uav, targets in barred.items() for target in targets}
        return replace(self._keeping(barred), wires={**self.wires, **why})

    def _after_overruns(self, found: CandidatePlan, conflicts: "Conflicts", *, is_firm: bool) -> "Constraints":
        over = conflicts.overruns
        if is_firm:
            return self._counting_on({uav: min(share, 1.0) for uav, share in over.items()})
        kept = not_lasting_for(found, conflicts.routes, over)
        return self._keeping(kept)._counting_on({uav: share for uav, share in over.items() if uav not in kept})

    def _keeping(self, targets_of: TargetsOfUavs) -> "Constraints":
        """With these targets kept from these UAVs, too."""
        more = {uav: self.kept_from.get(uav, frozenset()) | targets for uav, targets in targets_of.items()}
        return replace(self, kept_from={**self.kept_from, **more})

    def _counting_on(self, share_of: Mapping[int, float]) -> "Constraints":
        """With no more than these shares of their batteries for these UAVs."""
        less = {uav: min(self.usable_share.get(uav, math.inf), share) for uav, share in share_of.items()}
        return replace(self, usable_share={**self.usable_share, **less})


@dataclass(frozen=True, eq=False)
class Conflicts:
    """What speaks against flying the routes of a candidate as drawn, by UAV. overruns: the share of the battery with which its route is
    not chosen again; spans: those that it would have to pass too high, or pass too near."""

    routes: Sequence[PlannedRoute]
    overruns: Mapping[int, float]
    spans: TargetsOfUavs

    def __bool__(self) -> bool:
        return bool(self.overruns or self.spans)


def conflicts_of(found: CandidatePlan, routes: Sequence[PlannedRoute]) -> Conflicts:
    return Conflicts(routes, battery_overruns(found, routes), barring_spans(routes, found.airspace.context))


def without_conflicts(found: CandidatePlan, conflicts: Conflicts, constraints: Constraints) -> tuple[CandidatePlan, Sequence[PlannedRoute]]:
    """UAVs with conflicts stay on the ground; and what was kept from UAVs for wires says so."""
    routes = conflicts.routes
    if conflicts:
        found, routes = without_overruns(found, routes, conflicts.overruns)
        found, routes = without_routes_barred(found, routes, conflicts.spans)
    return replace(found, left_out=with_wires(found.left_out, constraints.wires)), routes
