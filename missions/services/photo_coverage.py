"""What photos prove of each photographed target of a mission: promised by the plan, rehearsed in simulation, achieved in flight."""

import contextlib
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache as once
from typing import Any
from uuid import UUID

import numpy as np
from django.core.cache import cache
from django.db.models import QuerySet

from inspection.geodesy.local_frame import LocalFrame
from inspection.models import Asset
from inspection.selectors.planning import DatasetVersion, current_dataset_version
from missions.hooks.taken_photos import PhotoOfMission, RehearsedPhotos, achieved_photos, rehearsed_photos
from missions.models import InspectionTarget, Mission
from missions.selectors.inspection_sites import SiteOnMap, UnfitBridge, site_on_map
from missions.selectors.photo_flights import KEPT_S, kept_by
from missions.services.view_plans import coverage_json
from planning.task import MM_PER_M, ViewPattern, ViewsRequest, task_from_json
from planning.trajectory.waypoints import WaypointKind
from planning.views.proof import MAX_AWAY_M, ProofSurface, TakenPhoto, flown_camera, proof_surface, why_not_counted
from planning.views.span_views import wires_solid
from planning.views.visibility import axes_of
from workspace.cache_unavailable import CACHE_UNAVAILABLE
from workspace.jobs.planning_lock import hold_planning_lock

VERSION = 1  # counts the changes of what a proof is made by, or is kept as
MAX_OFF_M, MAX_OFF_DEG = 0.5, 1.0  # of a photo from its plan: beyond, it is reported
SAME_PLACE_M = 5.0  # between a photo whose waypoint is unknown and the planned one that it is compared with
SHORT_SHARE = 0.02  # of the area: a target is short where so much less was achieved than promised
MIN_PROMISED_SHARE = 0.1  # of a component's area: if nothing of it was achieved, it is missing

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class PlannedPhoto:
    """uav: its place in the mission; waypoint: of its route."""

    uav: int
    waypoint: int
    photo: TakenPhoto
    focal_mm: float


@dataclass(frozen=True, eq=False)
class TakenByTarget:
    """All photos of a mission by targets. rehearsed: of each run."""

    planned: Mapping[int, Sequence[PlannedPhoto]]
    rehearsed: Sequence[tuple[RehearsedPhotos, Mapping[int, Sequence[PhotoOfMission]]]]
    achieved: Mapping[int, Sequence[PhotoOfMission]] | None


def photographed_targets(mission: Mission) -> QuerySet[InspectionTarget]:
    """Return the targets that are photographed from planned poses."""
    return InspectionTarget.objects.filter(mission=mission, task__has_key="views").select_related("asset")


def coverage_of_targets(mission: Mission, targets: Sequence[InspectionTarget], rehearsal: UUID | None = None) -> Iterator[Json]:
    """Yield what photos prove of each of the targets. mission: as loaded by mission_of_organisation.

    rehearsal: whose photos count as rehearsed, None: the newest. Raises LookupError where the mission has no such rehearsal.
    """
    taken = _taken(mission, rehearsal)
    version = current_dataset_version()
    return (_of_target(target, taken, version) for target in targets)


def _taken(mission: Mission, rehearsal: UUID | None) -> TakenByTarget:
    planned, take_off_m = _planned(mission)
    centres = {row.pk: row.asset.centre.coords for row in photographed_targets(mission) if row.asset is not None}
    by_target = _Matching(planned, centres)
    achieved = achieved_photos(mission)
    return TakenByTarget(
        planned,
        [(run, by_target.of(run.photos)) for run in rehearsed_photos(mission, rehearsal)],
        None if achieved is None else by_target.of([_over_sea(photo, take_off_m) for photo in achieved]),
    )


def _planned(mission: Mission) -> tuple[dict[int, list[PlannedPhoto]], dict[tuple[int, int], float]]:
    """Return the planned photos by target, and the height above the sea of each take-off by UAV and flight (from 1)."""
    planned: dict[int, list[PlannedPhoto]] = {}
    take_off_m: dict[tuple[int, int], float] = {}
    for route in mission.routes.all():
        uav, flight = route.mission_uav.sequence, 1
        for row in route.waypoints.all():
            if row.altitude_amsl_m is not None:
                if row.kind == WaypointKind.BASE:
                    flight += 1
                    take_off_m[uav, flight] = row.altitude_amsl_m
                take_off_m.setdefault((uav, flight), row.altitude_amsl_m - row.altitude_relative_m)
            task = task_from_json(row.task)
            if task is None or task.view is None or row.target_id is None or row.altitude_amsl_m is None:
                continue
            view = task.view
            lon, lat = row.position.coords[:2]
            photo = TakenPhoto(lon, lat, row.altitude_amsl_m, view.yaw_deg, view.pitch_deg)
            planned.setdefault(row.target_id, []).append(PlannedPhoto(uav, row.sequence, photo, view.focal_length_mm))
    return planned, take_off_m


def _over_sea(own: PhotoOfMission, take_off_m: Mapping[tuple[int, int], float]) -> PhotoOfMission:
    """Return the photo with its height above take-off, where it is known, as the height above the sea.

    Routes are flown above take-off; the height above the sea that an autopilot reports has the error of its first fix.
    """
    ground_m = None if own.uav is None else take_off_m.get((own.uav, own.flight))
    if own.relative_m is None or ground_m is None:
        return own
    return replace(own, photo=replace(own.photo, amsl_m=ground_m + own.relative_m))


class _Matching:
    """Gives photos to targets: by their waypoint, unless they are far from there and near another target; else by the nearest planned one.

    Near is up to MAX_AWAY_M. A target of which no photos are planned counts from its tower.
    """

    def __init__(self, planned: Mapping[int, Sequence[PlannedPhoto]], centres: Mapping[int, tuple[float, ...]]) -> None:
        self._target = {(one.uav, one.waypoint): target for target, photos in planned.items() for one in photos}
        rows = [(target, lon, lat) for target, (lon, lat) in centres.items() if not planned.get(target)]
        rows += [(target, one.photo.lon or 0.0, one.photo.lat or 0.0) for target, photos in planned.items() for one in photos]
        self._keys = np.array([target for target, _, _ in rows])
        places = np.array([(lon, lat) for _, lon, lat in rows], dtype=np.float64).reshape(-1, 2)
        self._frame = LocalFrame.around(*places.mean(axis=0).tolist()) if len(places) else None
        self._places = places if self._frame is None else self._frame.to_metres(places)

    def of(self, photos: Sequence[PhotoOfMission]) -> dict[int, list[PhotoOfMission]]:
        found: dict[int, list[PhotoOfMission]] = {}
        for own in photos:
            target = self._target_of(own)
            if target is not None:
                found.setdefault(target, []).append(own)
        return found

    def _target_of(self, own: PhotoOfMission) -> int | None:
        by_waypoint = None if own.uav is None or own.waypoint is None else self._target.get((own.uav, own.waypoint))
        if self._frame is None or own.photo.lon is None or own.photo.lat is None:
            return by_waypoint
        away_m = np.linalg.norm(self._places - self._frame.to_metres(np.array([[own.photo.lon, own.photo.lat]])), axis=1)
        near = away_m <= MAX_AWAY_M
        if not near.any() or (self._keys[near] == by_waypoint).any():
            return by_waypoint
        return int(self._keys[away_m.argmin()])


def _of_target(target: InspectionTarget, taken: TakenByTarget, version: DatasetVersion) -> Json:
    task = task_from_json(target.task)
    assert task is not None and task.views is not None  # noqa: S101 - as photographed_targets chooses
    planned, views = taken.planned.get(target.pk, []), task.views
    found: Json = {
        "target": target.sequence, "label": target.label, "asset": target.asset_id, "camera": views.camera.name,
        "gsd_mm": round(views.gsd_m * MM_PER_M, 6), "focal_length_mm": planned[0].focal_mm if planned else None,
        "promised": None, "rehearsed": [], "achieved": None, "is_short": None, "missing": [],
    }  # fmt: skip
    if target.asset is None or not planned:
        return found
    prove = _Proving(target.asset, views, planned, version)
    found["promised"] = prove.shown([one.photo for one in planned])
    if found["promised"] is None:
        return found
    for run, photos in taken.rehearsed:
        own = photos.get(target.pk, [])
        found["rehearsed"].append({
            "rehearsal": run.rehearsal, "run": run.run, "code": run.code, "name": run.name, "is_outdated": run.is_outdated,
            **(prove.shown([one.photo for one in own]) or {}), "deviations": [] if run.is_outdated else _deviations(planned, own),
        })  # fmt: skip
    if taken.achieved is not None:
        own = taken.achieved.get(target.pk, [])
        found["achieved"] = {**(prove.shown([one.photo for one in own]) or {}), "deviations": _deviations(planned, own)}
        promised, achieved = found["promised"]["coverage"], found["achieved"]["coverage"]
        found["missing"] = list(_missing(promised["components"], achieved["components"]))
        found["is_short"] = bool(found["missing"]) or promised["shown"] - achieved["shown"] > SHORT_SHARE
    return found


def _missing(promised: Sequence[Json], achieved: Sequence[Json]) -> Iterator[Json]:
    """Yield the components of which some was promised and nothing is achieved."""
    for before, after in zip(promised, achieved, strict=True):
        if before["shown"] >= MIN_PROMISED_SHARE and after["shown"] == 0.0:
            yield {"component": before["component"], "number": before["number"]}


class _Proving:
    """Proves photos of one target; what was proven before is kept. The tower is read and cut into patches once it is needed."""

    def __init__(self, asset: Asset, views: ViewsRequest, planned: Sequence[PlannedPhoto], version: DatasetVersion) -> None:
        self._focal_mm = planned[0].focal_mm
        self._by = kept_by(asset.pk, views, version) | {"proof": VERSION, "focal_mm": self._focal_mm}
        self._site: Callable[[], tuple[SiteOnMap, ProofSurface] | None] = once(lambda: _site(asset, views))

    def shown(self, photos: Sequence[TakenPhoto]) -> Json | None:
        """Return what the photos show, in the shape of the API; None where the tower is none any more."""
        rows = [(one.lon, one.lat, one.amsl_m, one.yaw_deg, one.pitch_deg, one.roll_deg, one.is_taken) for one in photos]
        key = "photo-proof:" + hashlib.sha256(json.dumps([self._by, rows], sort_keys=True).encode()).hexdigest()
        with contextlib.suppress(*CACHE_UNAVAILABLE):
            kept: Json | None = cache.get(key)
            if kept is not None:
                return kept
        site = self._site()
        if site is None:
            return None
        found, surface = site
        with hold_planning_lock():
            proof = surface.proof(photos, self._focal_mm, found.frame, found.base_amsl_m)
        value = {
            "photos": proof.counted,
            "not_counted": [{"reason": str(reason), "count": count} for reason, count in sorted(proof.not_counted.items())],
            "coverage": coverage_json(proof.coverage, proof.components),
        }
        with contextlib.suppress(*CACHE_UNAVAILABLE):
            cache.set(key, value, KEPT_S)
        return value


def _site(asset: Asset, views: ViewsRequest) -> tuple[SiteOnMap, ProofSurface] | None:
    try:
        found = site_on_map(asset, views)
    except UnfitBridge:
        return None
    if found is None:
        return None
    with hold_planning_lock():
        wires = wires_solid(found.site) if views.pattern is ViewPattern.SPANS else None
        return found, proof_surface(found.site, flown_camera(views.camera), views.gsd_m, wires)


def _deviations(planned: Sequence[PlannedPhoto], taken: Sequence[PhotoOfMission]) -> list[Json]:
    """Return the planned photos that were not taken, or with another position or direction than planned; numbered from 1 in planned order.

    not_counted: why one that was taken counts for nothing.
    """
    why = [(own, why_not_counted(own.photo)) for own in taken]
    counted = [own for own, reason in why if reason is None]
    found = []
    for number, one in enumerate(planned, start=1):
        own = [_off(one.photo, other.photo) for other in counted if (other.uav, other.waypoint) == (one.uav, one.waypoint)]
        own = own or [off for other in counted if other.waypoint is None and (off := _off(one.photo, other.photo))[0] <= SAME_PLACE_M]
        off_m, off_deg = min(own, default=(None, None), key=lambda off: (off[0] / MAX_OFF_M) + off[1] / MAX_OFF_DEG)
        if off_m is None or off_deg is None or off_m > MAX_OFF_M or off_deg > MAX_OFF_DEG:
            reasons = [] if own else [reason for other, reason in why if (other.uav, other.waypoint) == (one.uav, one.waypoint)]
            reason = str(reasons[0]) if reasons else None
            found.append(
                {"photo": number, "uav": one.uav, "waypoint": one.waypoint, "off_m": off_m, "off_deg": off_deg, "not_counted": reason}
            )
    return found


def _off(planned: TakenPhoto, taken: TakenPhoto) -> tuple[float, float]:
    """Return metres between two known poses, and degrees between their optical axes."""
    values = np.array([[one.lon, one.lat, one.amsl_m, one.yaw_deg, one.pitch_deg] for one in (planned, taken)], dtype=np.float64)
    place = LocalFrame.around(float(values[0, 0]), float(values[0, 1])).to_metres(values[:, :2])
    _, _, forward = axes_of(values[:, 3], values[:, 4])
    off_deg = float(np.degrees(np.arccos(np.clip(forward[0] @ forward[1], -1.0, 1.0))))
    return float(np.linalg.norm([*(place[1] - place[0]), values[1, 2] - values[0, 2]])), off_deg
