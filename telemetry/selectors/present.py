"""Present positions of UAVs: measured, or estimated with an uncertainty."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np
from django.utils.dateparse import parse_datetime

from inspection.geodesy import LonLat
from inspection.network.zones.zone_index import METRES_PER_DEGREE_LAT, METRES_PER_DEGREE_LON
from missions.models import Uav
from telemetry.models import UavLink, UavWatch

LAST_SPEED_MPS = 10.0  # assumed for a UAV without a reported speed
MEASURED_FOR_S = 2.0  # age up to which a report counts as present


@dataclass(frozen=True)
class PresentPosition:
    """Present position of a UAV. `altitude_relative_m` is above its take-off; None: unknown.

    age_s            since the report that it is based on
    uncertainty_m    radius that contains it with 95 %; `along_m` and `across_m` along and across `bearing_deg` give the ellipse
    """

    position: LonLat
    altitude_relative_m: float | None
    is_measured: bool
    age_s: float
    along_m: float = 0.0
    across_m: float = 0.0
    bearing_deg: float = 0.0

    @property
    def uncertainty_m(self) -> float:
        return max(self.along_m, self.across_m)

    def places(self) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        """Return the position, and the ends of both axes of the ellipse if it has one: (n, 2), lon, lat [deg]."""
        middle = np.array([self.position], dtype=np.float64)
        if self.uncertainty_m <= 0.0:
            return middle
        angle = np.radians([self.bearing_deg, self.bearing_deg + 180.0, self.bearing_deg + 90.0, self.bearing_deg + 270.0])
        length_m = np.array([self.along_m, self.along_m, self.across_m, self.across_m])
        per_degree = np.array([METRES_PER_DEGREE_LON * np.cos(np.radians(self.position.lat)), METRES_PER_DEGREE_LAT])
        ends: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = np.concatenate(
            [middle, middle + length_m[:, None] * np.column_stack([np.sin(angle), np.cos(angle)]) / per_degree]
        )
        return ends


@dataclass(frozen=True)
class LastReceived:
    """A UAV with its present state. `battery` is the estimator's forecast, `battery_age_s` old; see battery_forecast.py."""

    uav: Uav
    present: PresentPosition | None = None
    is_in_air: bool | None = None
    mode: str = ""
    home: LonLat | None = None
    home_amsl_m: float | None = None
    battery_percent: float | None = None
    battery: Mapping[str, Any] | None = None
    battery_age_s: float | None = None
    altitude_agl_m: float | None = None
    altitude_amsl_m: float | None = None
    speed_mps: float | None = None
    waypoint_sequence: int | None = None


def last_received(uavs: Iterable[Uav], now: datetime) -> list[LastReceived]:
    """Return the present state of the UAVs, in their order."""
    found = list(uavs)
    keys = [uav.pk for uav in found]
    links = {link.uav_id: link for link in UavLink.objects.filter(uav__in=keys)}
    watches = {watch.uav_id: watch for watch in UavWatch.objects.filter(uav__in=keys)}
    return [_received(uav, links.get(uav.pk), watches.get(uav.pk), now) for uav in found]


def _received(uav: Uav, link: UavLink | None, watch: UavWatch | None, now: datetime) -> LastReceived:
    measured: dict[str, Any] = {} if watch is None or not watch.measured else watch.measured
    estimated: dict[str, Any] | None = None if watch is None else watch.estimated
    state, heights = measured.get("state", {}), measured.get("height", {})
    is_in_air = state.get("is_in_air")
    if link is not None and link.is_in_air is not None:
        is_in_air = link.is_in_air
    waypoint = measured.get("waypoint", {}).get("waypoint_sequence")
    return LastReceived(
        uav,
        present=_present(measured, estimated, now),
        is_in_air=is_in_air,
        mode=(link.mode if link is not None else "") or state.get("mode") or "",
        home=None if link is None or link.home is None else LonLat(*link.home.coords[:2]),
        home_amsl_m=None if link is None else link.home_amsl_m,
        battery_percent=measured.get("battery", {}).get("battery_percent"),
        battery=(estimated or {}).get("battery"),
        battery_age_s=None if not estimated else _age_s(estimated["at"], now),
        altitude_agl_m=heights.get("altitude_agl_m"),
        altitude_amsl_m=heights.get("altitude_amsl_m"),
        speed_mps=measured.get("speed", {}).get("speed_mps"),
        waypoint_sequence=waypoint if estimated is None else estimated.get("waypoint_sequence", waypoint),
    )


def _present(measured: Mapping[str, Any], estimated: Mapping[str, Any] | None, now: datetime) -> PresentPosition | None:
    """Return the estimate if there is a current one; else the last report, with the distance flown since at its last speed as bound."""
    reported, report = measured.get("position"), measured.get("report", {})
    age_s = None
    if reported is not None:
        is_newest = reported["measured_at"] == report.get("measured_at")
        age_s = _age_s(report["received_at"] if is_newest else reported["measured_at"], now)
    if estimated is not None and not estimated["is_lost"] and (age_s is None or _age_s(estimated["at"], now) <= max(age_s, MEASURED_FOR_S)):
        bound = estimated["bound"]
        return PresentPosition(
            LonLat(*estimated["position"]),
            estimated["altitude_relative_m"],
            is_measured=bool(estimated["is_measured"]),
            age_s=_age_s(estimated["at"], now) if age_s is None else age_s,
            along_m=bound["along_m"],
            across_m=bound["across_m"],
            bearing_deg=bound["bearing_deg"],
        )
    if reported is None or age_s is None:
        return None
    speed_mps = measured.get("speed", {}).get("speed_mps")
    off_m = 0.0 if age_s <= MEASURED_FOR_S else age_s * (LAST_SPEED_MPS if speed_mps is None else float(speed_mps))
    height_m = measured.get("height", {}).get("altitude_relative_m")
    return PresentPosition(LonLat(*reported["position"]), height_m, is_measured=True, age_s=age_s, along_m=off_m, across_m=off_m)


def _age_s(at: str, now: datetime) -> float:
    moment = parse_datetime(at)
    return 0.0 if moment is None else max((now - moment).total_seconds(), 0.0)
