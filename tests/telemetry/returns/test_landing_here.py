"""What lies below a UAV that is told to land where it is."""

from typing import Any

import numpy as np
import pytest

from inspection.services import import_terrain
from missions.models import Uav
from tests.accounts.users import a_user, client_of
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions.flights import an_operator, fleet, ground
from tests.missions.worlds import world, zone_around
from tests.telemetry.returns.test_present_returns import EAST, HOME, estimated, flies
from workspace.models import Organisation, User

pytestmark = pytest.mark.django_db
OVER_LINE = (10.002, 56.00005)  # 6 m north of a span
BESIDE_RAIL = (10.005, 56.0098)  # 22 m south of it


@pytest.fixture
def user() -> User:
    return an_operator()


@pytest.fixture
def uav() -> Uav:
    world()
    return fleet("Tern")[0]


def reported(user: User, uav: Uav) -> dict[str, Any]:
    response = client_of(user).get(f"/api/v1/uavs/{uav.pk}/landing")
    assert response.status_code == 200, response.content
    return dict(response.json())


def test_open_ground_has_its_height_and_slope_and_no_warning(user, uav, tmp_path):
    ground(tmp_path / "plain.tif", 300.0)
    reported(user, uav)  # the first answer of a process takes longer: a report would be old by then
    flies(uav, EAST, height_m=42.0)
    found = reported(user, uav)
    assert (found["warnings"], found["assets"], found["zones"]) == ([], [], [])
    assert (found["altitude_agl_m"], found["slope_deg"]) == (42.0, 0.0)
    assert found["facts"][:3] == [
        "It is 42 m above the ground.", "The ground slopes by 0° there.", "No line, tower, railway or bridge within 30 m.",
    ]  # fmt: skip
    assert "are not in the data" in found["facts"][-1]


def test_wires_and_a_railway_below_and_beside_are_told_with_their_distance(user, uav):
    flies(uav, OVER_LINE)
    found = reported(user, uav)
    assert [(asset["kind"], round(asset["distance_m"])) for asset in found["assets"]] == [("line", 6)]
    assert found["warnings"][0].startswith("Power line ") and found["warnings"][0].endswith(" is 6 m beside where it comes down.")
    flies(uav, BESIDE_RAIL)
    found = reported(user, uav)
    assert [(asset["kind"], round(asset["distance_m"])) for asset in found["assets"]] == [("railway", 22)]
    flies(uav, (10.000, 56.0))
    assert [asset["kind"] for asset in reported(user, uav)["assets"]] == ["line", "tower"] or reported(user, uav)["assets"][0][
        "distance_m"
    ] == 0.0
    assert reported(user, uav)["warnings"][0].endswith(" is below it.")


def test_an_uncertain_place_reaches_farther(user, uav):
    here = (10.002, 56.0005)  # 56 m from the line
    flies(uav, here)
    assert reported(user, uav)["assets"] == []
    flies(uav, here, age_s=30.0, estimated=estimated(here, bound_m=50.0))
    assert [asset["kind"] for asset in reported(user, uav)["assets"]] == ["line"]


def test_a_zone_that_it_comes_down_in_is_named(user, uav):
    zone_around(EAST, 0.0005, name="Fire brigade")
    flies(uav, EAST)
    found = reported(user, uav)
    assert (found["zones"], found["warnings"]) == (["Fire brigade"], ["It comes down in Fire brigade."])


def test_a_steep_slope_is_a_warning_and_no_terrain_is_told(user, uav, tmp_path):
    flies(uav, EAST)
    found = reported(user, uav)
    assert found["slope_deg"] is None and "How steep the ground is there is not known: there is no terrain model." in found["facts"]
    assert found["altitude_agl_m"] is None
    rises = np.broadcast_to(np.arange(300.0) * 30.0, (300, 300)).astype("f4")  # a post lies some 62 m east of the one before
    import_terrain(path=write_geotiff(tmp_path / "slope.tif", rises, srid=9707, origin=(9.9, 56.15)))
    found = reported(user, uav)
    assert found["slope_deg"] > 10.0
    assert found["warnings"] == [f"The ground slopes by {found['slope_deg']:.0f}° there."]


def test_a_place_that_nobody_knows_has_no_ground_below(user, uav):
    flies(uav, None)
    found = reported(user, uav)
    assert found["present"] is None and "what lies below it is not known" in found["warnings"][0]


def test_only_uavs_of_ones_own_organisation_are_told(uav):
    flies(uav, HOME)
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert stranger.get(f"/api/v1/uavs/{uav.pk}/landing").status_code == 404
