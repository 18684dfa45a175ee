"""Stores the photos of logged flights: those that no gateway took when they were flown."""

from datetime import UTC, datetime
from pathlib import Path

from django.conf import settings

from mavlink.decoding.flight_log import captures_of_tlog
from missions.models import LinkKind
from telemetry.models import FlightLog
from telemetry.services.captures import CaptureCount, NewCapture, store_captures

AT_ONCE = 500


def store_captures_of_log(log: FlightLog) -> CaptureCount:
    """Store the photos of a flight log; those that are stored are left as they are. Raises OSError without the file."""
    with (Path(settings.FLIGHT_LOG_DIR) / log.path).open("rb") as file:
        new = [
            NewCapture(
                uav_id=log.uav_id,
                link=LinkKind.MAVLINK,
                stream=found.stream,
                received_at=datetime.fromtimestamp(found.received_s, UTC),
                report=found.report,
                mission_item=found.mission_item,
                mission_id=log.mission_id,
            )
            for found in captures_of_tlog(file)
        ]
    counts = [store_captures(new[start : start + AT_ONCE], of_present_mission=False) for start in range(0, len(new), AT_ONCE)]
    return CaptureCount(sum(one.photos for one in counts), sum(one.joined for one in counts), sum(one.known for one in counts))
