"""Unknown vehicles seen by gateways: one row per system id, which bounds the table."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from django.db import connection

NOTE = """
INSERT INTO telemetry_unknownvehicle
    (mavlink_system_id, autopilot, vehicle_type, address, is_signed, state, heard_at, location)
SELECT system, autopilot, vehicle_type, address, is_signed, 'new', last_message_at,
    ST_SetSRID(ST_MakePoint(longitude_deg, latitude_deg), 4326)
FROM unnest(%s::int4[], %s::text[], %s::text[], %s::text[], %s::bool[], %s::timestamptz[], %s::float8[], %s::float8[])
    AS received(system, autopilot, vehicle_type, address, is_signed, last_message_at, longitude_deg, latitude_deg)
WHERE system BETWEEN 1 AND 254 AND NOT EXISTS (SELECT 1 FROM missions_uav uav WHERE uav.mavlink_system_id = received.system)
ORDER BY system
ON CONFLICT (mavlink_system_id) DO UPDATE SET heard_at = excluded.heard_at, autopilot = excluded.autopilot,
    vehicle_type = excluded.vehicle_type, address = excluded.address, is_signed = excluded.is_signed,
    location = coalesce(excluded.location, telemetry_unknownvehicle.location),
    state = CASE WHEN telemetry_unknownvehicle.state = 'adopted' THEN 'new' ELSE telemetry_unknownvehicle.state END
"""


@dataclass(frozen=True)
class Sighting:
    """One sighting. `is_signed`: the frame has a signature, which could not be verified."""

    system: int
    autopilot: str
    vehicle_type: str
    address: str
    is_signed: bool
    last_message_at: datetime
    longitude_deg: float | None = None
    latitude_deg: float | None = None


def note_unknown_vehicles(*, sightings: Sequence[Sighting]) -> None:
    """Store sightings, one per system id. An adopted vehicle whose UAV was deleted becomes new again; an ignored one stays ignored."""
    if not sightings:
        return
    columns = ("system", "autopilot", "vehicle_type", "address", "is_signed", "last_message_at", "longitude_deg", "latitude_deg")
    with connection.cursor() as cursor:
        cursor.execute(NOTE, [[getattr(sighting, column) for sighting in sightings] for column in columns])
