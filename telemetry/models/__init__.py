"""Models of links, records, estimates, flights and alerts."""

from telemetry.models.links import FlightLog, UavLink, UnknownVehicle, UnknownVehicleState, VehicleText
from telemetry.models.records import (
    Capture,
    CaptureReport,
    FlightEvent,
    FlightEventKind,
    InspectionResult,
    TelemetryRecord,
    TelemetryStream,
)
from telemetry.models.watching import Alert, AlertLevel, AlertNote, PositionEstimate, UavWatch

__all__ = [
    "Alert",
    "AlertLevel",
    "AlertNote",
    "Capture",
    "CaptureReport",
    "FlightEvent",
    "FlightEventKind",
    "FlightLog",
    "InspectionResult",
    "PositionEstimate",
    "TelemetryRecord",
    "TelemetryStream",
    "UavLink",
    "UavWatch",
    "UnknownVehicle",
    "UnknownVehicleState",
    "VehicleText",
]
