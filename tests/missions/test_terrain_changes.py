"""Missions hold heights that came from the terrain: when that changes, they say so."""

from functools import partial
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest
from django.test import Client

from inspection.models import TerrainTile
from inspection.selectors import ground_heights_m
from inspection.selectors.planning import DatasetVersion
from inspection.services import import_terrain
from inspection.services.imports.terrain import remove_terrain
from missions.selectors import planning_context
from missions.services import make_plan
from tests.accounts.users import a_user, client_of
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions.api import mission_body, post
from tests.missions.planning.test_planning import request
from tests.missions.worlds import World
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def ground(path: Path, height_m: float, *, origin: tuple[float, float] = (9.9, 56.15)) -> Any:
    return import_terrain(path=write_geotiff(path, np.full((300, 300), height_m, dtype="f4"), srid=9707, origin=origin))


def created(client: Client, here: World) -> dict[str, Any]:
    return post(client, "missions", mission_body({"asset": here.towers[2].pk}, plan=True)).json()


def reason(client: Client, mission: dict[str, Any]) -> str:
    found = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert found["is_stale"] == bool(found["stale_reason"])
    return found["stale_reason"]


def test_ground_that_rose_under_a_route_is_said_in_metres(here: World, client: Client, tmp_path: Path) -> None:
    ground(tmp_path / "hills.tif", 100)
    mission = created(client, here)
    assert reason(client, mission) == ""
    ground(tmp_path / "hills.tif", 123)
    assert reason(client, mission) == "The terrain changed since this was planned. Under the route of Tern it differs by up to 23 m."
    post(client, f"missions/{mission['id']}/plan")
    assert reason(client, mission) == ""


def test_terrain_elsewhere_touches_no_route(here: World, client: Client, tmp_path: Path) -> None:
    ground(tmp_path / "hills.tif", 100)
    mission = created(client, here)
    ground(tmp_path / "far.tif", 500, origin=(20.0, 10.0))
    assert reason(client, mission) == "The ground has changed since this was planned. No zone in force touches the routes."


def test_terrain_that_was_taken_away_leaves_a_route_over_unknown_ground(here: World, client: Client, tmp_path: Path) -> None:
    model = ground(tmp_path / "hills.tif", 100)
    mission = created(client, here)
    remove_terrain(data_import=model, actor=a_user(Role.CURATOR))
    assert reason(client, mission) == "The terrain changed since this was planned. Under a route it is no longer known."


def test_terrain_that_came_in_is_said_where_flat_ground_was_assumed(here: World, client: Client, tmp_path: Path) -> None:
    mission = created(client, here)
    ground(tmp_path / "hills.tif", 100)
    assert reason(client, mission) == "The terrain changed since this was planned. Terrain has come in: Tern flies as over flat ground."


def test_heights_are_worked_out_again_where_the_terrain_changes_meanwhile(here: World, tmp_path: Path) -> None:
    ground(tmp_path / "hills.tif", 100)
    looked = []

    def changing(positions: np.ndarray, dataset_version: DatasetVersion) -> np.ndarray:
        heights = ground_heights_m(positions, dataset_version)
        if not looked:
            ground(tmp_path / "hills.tif", 300)
        looked.append(len(positions))
        return heights

    def changing_at(dataset_version: DatasetVersion) -> Any:
        return partial(changing, dataset_version=dataset_version)

    with mock.patch.object(planning_context, "heights_at", changing_at):
        plan = make_plan(request=request(here.towers[5]))
    assert len(looked) > 1
    assert TerrainTile.objects.exists()
    assert {round(point["altitude_amsl_m"] - point["altitude_agl_m"]) for route in plan["routes"] for point in route["waypoints"]} == {300}
