"""What happens in the air."""

from telemetry.models.alerts import Alert, AlertLevel
from telemetry.models.links import FlightLog, UavLink, UnknownVehicle, UnknownVehicleState, VehicleText
from telemetry.models.records import InspectionResult, TelemetryRecord, TelemetryStream

__all__ = [
    "Alert",
    "AlertLevel",
    "FlightLog",
    "InspectionResult",
    "TelemetryRecord",
    "TelemetryStream",
    "UavLink",
    "UnknownVehicle",
    "UnknownVehicleState",
    "VehicleText",
]
