"""Decides what media show: what was stated with the upload, else what the UAV reported, else the target next to them, else nothing."""

from collections.abc import Sequence
from datetime import timedelta
from typing import Any

import numpy as np
from django.contrib.gis.geos import LineString, Point

from inspection.geodesy.local_frame import LocalFrame
from inspection.models import Asset
from missions.models import InspectionTarget, Mission, Waypoint
from results.matching.photos import CapturePlace, Placing, TargetPlace, capture_of_photo, place_photo
from results.models import Medium, Placement, TakenAtSource
from telemetry.models import Capture
from workspace.audit import record_change
from workspace.models import User

CERTAIN_TIMES = {TakenAtSource.GPS, TakenAtSource.CAMERA, TakenAtSource.USER}  # in a stated zone
REACH = timedelta(seconds=60)  # of captures that are compared; those with a larger bound say nothing


def place_medium(medium: Medium) -> None:
    """Set target and asset of a medium that was not placed by hand; the caller saves it. Without a clear match it stays unplaced."""
    if medium.placement in (Placement.STATED, Placement.MANUAL):
        if medium.target_id is None and medium.mission_id is not None and medium.asset_id is not None:
            medium.target = _only_target(medium.mission_id, medium.asset_id)
        return
    medium.placement, medium.candidates = Placement.UNPLACED, []
    if (capture := _capture_of(medium)) is not None:
        medium.capture, medium.uav_id = capture, capture.uav_id
        medium.mission_id = medium.mission_id or capture.mission_id
        if (target := _target_of_capture(capture)) is not None:
            medium.target, medium.asset, medium.placement = target, target.asset, Placement.CAPTURED
            return
    if medium.mission_id is None or medium.position is None:
        return
    targets = {row.pk: row for row in InspectionTarget.objects.filter(mission=medium.mission_id).select_related("asset")}
    placing = _placing(medium, list(targets.values()))
    medium.candidates = [_candidate_json(one.key, one.distance_m, one.is_in_visit, targets[one.key]) for one in placing.candidates]
    if placing.chosen is not None:
        medium.target, medium.placement = targets[placing.chosen], Placement.NEAREST
        medium.asset = targets[placing.chosen].asset


def assign_medium(*, medium: Medium, actor: User, mission: Mission | None, target: InspectionTarget | None, asset: Asset | None) -> None:
    """Place a medium by hand; without target and asset it is unplaced."""
    before = placement_facts(medium)
    medium.mission, medium.target = mission, target
    medium.asset = asset if asset is not None else target.asset if target is not None else None
    medium.placement = Placement.UNPLACED if target is None and asset is None else Placement.MANUAL
    medium.save(update_fields=["mission", "target", "asset", "placement", "updated_at"])
    record_change(
        organisation=medium.organisation, actor=actor, action="assign", subject_type="medium", subject_id=medium.pk,
        before=before, after=placement_facts(medium),
    )  # fmt: skip


def placement_facts(medium: Medium) -> dict[str, Any]:
    return {
        "mission": None if medium.mission_id is None else str(medium.mission_id),
        "target": medium.target_id,
        "asset": medium.asset_id,
        "placement": medium.placement,
    }


def _capture_of(medium: Medium) -> Capture | None:
    """Return the reported capture of a medium: of its mission, or, where it has none, of any of the organisation."""
    if medium.taken_at is None or medium.position is None or medium.taken_at_source not in CERTAIN_TIMES:
        return None
    reported = Capture.objects.filter(
        is_taken=True, position__isnull=False, taken_at__gte=medium.taken_at - REACH, taken_at__lte=medium.taken_at + REACH
    )
    own = {"mission": medium.mission_id} if medium.mission_id else {"uav__organisation": medium.organisation_id}
    captures = {one.pk: one for one in reported.filter(**own)}
    frame = LocalFrame.around(medium.position.x, medium.position.y)
    places = [_capture_place(one, frame) for one in captures.values()]
    key = capture_of_photo(medium.taken_at.timestamp(), places)
    return None if key is None else captures[key]


def _target_of_capture(capture: Capture) -> InspectionTarget | None:
    """Return the target of the waypoint at which a photo was taken."""
    if capture.waypoint_sequence is None or capture.mission_id is None:
        return None
    of_route = Waypoint.objects.filter(route__mission=capture.mission_id, route__mission_uav__uav=capture.uav_id)
    waypoint = of_route.filter(sequence=capture.waypoint_sequence).select_related("target__asset").first()
    return None if waypoint is None else waypoint.target


def _capture_place(capture: Capture, frame: LocalFrame) -> CapturePlace:
    assert capture.position is not None  # noqa: S101
    [[east_m, north_m]] = frame.to_metres(np.array([capture.position.coords[:2]], dtype=np.float64))
    return CapturePlace(
        key=capture.pk,
        group=f"{capture.mission_id} {capture.uav_id} {capture.waypoint_sequence}",
        taken_s=capture.taken_at.timestamp(),
        east_m=float(east_m),
        north_m=float(north_m),
        time_bound_s=capture.time_bound_s or 0.0,
        position_bound_m=capture.position_bound_m or 0.0,
    )


def _only_target(mission_id: Any, asset_id: int) -> InspectionTarget | None:
    found = list(InspectionTarget.objects.filter(mission=mission_id, asset=asset_id)[:2])
    return found[0] if len(found) == 1 else None


def _placing(medium: Medium, targets: Sequence[InspectionTarget]) -> Placing:
    assert medium.position is not None  # noqa: S101
    frame = LocalFrame.around(medium.position.x, medium.position.y)
    places = [TargetPlace(target.pk, outline, _visit_s(target)) for target in targets if (outline := _outline(target, frame)) is not None]
    is_certain = medium.taken_at is not None and medium.taken_at_source in CERTAIN_TIMES
    taken_s = medium.taken_at.timestamp() if is_certain and medium.taken_at is not None else None
    return place_photo(taken_s, places)


def _visit_s(target: InspectionTarget) -> tuple[float, float] | None:
    if target.reached_at is None:
        return None
    begin_s = target.reached_at.timestamp()
    return begin_s, begin_s + (target.held_s or 0.0)


def _outline(target: InspectionTarget, frame: LocalFrame) -> tuple[tuple[float, float], ...] | None:
    """Return a target's points in metres: a stretch, a position, else its asset's line or centre."""
    place: LineString | Point | None = target.stretch or target.position
    if place is None and target.asset is not None:
        geometry = target.asset.geometry
        place = geometry if isinstance(geometry, LineString) else target.asset.centre
    if place is None:
        return None
    points = [place.coords] if isinstance(place, Point) else place.coords
    metres = frame.to_metres(np.array([point[:2] for point in points], dtype=np.float64))
    return tuple((float(east_m), float(north_m)) for east_m, north_m in metres)


def _candidate_json(key: int, distance_m: float, is_in_visit: bool | None, target: InspectionTarget) -> dict[str, Any]:
    return {
        "target": key,
        "asset": target.asset_id,
        "label": target.label,
        "distance_m": round(distance_m, 1),
        "is_in_visit": is_in_visit,
    }
