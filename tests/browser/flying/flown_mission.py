"""A mission that two UAVs have flown, put into the log of an installation: run inside it by `site.does`."""

from datetime import UTC, datetime, timedelta

import numpy as np
import shapely
from django.contrib.gis.geos import Point
from django.db import transaction
from django.utils import timezone

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute
from mavlink.decoding.measurement import Measurement
from missions.models import Approval, InspectionTarget, LinkKind, Mission
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_started, mark_waypoint_reached
from telemetry.models import AlertLevel, PositionEstimate, TelemetryRecord
from telemetry.services import NewRecord, store_records
from telemetry.services.alerts.alerts import open_alert
from telemetry.services.targets_checked import TargetChecks
from tests.telemetry.flown import fly, route_of

AFTER_ALL = 1_000_000_000  # since boot [ms]
BEGAN_AT = datetime(2026, 9, 10, 9, 10, tzinfo=UTC)
SILENT_FROM, SILENT_UNTIL = timedelta(minutes=4), timedelta(minutes=6)


@transaction.atomic
def fly_mission(mission_id: str, *, ends: bool = True) -> None:
    """The first UAV is silent for two minutes and estimated meanwhile; the second leaves a target out. An alert was opened of each."""
    mission = Mission.objects.get(pk=mission_id)
    approval = Approval.objects.get(mission=mission)
    first, second = (entry.uav for entry in mission.mission_uavs.select_related("uav").order_by("sequence"))
    for place, (uav, left_out) in enumerate(((first, None), (second, _most_remote_target(route_of(approval, second))))):
        mark_started(mission_id=mission.pk, uav_id=uav.pk)
        over = fly(approval, uav, BEGAN_AT + timedelta(minutes=2 * place), leaves_out=left_out) + timedelta(seconds=1)
        if ends:
            on_ground = Measurement(altitude_relative_m=0.0, is_armed=False, is_in_air=False)
            store_records([NewRecord(uav.pk, LinkKind.MAVLINK, "flight", AFTER_ALL, over, over, on_ground, mission_id=mission.pk)])
        if ends:
            mark_waypoint_reached(mission_id=mission.pk, uav_id=uav.pk, waypoint=route_of(approval, uav).waypoints[-1].sequence)
            mark_flight_ended(mission_id=mission.pk, uav_id=uav.pk, flight=1, end=FlightEnd.FLOWN)
    _forget_a_stretch(mission, first.pk)
    mission.alerts.all().delete()  # those of the watch, for which these UAVs are silent
    open_alert(uav=first, level=AlertLevel.WARNING, code="link-lost", message="no report for 12 s", mission=mission)
    open_alert(uav=second, level=AlertLevel.ADVISORY, code="off-route", message="300 m off its route", mission=mission)
    mission.alerts.filter(uav=first).update(opened_at=BEGAN_AT + SILENT_FROM + timedelta(seconds=12), closed_at=BEGAN_AT + SILENT_UNTIL)
    mission.alerts.filter(uav=second).update(opened_at=BEGAN_AT + timedelta(minutes=8), closed_at=BEGAN_AT + timedelta(minutes=9))
    if ends:
        InspectionTarget.objects.filter(mission=mission).update(state_at=timezone.now() - timedelta(seconds=10))
        TargetChecks().check([first.pk, second.pk])
        InspectionTarget.objects.filter(mission=mission).update(state_at=BEGAN_AT + timedelta(minutes=20))
        last = TelemetryRecord.objects.filter(mission=mission).latest("measured_at")
        Mission.objects.filter(pk=mission.pk).update(departs_at=BEGAN_AT, started_at=BEGAN_AT, ended_at=last.measured_at)


def _most_remote_target(route: FrozenRoute) -> int:
    """The target's waypoint that the rest of the route stays farthest away from: left out, it is passed at a distance."""
    frame = LocalFrame.around(*route.take_off.position)
    points = frame.to_metres(np.array([waypoint.position for waypoint in route.waypoints]))

    def away_m(number: int) -> float:
        return float(shapely.distance(shapely.Point(points[number]), shapely.LineString(np.delete(points, number, axis=0))))

    targets = [number for number, waypoint in enumerate(route.waypoints) if waypoint.target is not None]
    return route.waypoints[max(targets, key=away_m)].sequence


def _forget_a_stretch(mission: Mission, uav_id: int) -> None:
    """What was measured in it becomes what was estimated."""
    lost = TelemetryRecord.objects.filter(
        mission=mission, uav=uav_id, measured_at__gte=BEGAN_AT + SILENT_FROM, measured_at__lt=BEGAN_AT + SILENT_UNTIL
    )
    rows = []
    for number, record in enumerate(lost.order_by("measured_at")):
        bound_m = 5.0 + 0.8 * number
        rows.append(
            PositionEstimate(
                uav_id=uav_id, mission=mission, estimated_for=record.measured_at, made_at=record.measured_at,
                position=Point(record.position.x, record.position.y, srid=4326), altitude_relative_m=record.altitude_relative_m,
                speed_mps=12.0, heading_deg=record.heading_deg, bound_along_m=bound_m, bound_across_m=6.0, bound_bearing_deg=0.0,
                bound_height_m=5.0, bound_speed_mps=3.0, report_at=BEGAN_AT + SILENT_FROM, is_lost=False,
            )
        )  # fmt: skip
    lost.delete()
    PositionEstimate.objects.bulk_create(rows)
