"""Missions that photograph every part of towers: a camera, a UAV with it, terrain, and requests for missions."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.test import Client

from inspection.services import import_terrain
from missions.models import Uav, UavType
from missions.selectors import photo_flights
from planning.views.camera import camera_to_json
from planning.views.catalogue import catalogue
from planning.views.view_plan import ViewPlan, detail_plan
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions.api import post
from workspace.models import Organisation

CAMERA = catalogue()["dji-m30t-zoom"].camera
MASL_M = 100.0
_plans: dict[bytes, ViewPlan] = {}


def plan_photos_once(patch: pytest.MonkeyPatch) -> None:
    """Until the patch is undone, plan photos of the same site with the same camera once for all tests of this process."""

    def planned(*values: Any) -> ViewPlan:
        key = pickle.dumps(values)
        if key not in _plans:
            _plans[key] = detail_plan(*values)
        return _plans[key]

    patch.setattr(photo_flights, "detail_plan", planned)


def terrain(folder: Path, *, origin: tuple[float, float] = (9.9, 56.15)) -> None:
    import_terrain(path=write_geotiff(folder / "hills.tif", np.full((300, 300), MASL_M, dtype="f4"), srid=9707, origin=origin))


def tern(**of_type: Any) -> Uav:
    kind = UavType.objects.create(name="Tern", cruise_speed_mps=12.0, max_range_m=20_000.0, cameras=[camera_to_json(CAMERA)], **of_type)
    organisation = Organisation.objects.first()
    return Uav.objects.create(organisation=organisation, name="Tern", uav_type=kind, location="POINT(10.001 55.995)", is_simulated=True)


def body(*targets: dict[str, Any], uav: Uav | None = None) -> dict[str, Any]:
    return {"name": "Photos", "plan": True, "return_to_start": True, "uavs": [{"id": (uav or tern()).pk}], "targets": list(targets)}


def made(client: Client, asked: dict[str, Any]) -> dict[str, Any]:
    response = post(client, "missions", asked)
    assert response.status_code == 201, response.content
    return response.json()
