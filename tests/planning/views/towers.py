"""Towers, wires and cameras of tests and benchmarks of views."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from inspection.scene.forms import Form, Layout
from inspection.scene.supports import DrawnSupport, arms_of
from planning.views.camera import Camera, Gimbal
from planning.views.ground_band import GroundBand
from planning.views.keep_out import SITE_M, ClearanceRules, KeepOut
from planning.views.site import InspectionSite, StandingSupport, tower_site
from planning.views.solids import FloatArray, Solid

SPAN_M = 300.0
MIN_HEIGHT_M, MAX_HEIGHT_M = 4.0, 120.0

ZOOM = Camera("zoom", 6.4, 4.8, 8000, 6000, (7.1, 10.0, 14.0, 20.0, 28.4), 0.7, 5.0, gimbal=Gimbal(-120.0, 45.0))
FULL_FRAME = Camera("full frame, 35 mm", 35.9, 24.0, 8192, 5460, (35.0,), 0.7, 1.0, gimbal=Gimbal(-130.0, 40.0))
WIDE = Camera("four thirds, wide", 17.3, 13.0, 5280, 3956, (12.3,), 0.7, 1.0, gimbal=Gimbal(-90.0, 35.0))


@dataclass(frozen=True, eq=False)
class StandingTower:
    """A tower among its neighbours, and the site that is planned on."""

    support: DrawnSupport
    site: InspectionSite
    supports: tuple[StandingSupport, ...]

    @property
    def solid(self) -> Solid:
        return self.site.solid

    @property
    def clearance_m(self) -> float:
        return self.site.clearance_m

    @property
    def keep_out(self) -> KeepOut:
        return self.site.keep_out

    @property
    def entry(self) -> FloatArray:
        return np.array([0.0, 0.0, self.keep_out.top_at(np.zeros(2)) + 2.0])


def support(
    form: Form, layout: Layout, height_m: float, voltage_v: int | None, phases: int = 3, *, is_anchor: bool = False
) -> DrawnSupport:
    arms = arms_of(form, layout, height_m, voltage_v, phases, is_anchor)
    return DrawnSupport("tower", form, height_m, "tag", height_m, voltage_v, is_anchor, 0.0, arms)


def standing(
    own: DrawnSupport, bearing_deg: float = 0.0, ground_m: Callable[[FloatArray], FloatArray] | None = None, around_m: float = SITE_M
) -> StandingTower:  # fmt: skip
    """In a straight line of towers of its kind, SPAN_M apart, over level ground or a terrain."""
    own = replace(own, bearing_deg=bearing_deg)
    along = np.array([np.sin(np.radians(bearing_deg)), np.cos(np.radians(bearing_deg))])
    places = np.array([along * side * SPAN_M for side in (0.0, 1.0, -1.0)])
    feet_m = np.zeros(3) if ground_m is None else ground_m(places)
    supports = [StandingSupport(own, *place, foot_m) for place, foot_m in zip(places.tolist(), feet_m.tolist(), strict=True)]
    band = GroundBand.level(MIN_HEIGHT_M, MAX_HEIGHT_M)
    if ground_m is not None:
        band = GroundBand.over(ground_m, MIN_HEIGHT_M, MAX_HEIGHT_M, around_m + 30.0)
    site = tower_site(supports, [(0, 1), (2, 0)], ClearanceRules(), band, around_m=around_m)
    return StandingTower(own, site, tuple(supports))


TOWERS = {
    "lattice, 380 kV, barrel": support(Form.LATTICE, Layout.BARREL, 50.0, 380_000, 6),
    "lattice, 380 kV, danube": support(Form.LATTICE, Layout.DANUBE, 48.0, 380_000, 6),
    "lattice, 380 kV, delta": support(Form.LATTICE, Layout.DELTA, 38.0, 380_000),
    "lattice, 380 kV, one level, anchor": support(Form.LATTICE, Layout.ONE_LEVEL, 33.0, 380_000, is_anchor=True),
    "lattice, 220 kV, danube, anchor": support(Form.LATTICE, Layout.DANUBE, 42.0, 220_000, 6, is_anchor=True),
    "lattice, 220 kV, three levels": support(Form.LATTICE, Layout.THREE_LEVEL, 44.0, 220_000, 6),
    "lattice, 110 kV, two levels": support(Form.LATTICE, Layout.TWO_LEVEL, 30.0, 110_000, 6),
    "lattice, 110 kV, triangle": support(Form.LATTICE, Layout.TRIANGLE, 26.0, 110_000),
    "lattice, 110 kV, flag, anchor": support(Form.LATTICE, Layout.FLAG, 28.0, 110_000, is_anchor=True),
    "lattice, 765 kV, delta": support(Form.LATTICE, Layout.DELTA, 55.0, 765_000),
    "tubular, 220 kV, alternating": support(Form.TUBULAR, Layout.ALTERNATING, 34.0, 220_000),
    "tubular, 110 kV, alternating": support(Form.TUBULAR, Layout.ALTERNATING, 28.0, 110_000),
    "tubular, 110 kV, two levels, anchor": support(Form.TUBULAR, Layout.TWO_LEVEL, 30.0, 110_000, 6, is_anchor=True),
    "guyed, 400 kV, delta": support(Form.GUYED, Layout.DELTA, 35.0, 400_000),
    "guyed, 220 kV, one level": support(Form.GUYED, Layout.ONE_LEVEL, 30.0, 220_000),
    "H-frame, 110 kV": support(Form.H_FRAME, Layout.ONE_LEVEL, 18.0, 110_000),
    "H-frame, 66 kV, anchor": support(Form.H_FRAME, Layout.ONE_LEVEL, 16.0, 66_000, is_anchor=True),
    "portal, 110 kV": support(Form.PORTAL, Layout.ONE_LEVEL, 11.0, 110_000),
    "wooden pole, 20 kV": support(Form.WOODEN, Layout.TRIANGLE, 11.0, 20_000),
    "wooden pole, 33 kV, one level": support(Form.WOODEN, Layout.ONE_LEVEL, 12.0, 33_000),
}
