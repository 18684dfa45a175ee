"""Models of links, records, estimates, flights and alerts."""

from telemetry.models.alerts import Alert, AlertLevel, AlertNote
from telemetry.models.captures import Capture, CaptureReport
from telemetry.models.flights import FlightEvent, FlightEventKind
from telemetry.models.links import FlightLog, UavLink, UnknownVehicle, UnknownVehicleState, VehicleText
from telemetry.models.records import InspectionResult, TelemetryRecord, TelemetryStream
from telemetry.models.watching import PositionEstimate, UavWatch

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
