"""A tower or a bridge among wires and neighbours: what the photos of an inspection are flown around."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from inspection.scene.supports import DrawnSupport
from planning.views.bridge_solid import BridgeShape
from planning.views.ground_band import GroundBand
from planning.views.keep_out import SITE_M, ClearanceRules, KeepOut, Obstacle, Span, clearance_m, keep_out
from planning.views.solids import FloatArray, Solid
from planning.views.tower_solid import tower_solid

HOTTEST_CATENARY_M = 800.0  # constant C of the catenary of a hot wire, whose sag is length^2 / (8 C)
CONTACT_WIRE_V = 25_000.0  # of electric railways, which a bridge may carry
ON_DECK_M = 12.0  # masts of contact wires, lamp posts and vehicles, over the deck


@dataclass(frozen=True)
class StandingSupport:
    """A support and its foot: x east, y north and height of the ground over that of the inspected one [m]."""

    support: DrawnSupport
    east_m: float
    north_m: float
    ground_m: float = 0.0

    @property
    def top_m(self) -> float:
        """As high as planners count it: where no tag states its height that is more than it is drawn with."""
        return self.ground_m + max(self.support.height_m, self.support.likely_m)


@dataclass(frozen=True)
class WireBand:
    """Where the wires of a span hang, whatever their temperature. span: as it begins at the inspected tower.

    start_low_m, end_low_m: where the lowest wire is fastened at both ends.
    """

    span: Span
    start_low_m: float
    end_low_m: float

    @property
    def length_m(self) -> float:
        return math.dist(self.span.start, self.span.end)

    def heights_m(self, along_m: float) -> tuple[float, float]:
        """The lowest wire at its hottest, and the straight line over the highest points, so far along the span."""
        share, span = along_m / self.length_m, self.span
        low_m = self.start_low_m + (self.end_low_m - self.start_low_m) * share - 4.0 * span.sag_m * share * (1.0 - share)
        return low_m, span.start_top_m + (span.end_top_m - span.start_top_m) * share


@dataclass(frozen=True, eq=False)
class InspectionSite:
    """The inspected asset, whose foot or middle is the origin, and what is kept from it and its surroundings.

    bearing_deg: of a tower's line, of a bridge's axis. bands: of a tower's spans. around_m: how far from the asset its surroundings are
    known. anchors (n, 2): places of the asset around which photos are looked for; reach_m: to its farthest corner, 0 of towers. occluders:
    what stands beside it and hides parts of it.
    """

    solid: Solid
    bearing_deg: float
    clearance_m: float
    keep_out: KeepOut
    bands: tuple[WireBand, ...] = ()
    around_m: float = SITE_M
    anchors: FloatArray = field(default_factory=lambda: np.zeros((1, 2)))
    reach_m: float = 0.0
    occluders: tuple[Solid, ...] = ()


def tower_site(
    supports: Sequence[StandingSupport],
    spans: Sequence[tuple[int, int]],
    rules: ClearanceRules,
    band: GroundBand,
    obstacles: Sequence[Obstacle] = (),
    lens_offset_m: float = 0.0,
    around_m: float = SITE_M,
) -> InspectionSite:
    """Return the site of the first of the supports, with what is within around_m.

    spans: places of the supports at both ends. The clearance is that of the highest voltage there, and lens_offset_m more: poses are the
    lens's, and the UAV is as far from them. obstacles: what else is on the map.
    """
    kept_m = max(clearance_m(own.support.voltage_v, rules) for own in supports) + lens_offset_m
    own_ends = [(start, end) if start == 0 else (end, start) for start, end in spans if 0 in {start, end}]
    bands = [WireBand(_span(supports[start], supports[end]), _low_m(supports[start]), _low_m(supports[end])) for start, end in own_ends]
    kept = keep_out([*_columns(supports), *obstacles], _wires(supports, spans), kept_m, band, around_m)
    return InspectionSite(_placed(supports[0]), supports[0].support.bearing_deg, kept_m, kept, tuple(bands), around_m)


def bridge_site(
    bridge: BridgeShape,
    supports: Sequence[StandingSupport],
    spans: Sequence[tuple[int, int]],
    rules: ClearanceRules,
    band: GroundBand,
    obstacles: Sequence[Obstacle] = (),
    lens_offset_m: float = 0.0,
    occluders: Sequence[BridgeShape] = (),
) -> InspectionSite:
    """Return the site of a bridge with what is within SITE_M of it; see tower_site. Vehicles and masts stand on its deck.

    occluders: bridges beside it, which are among the obstacles too.

    The UAV is beside or above the bridge, never under it. The clearance is at least that of a railway's contact wire.
    """
    voltages_v = [CONTACT_WIRE_V, *(own.support.voltage_v for own in supports)]
    kept_m = max(clearance_m(voltage_v, rules) for voltage_v in voltages_v) + lens_offset_m
    top_m = max(bridge.deck_m + ON_DECK_M, bridge.top_m)
    around_m = bridge.reach_m + SITE_M
    columns = [*(Obstacle(corners, bridge.outline_error_m, top_m) for corners in bridge.pieces()), *_columns(supports), *obstacles]
    kept = keep_out(columns, _wires(supports, spans), kept_m, band, around_m)
    solid, anchors = bridge.solid(), bridge.anchors()
    hides = tuple(own.solid() for own in occluders)
    return InspectionSite(solid, bridge.bearing_deg, kept_m, kept, (), around_m, anchors, bridge.reach_m, hides)


def _columns(supports: Sequence[StandingSupport]) -> list[Obstacle]:
    return [Obstacle(_placed(own).triangles.reshape(-1, 3)[:, :2], 0.0, own.top_m) for own in supports]


def _wires(supports: Sequence[StandingSupport], spans: Sequence[tuple[int, int]]) -> list[Span]:
    return [_span(supports[start], supports[end]) for start, end in spans]


def _placed(own: StandingSupport) -> Solid:
    return tower_solid(own.support).turned(own.support.bearing_deg).moved((own.east_m, own.north_m, own.ground_m))


def _span(start: StandingSupport, end: StandingSupport) -> Span:
    """As wide as the wider of both ends, as it is not known which wire leads to which side; with the sag of a hot day."""
    reach_m = max(abs(across) for own in (start, end) for across in _across(own))
    length_m = math.hypot(end.east_m - start.east_m, end.north_m - start.north_m)
    return Span(
        (start.east_m, start.north_m), (end.east_m, end.north_m), -reach_m, reach_m, start.top_m, end.top_m,
        sag_m=length_m**2 / (8.0 * HOTTEST_CATENARY_M), string_m=max(_string_m(own) for own in (start, end)),
    )  # fmt: skip


def _across(own: StandingSupport) -> list[float]:
    return [across for across, _ in (*own.support.arms.slots, *own.support.arms.earth)] or [0.0]


def _low_m(own: StandingSupport) -> float:
    """The height of its lowest wire, over the ground of the inspected one."""
    return own.ground_m + min((hangs_m for _, hangs_m in own.support.arms.slots), default=own.support.likely_m)


def _string_m(own: StandingSupport) -> float:
    """How far the lowest phase hangs below its arm: what swings with the wires."""
    levels_m = [arm for arm, _, _ in own.support.arms.arms]
    hung_m = [min((arm for arm in levels_m if arm >= hangs_m), default=hangs_m) - hangs_m for _, hangs_m in own.support.arms.slots]
    return max(hung_m, default=0.0)
