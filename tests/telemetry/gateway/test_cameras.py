"""The gateway asks a vehicle's camera for its figures, keeps them and tells them."""

from pathlib import Path

import pytest

from missions.models import Uav, UavType
from planning.views.camera import camera_to_json
from planning.views.catalogue import catalogue
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from telemetry.models import UavLink
from tests.accounts.users import a_user, client_of
from tests.simulation.fleets import flying, free_port
from tests.simulation.flight.lists import HOME
from tests.telemetry.gateway.program import gateway_program
from tests.telemetry.gateway.station import wait_for

pytestmark = pytest.mark.django_db(transaction=True)


@pytest.mark.long
@pytest.mark.parametrize("autopilot_type", list(SimulatedAutopilot))
def test_what_a_camera_reports_is_kept_and_told(autopilot_type: SimulatedAutopilot, uav: Uav, tmp_path: Path) -> None:
    port, camera = free_port(), catalogue()["dji-m30t-wide"].camera
    launch = Launch(7, HOME, autopilot_type=autopilot_type, talks_to=[("127.0.0.1", port)], camera=camera)
    with gateway_program(port, tmp_path), flying([launch], speed=1.0):
        wait_for(lambda: UavLink.objects.filter(uav=uav).exclude(cameras=[]).exists(), "the camera's figures")
    (reported,) = client_of(a_user()).get(f"/api/v1/uavs/{uav.pk}/connection").json()["cameras"]
    assert (reported["pixels_wide"], reported["pixels_high"]) == (camera.pixels_wide, camera.pixels_high)
    assert reported["focal_length_mm"] == pytest.approx(camera.focal_lengths_mm[0], abs=1e-3)
    assert reported["name"].startswith("Simulated ") and not reported["is_of_type"]
    uav.uav_type = UavType.objects.create(organisation=uav.organisation, name="Wide", cameras=[camera_to_json(camera)])
    uav.save()
    assert client_of(a_user()).get(f"/api/v1/uavs/{uav.pk}/connection").json()["cameras"][0]["is_of_type"]
