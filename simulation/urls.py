"""URLs of simulation under /api/v1/."""

from django.urls import path

from simulation.views.airframes import Airframes, RehearsalRuleView, UavTypeAirframe
from simulation.views.demo import DemoData
from simulation.views.rehearsals import MissionRehearsals, RehearsalCancel, RehearsalDetail, RehearsalTrackOfRun
from simulation.views.simulations import (
    MissionSimulatedCopy,
    MissionSimulatedFlights,
    SimulatedVehicleDetail,
    SimulationDetail,
    Simulations,
)

urlpatterns = [
    path("missions/<uuid:mission_id>/rehearsals", MissionRehearsals.as_view(), name="api-rehearsals"),
    path("missions/<uuid:mission_id>/rehearsals/<uuid:rehearsal_id>", RehearsalDetail.as_view(), name="api-rehearsal"),
    path("missions/<uuid:mission_id>/rehearsals/<uuid:rehearsal_id>/track", RehearsalTrackOfRun.as_view(), name="api-rehearsal-track"),
    path("missions/<uuid:mission_id>/rehearsals/<uuid:rehearsal_id>/cancel", RehearsalCancel.as_view(), name="api-rehearsal-cancel"),
    path("missions/<uuid:mission_id>/simulated-flights", MissionSimulatedFlights.as_view(), name="api-simulated-flights"),
    path("missions/<uuid:mission_id>/simulated-copy", MissionSimulatedCopy.as_view(), name="api-simulated-copy"),
    path("simulations", Simulations.as_view(), name="api-simulations"),
    path("simulations/<uuid:simulation_id>", SimulationDetail.as_view(), name="api-simulation"),
    path("simulated-vehicles/<uuid:vehicle_id>", SimulatedVehicleDetail.as_view(), name="api-simulated-vehicle"),
    path("airframes", Airframes.as_view(), name="api-airframes"),
    path("uav-types/<int:type_id>/airframe", UavTypeAirframe.as_view(), name="api-uav-type-airframe"),
    path("demo-data", DemoData.as_view(), name="api-demo-data"),
    path("rehearsal-rule", RehearsalRuleView.as_view(), name="api-rehearsal-rule"),
]
