"""Heights and times of zones: their limits as heights above ground, and when they apply."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from inspection.zones.activity import TimeSpan, active_spans
from inspection.zones.schedule import Schedule, ZoneRules

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]


class HeightLimits(NamedTuple):
    """A zone's limits as stated; None is not stated. References as in HeightReference, "" for none."""

    lower_m: float | None
    lower_reference: str
    upper_m: float | None
    upper_reference: str

    @property
    def needs_ground(self) -> bool:
        """Whether the terrain height is needed to convert the limits to heights above ground."""
        return (self.lower_m is not None and self.lower_reference == "AMSL") or (
            self.upper_m is not None and self.upper_reference == "AMSL"
        )


def agl_band(limits: HeightLimits, lowest_ground_m: float = math.nan, highest_ground_m: float = math.nan) -> tuple[float, float]:
    """Return the lowest and highest height above ground that a zone can reach [m], given the terrain under it above sea level.

    A limit that is not stated, counts from the ellipsoid or from standard pressure, or needs unknown terrain (NaN), becomes -inf or inf. So
    do both limits of an inverted band.
    """
    floor_m = _agl_m(limits.lower_m, limits.lower_reference, highest_ground_m, -math.inf)
    ceiling_m = _agl_m(limits.upper_m, limits.upper_reference, lowest_ground_m, math.inf)
    return (floor_m, ceiling_m) if floor_m <= ceiling_m else (-math.inf, math.inf)


def _agl_m(limit_m: float | None, reference: str, ground_amsl_m: float, otherwise: float) -> float:
    if limit_m is None or not math.isfinite(limit_m):
        return otherwise
    if reference == "AGL":
        return limit_m
    if reference == "AMSL" and math.isfinite(ground_amsl_m):
        return limit_m - ground_amsl_m
    return otherwise


@dataclass(frozen=True, eq=False)
class ZoneTable:
    """All zones of one dataset version, row by row.

    ids int64 (z,), primary keys in ascending order; wkb and polygons in lon/lat, box float64 (z, 4) around them; floor_agl_m and
    ceiling_agl_m float64 (z,): from agl_band, without margin; limits and schedules as stated. Threads may share a table: GEOS's prepared
    polygons are for one thread at a time, so `polygons` returns copies that the caller may prepare.
    """

    ids: NDArray[np.int64]
    names: tuple[str, ...]
    wkb: tuple[bytes, ...]
    box: FloatArray
    floor_agl_m: FloatArray
    ceiling_agl_m: FloatArray
    limits: tuple[HeightLimits, ...]
    schedules: tuple[Schedule | None, ...]
    rules: ZoneRules

    def __post_init__(self) -> None:
        columns = (self.names, self.wkb, self.box, self.floor_agl_m, self.ceiling_agl_m, self.limits, self.schedules)
        if any(len(column) != len(self.ids) for column in columns):
            raise ValueError("the columns of a table of zones are of the same length")

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def polygons(self) -> NDArray[np.object_]:
        read: NDArray[np.object_] = np.asarray(shapely.force_2d(shapely.from_wkb(np.array(self.wkb, dtype=object))), dtype=object)
        return read

    def only(self, chosen: BoolArray) -> "ZoneTable":
        """Return the rows where the mask (z,) is true."""
        rows = np.flatnonzero(chosen).tolist()
        return ZoneTable(
            ids=self.ids[rows],
            names=tuple(self.names[row] for row in rows),
            wkb=tuple(self.wkb[row] for row in rows),
            box=self.box[rows],
            floor_agl_m=self.floor_agl_m[rows],
            ceiling_agl_m=self.ceiling_agl_m[rows],
            limits=tuple(self.limits[row] for row in rows),
            schedules=tuple(self.schedules[row] for row in rows),
            rules=self.rules,
        )

    def reaching(self, low_agl_m: float, high_agl_m: float) -> BoolArray:
        """Return which zones may reach a flight between two heights above ground, height margin included, (z,)."""
        margin_m = self.rules.height_margin_m
        mask: BoolArray = (self.floor_agl_m - margin_m <= high_agl_m) & (self.ceiling_agl_m + margin_m >= low_agl_m)
        return mask

    def spans(self, from_s: float, to_s: float) -> tuple[tuple[TimeSpan, ...], ...]:
        """Return for each zone when it applies between two moments, time margin included."""
        return self._spans(from_s, to_s, self.rules.time_margin_s)

    def stated_spans(self, from_s: float, to_s: float) -> tuple[tuple[TimeSpan, ...], ...]:
        """Return for each zone when it applies between two moments, as its schedule states it."""
        return self._spans(from_s, to_s, 0.0)

    def active_within(self, from_s: float, to_s: float) -> BoolArray:
        """Return which zones apply at any moment of a window, (z,)."""
        return np.array([bool(spans) for spans in self.spans(from_s, to_s)], dtype=bool)

    def active_throughout(self, from_s: float, to_s: float) -> BoolArray:
        """Return which zones apply throughout a window, (z,)."""
        whole = (TimeSpan(from_s, to_s),)
        return np.array([spans == whole for spans in self.spans(from_s, to_s)], dtype=bool)

    def _spans(self, from_s: float, to_s: float, margin_s: float) -> tuple[tuple[TimeSpan, ...], ...]:
        return tuple(
            active_spans(schedule, (box[0], box[1], box[2], box[3]), from_s, to_s, margin_s)
            for schedule, box in zip(self.schedules, self.box.tolist(), strict=True)
        )
