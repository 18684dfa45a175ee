"""A tower with its wires, neighbours and terrain, for the planning of photos."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from django.conf import settings

from inspection.geodesy.local_frame import LocalFrame
from inspection.models import Asset
from inspection.scene.overhead import Overhead
from inspection.selectors.scene import drawn_as_tagged, overhead_in
from inspection.selectors.terrain import ground_heights_m, has_terrain
from planning.views.keep_out import no_floor
from planning.views.site import HungSpan, StandingSupport, TowerSite, floor_over, tower_site
from planning.views.solids import FloatArray

AROUND_M = 160.0  # of the tower: supports and wires that a detail inspection may come near


@dataclass(frozen=True, eq=False)
class TowerOnMap:
    """The site in the frame around the tower's foot.

    base_amsl_m: of the ground there, None without terrain data. ground_m: the ground over that at places (n, 2) [m].
    """

    site: TowerSite
    frame: LocalFrame
    base_amsl_m: float | None
    ground_m: Callable[[FloatArray], FloatArray]


def tower_on_map(asset: Asset, min_height_m: float) -> TowerOnMap | None:
    """Return the surroundings of a tower; None where it is no support of the network.

    min_height_m: above the ground, which is kept everywhere.
    """
    frame = LocalFrame.around(*asset.centre.coords)
    corners = frame.to_degrees(np.array([[-AROUND_M, -AROUND_M], [AROUND_M, AROUND_M]]))
    found = overhead_in((*corners[0].tolist(), *corners[1].tolist()))
    own = np.flatnonzero(found.support == asset.pk)
    if not len(own):
        return None
    frame = LocalFrame.around(*found.position[own[0]].tolist())
    base_m = float(ground_heights_m(found.position[own[:1]])[0]) if has_terrain() else np.nan

    def ground_m(places: FloatArray) -> FloatArray:
        heights_m: FloatArray = np.nan_to_num(ground_heights_m(frame.to_degrees(places)) - base_m)
        return heights_m

    if np.isnan(base_m):
        return TowerOnMap(_site(found, int(own[0]), frame, _level, no_floor), frame, None, _level)
    floor = floor_over(ground_m, min_height_m)
    return TowerOnMap(_site(found, int(own[0]), frame, ground_m, floor), frame, base_m, ground_m)


def _level(places: FloatArray) -> FloatArray:
    return np.zeros(len(places))


def _site(
    found: Overhead, own: int, frame: LocalFrame, ground_m: Callable[[FloatArray], FloatArray], floor: Callable[[FloatArray], FloatArray]
) -> TowerSite:
    drawn, hung, _ = drawn_as_tagged(found)
    places = frame.to_metres(found.position)
    foot_m = ground_m(places)
    order = [own, *(place for place in range(len(drawn)) if place != own)]
    number = {place: count for count, place in enumerate(order)}
    supports = [StandingSupport(drawn[place], float(places[place, 0]), float(places[place, 1]), float(foot_m[place])) for place in order]
    spans = [HungSpan(number[span.start], number[span.end], span.sag_m) for span in hung]
    turned = [HungSpan(span.end, span.start, span.sag_m) for span in spans]  # wires are looked at near both of their ends
    return tower_site(supports, [*spans, *turned], settings.CLEARANCE_RULES, floor)
