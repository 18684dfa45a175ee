"""URLs of the UAV link and of the log under /api/v1/."""

from django.urls import include, path, register_converter

from telemetry.views.alert_limits import MissionAlertLimits, UavTypeAlertLimits
from telemetry.views.alerts import (
    AlertAcknowledgement,
    AlertClosing,
    AlertCounts,
    AlertDetail,
    AlertNotes,
    Alerts,
    EndedAlertsAcknowledgement,
)
from telemetry.views.captures import CAPTURE_KINDS, MissionCaptures, MissionCapturesFile
from telemetry.views.estimates import MissionEstimates
from telemetry.views.exports import KINDS, MissionTelemetryFile, UavTelemetryFile
from telemetry.views.live import Live
from telemetry.views.log_filters import LatestTelemetry, TelemetryLog
from telemetry.views.mission_record import RESULT_KINDS, MissionRecord, MissionRecordFile, MissionResultsFile
from telemetry.views.preflight import MissionPreflight
from telemetry.views.results import Results
from telemetry.views.returns import PresentReturnsView, UavLanding
from telemetry.views.unknown_vehicles import UnknownVehicleAdoption, UnknownVehicleIgnoring, UnknownVehicles
from telemetry.views.vehicle_logs import FlightLogFile, FlightLogs, UavConnection, VehicleTexts


class FileKindConverter:
    """The extension of an exported file."""

    regex = "|".join(KINDS)

    def to_python(self, value: str) -> str:
        return value

    def to_url(self, value: str) -> str:
        return value


class ResultKindConverter(FileKindConverter):
    regex = "|".join(RESULT_KINDS)


class CaptureKindConverter(FileKindConverter):
    regex = "|".join(CAPTURE_KINDS)


register_converter(CaptureKindConverter, "capture_kind")
register_converter(FileKindConverter, "file_kind")
register_converter(ResultKindConverter, "result_kind")

urlpatterns = [
    path("uav-link/", include("telemetry.uav_link_urls")),
    path("unknown-vehicles", UnknownVehicles.as_view(), name="api-unknown-vehicles"),
    path("unknown-vehicles/<int:vehicle_id>/adopt", UnknownVehicleAdoption.as_view(), name="api-unknown-vehicle-adoption"),
    path("unknown-vehicles/<int:vehicle_id>/ignore", UnknownVehicleIgnoring.as_view(), name="api-unknown-vehicle-ignoring"),
    path("alerts", Alerts.as_view(), name="api-alerts"),
    path("alerts/acknowledge-ended", EndedAlertsAcknowledgement.as_view(), name="api-ended-alerts-acknowledgement"),
    path("alerts/counts", AlertCounts.as_view(), name="api-alert-counts"),
    path("alerts/<int:alert_id>", AlertDetail.as_view(), name="api-alert"),
    path("alerts/<int:alert_id>/acknowledge", AlertAcknowledgement.as_view(), name="api-alert-acknowledgement"),
    path("alerts/<int:alert_id>/close", AlertClosing.as_view(), name="api-alert-closing"),
    path("alerts/<int:alert_id>/notes", AlertNotes.as_view(), name="api-alert-notes"),
    path("uav-types/<int:type_id>/alert-limits", UavTypeAlertLimits.as_view(), name="api-uav-type-alert-limits"),
    path("missions/<uuid:mission_id>/alert-limits", MissionAlertLimits.as_view(), name="api-mission-alert-limits"),
    path("results", Results.as_view(), name="api-results"),
    path("returns", PresentReturnsView.as_view(), name="api-returns"),
    path("live", Live.as_view(), name="api-live"),
    path("telemetry", TelemetryLog.as_view(), name="api-telemetry"),
    path("missions/<uuid:mission_id>/preflight", MissionPreflight.as_view(), name="api-mission-preflight"),
    path("missions/<uuid:mission_id>/record", MissionRecord.as_view(), name="api-mission-record"),
    path("missions/<uuid:mission_id>/record.zip", MissionRecordFile.as_view(), name="api-mission-record-file"),
    path("missions/<uuid:mission_id>/results.<result_kind:kind>", MissionResultsFile.as_view(), name="api-mission-results-file"),
    path("missions/<uuid:mission_id>/captures", MissionCaptures.as_view(), name="api-mission-captures"),
    path("missions/<uuid:mission_id>/captures.<capture_kind:kind>", MissionCapturesFile.as_view(), name="api-mission-captures-file"),
    path("missions/<uuid:mission_id>/estimates", MissionEstimates.as_view(), name="api-mission-estimates"),
    path("missions/<uuid:mission_id>/telemetry.<file_kind:kind>", MissionTelemetryFile.as_view(), name="api-mission-telemetry-file"),
    path("uavs/<int:uav_id>/telemetry.<file_kind:kind>", UavTelemetryFile.as_view(), name="api-uav-telemetry-file"),
    path("uavs/<int:uav_id>/telemetry/latest", LatestTelemetry.as_view(), name="api-latest-telemetry"),
    path("uavs/<int:uav_id>/landing", UavLanding.as_view(), name="api-uav-landing"),
    path("uavs/<int:uav_id>/connection", UavConnection.as_view(), name="api-uav-connection"),
    path("uavs/<int:uav_id>/vehicle-texts", VehicleTexts.as_view(), name="api-vehicle-texts"),
    path("uavs/<int:uav_id>/flight-logs", FlightLogs.as_view(), name="api-flight-logs"),
    path("uavs/<int:uav_id>/flight-logs/<int:log_id>/file", FlightLogFile.as_view(), name="api-flight-log-file"),
]
