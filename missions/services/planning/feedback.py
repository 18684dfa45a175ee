"""Attempts on one set of zones, one after another, until the routes of one, once drawn, keep to their batteries and clear of wires."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from inspection.geodesy import LonLat
from inspection.network.zones.zone_index import ZoneIndex
from missions.services.planning.battery import battery_overruns, not_lasting_for, without_overruns
from missions.services.planning.candidate_plans import Attempt
from missions.services.planning.over_wires import (
    barred_after_others_text,
    barred_text,
    spans_in_the_way,
    targets_barred,
    targets_barred_after_others,
    told_of_wires,
    walls_of_spans,
    without_routes_barred,
)
from missions.services.planning.plan_json import PlannedRoute
from missions.services.planning.requests import PlanRequest
from missions.services.targets.refusals import Scene
from planning.trajectory.heights import GroundHeights

MAX_TRIES = 6
FIRM_FROM = MAX_TRIES - 2  # from this try on a battery counts as so much smaller, and nothing is kept from its UAV for it any more

KeptFrom = Mapping[int, frozenset[int]]


@dataclass(frozen=True)
class Shown:
    """What drawn routes have shown so far: usable_share and kept_from as in `assignment`, and spans, by their numbers, to go round.

    closed are those of the spans that are gone round with the towers at their ends. wires: from which UAV targets were kept for
    wires, and why.
    """

    usable_share: Mapping[int, float] = field(default_factory=dict)
    kept_from: KeptFrom = field(default_factory=dict)
    spans: frozenset[int] = frozenset()
    closed: frozenset[int] = frozenset()
    wires: Mapping[int, tuple[int, str]] = field(default_factory=dict)

    def keeping(self, targets_of: KeptFrom) -> "Shown":
        """With these targets kept from these UAVs, too."""
        more = {uav: self.kept_from.get(uav, frozenset()) | targets for uav, targets in targets_of.items()}
        return replace(self, kept_from={**self.kept_from, **more})

    def counting_on(self, share_of: Mapping[int, float]) -> "Shown":
        """With no more than these shares of their batteries for these UAVs."""
        less = {uav: min(self.usable_share.get(uav, math.inf), share) for uav, share in share_of.items()}
        return replace(self, usable_share={**self.usable_share, **less})


NOTHING = Shown()


@dataclass(frozen=True, eq=False)
class DrawnAttempt:
    """The attempt with its routes, one for each UAV; is_first: the search could count on all batteries and all ways."""

    found: Attempt
    routes: list[PlannedRoute]
    is_first: bool


@dataclass(frozen=True, eq=False)
class DrawnAttempts:
    """scene_with: the scene with these walls, None for none more; attempt_on: who does what there, after what was shown, in so much of
    the time for a search. terminals: where UAVs start, land and inspect. ground: the terrain model's heights; None: there is none."""

    request: PlanRequest
    ground: GroundHeights | None
    terminals: Sequence[LonLat]
    scene_with: Callable[[ZoneIndex | None], Scene]
    attempt_on: Callable[[Scene, Shown, float], Attempt]

    def last(self) -> DrawnAttempt:
        """The first attempt with nothing against it. Where no try has that, the UAVs whose routes cannot be flown stay on the ground.

        Where a route takes more of its battery than the search had counted, the search counts on so much less that this route is out of
        the question; what cannot be flown over is gone round from then on.
        """
        shown, scene = NOTHING, self.scene_with(None)
        for number in range(MAX_TRIES):
            found = self.attempt_on(scene, shown, 0.5**number)
            routes = found.routes(self.request, self.ground)
            over = battery_overruns(self.request, found, routes)
            in_the_way = spans_in_the_way(routes, scene.network, self.ground)
            if not over and not in_the_way:
                break
            if number == MAX_TRIES - 1:
                found, routes = without_overruns(self.request, found, routes, over)
                found, routes = without_routes_barred(self.request, found, routes, in_the_way)
                break
            before = shown
            if in_the_way:
                shown = self._after_wires(shown, found, in_the_way)
            if over:
                shown = self._after_overruns(shown, found, routes, over, is_firm=number >= FIRM_FROM)
            if (shown.spans, shown.closed) != (before.spans, before.closed):
                scene = self.scene_with(walls_of_spans(scene.network, shown.spans, shown.closed, self.terminals))
        told = replace(found, left_out=told_of_wires(found.left_out, shown.wires))
        return DrawnAttempt(told, routes, shown == NOTHING)

    def _after_wires(self, shown: Shown, found: Attempt, in_the_way: KeptFrom) -> Shown:
        """First the wires are gone round; then what is to be inspected at them is kept from the UAV; then their towers are gone round,
        too; and at last a UAV keeps to the first targets of its route."""
        spans = frozenset[int]().union(*in_the_way.values())
        if not spans <= shown.spans:
            return replace(shown, spans=shown.spans | spans)
        barred, text = targets_barred(found, in_the_way, self.ground), barred_text
        if not barred and not spans <= shown.closed:
            return replace(shown, closed=shown.closed | spans)
        if not barred:
            barred, text = targets_barred_after_others(found, in_the_way, self.ground), barred_after_others_text
        why = {target: (uav, text(self.request.uavs[uav].name)) for uav, targets in barred.items() for target in targets}
        return replace(shown.keeping(barred), wires={**shown.wires, **why})

    def _after_overruns(
        self, shown: Shown, found: Attempt, routes: Sequence[PlannedRoute], over: Mapping[int, float], *, is_firm: bool
    ) -> Shown:
        if is_firm:
            return shown.counting_on({uav: min(share, 1.0) for uav, share in over.items()})
        kept = not_lasting_for(self.request, found, routes, over, self.ground)
        return shown.keeping(kept).counting_on({uav: share for uav, share in over.items() if uav not in kept})
