"""Finds the capture that a UAV reported for a photo, and the target at whose waypoint it was taken."""

from datetime import timedelta

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from missions.models import InspectionTarget, Waypoint
from results.matching.captures import CapturePlace, capture_of_photo
from results.models import Medium, TakenAtSource
from telemetry.models import Capture

CERTAIN_TIMES = {TakenAtSource.GPS, TakenAtSource.CAMERA, TakenAtSource.USER}  # in a stated zone
REACH = timedelta(seconds=60)  # of captures that are compared; those with a larger bound say nothing


def capture_of(medium: Medium) -> Capture | None:
    """Return the reported capture of a medium: of its mission, or, where it has none, of any of the organisation."""
    if medium.taken_at is None or medium.position is None or medium.taken_at_source not in CERTAIN_TIMES:
        return None
    reported = Capture.objects.filter(
        is_taken=True, position__isnull=False, taken_at__gte=medium.taken_at - REACH, taken_at__lte=medium.taken_at + REACH
    )
    own = {"mission": medium.mission_id} if medium.mission_id else {"uav__organisation": medium.organisation_id}
    captures = {one.pk: one for one in reported.filter(**own)}
    frame = LocalFrame.around(medium.position.x, medium.position.y)
    places = [_place(one, frame) for one in captures.values()]
    key = capture_of_photo(medium.taken_at.timestamp(), places)
    return None if key is None else captures[key]


def target_of_capture(capture: Capture) -> InspectionTarget | None:
    """Return the target of the waypoint at which a photo was taken."""
    if capture.waypoint_sequence is None or capture.mission_id is None:
        return None
    of_route = Waypoint.objects.filter(route__mission=capture.mission_id, route__mission_uav__uav=capture.uav_id)
    waypoint = of_route.filter(sequence=capture.waypoint_sequence).select_related("target__asset").first()
    return None if waypoint is None else waypoint.target


def _place(capture: Capture, frame: LocalFrame) -> CapturePlace:
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
