"""What photos prove: for each component the share that they show, how fine and at which angle, and why the rest cannot be shown.

Any poses can be asked: planned, flown or reported ones. The choice of photos counts by the same rays and frames, on larger patches.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.views.camera import Camera, Lens
from planning.views.limits import LIMITS, Limit
from planning.views.solids import Component, FloatArray, IntArray, Patches, Solid
from planning.views.visibility import Poses, RayCaster, axes_of, photos_show

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class ComponentCoverage:
    """Shares are of area, 0 to 1: shown by photos, and that any photo could show; None where there is nothing to tell.

    gsd_m: below which 95 % of the shown area is; angle_deg: from the normal, likewise. limit: what bars most of the rest.
    """

    component: Component
    number: int
    area_m2: float
    shown: float
    reachable: float
    gsd_m: float | None
    angle_deg: float | None
    limit: Limit


@dataclass(frozen=True, eq=False)
class Coverage:
    """Patch by patch, (p,): the finest ground sample distance [m], inf where not shown; the smallest angle [deg]; number of photos."""

    patches: Patches
    gsd_m: FloatArray
    angle_deg: FloatArray
    photos: IntArray
    limit: IntArray  # places in LIMITS

    @property
    def shown(self) -> BoolArray:
        shown: BoolArray = self.photos > 0
        return shown

    @property
    def reachable(self) -> BoolArray:
        """What can be shown, and what is shown all the same."""
        reachable: BoolArray = (self.limit == 0) | self.shown
        return reachable

    @property
    def share(self) -> float:
        """Shown of what can be shown, 0 to 1; 1 where nothing can."""
        can_m2 = float(self.patches.area_m2[self.reachable].sum())
        return 1.0 if can_m2 == 0.0 else float(self.patches.area_m2[self.shown].sum()) / can_m2


def coverage_of(
    poses: Poses, lens: Lens, camera: Camera, patches: Patches, caster: RayCaster, limit: IntArray | None = None
) -> Coverage:  # fmt: skip
    """Return what photos at these poses show of the patches; whole frames count."""
    shows = photos_show(poses, patches, caster, camera, lens)
    gsd_m, angle_deg = np.full(len(patches), np.inf), np.full(len(patches), np.inf)
    _, _, forward = axes_of(poses.yaw_deg, poses.pitch_deg)
    for number in range(len(poses)):
        seen = np.flatnonzero(shows[number])
        away = patches.centre[seen] - poses.position[number]
        gsd_m[seen] = np.minimum(gsd_m[seen], away @ forward[number] * camera.pixel_mm / lens.focal_mm)
        cosine = -np.einsum("pi,pi->p", away, patches.normal[seen]) / np.linalg.norm(away, axis=1)
        angle_deg[seen] = np.minimum(angle_deg[seen], np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
    own = np.zeros(len(patches), dtype=np.int64) if limit is None else limit
    return Coverage(patches, gsd_m, angle_deg, shows.sum(axis=0), own)


def by_component(solid: Solid, coverage: Coverage) -> tuple[ComponentCoverage, ...]:
    """Return the coverage of each component of the solid, in its order."""
    patches, rows = coverage.patches, []
    for place, (component, number) in enumerate(solid.components):
        own = patches.component == place
        area_m2, shown = patches.area_m2[own], coverage.shown[own]
        whole_m2 = float(area_m2.sum())
        if whole_m2 == 0.0:
            continue
        barred = coverage.limit[own][~coverage.reachable[own]]
        counts = np.bincount(barred, minlength=len(LIMITS)) if len(barred) else np.zeros(len(LIMITS))
        rows.append(
            ComponentCoverage(
                component, number, whole_m2, float(area_m2[shown].sum()) / whole_m2,
                float(area_m2[coverage.reachable[own]].sum()) / whole_m2,
                _below(coverage.gsd_m[own][shown], area_m2[shown]), _below(coverage.angle_deg[own][shown], area_m2[shown]),
                LIMITS[int(counts.argmax())] if counts.any() else Limit.NONE,
            )
        )  # fmt: skip
    return tuple(rows)


def _below(values: FloatArray, weight: FloatArray, share: float = 0.95) -> float | None:
    """The value below which this share of the weight is."""
    if not len(values):
        return None
    order = np.argsort(values)
    reached = np.cumsum(weight[order]) / weight.sum()
    return float(values[order][int(np.searchsorted(reached, share - 1e-9).clip(0, len(values) - 1))])
