"""Missions past towers of whole regions, over hills and among zones, rehearsed: an independent witness finds nothing hit or missed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.geos import Point

from inspection.geodesy import LonLat
from inspection.models import Asset, NoFlyZone
from inspection.selectors.planning import heights_at, planning_read
from inspection.services import build_graph, import_osm, mark_ground_changed
from missions.services import PlanRequest, TargetRequest, UavRequest, create_mission, plan_mission
from planning.energy.performance import Performance
from planning.problem import Objective
from planning.request import EndAction
from simulation.assessment.judging import judge
from simulation.rehearsing.flying import fly
from simulation.services.plan_to_fly import plan_to_fly, surroundings_of
from simulation.services.rehearsals import limits_of_settings, vehicle_maker
from tests.missions.flights import an_operator
from tests.missions.oracles.terrain_oracle import Hills
from tests.missions.property_tests.random_flights import cut_out
from tests.missions.property_tests.random_missions import put_random_zones
from tests.simulation.flight_witness import things_hit, waypoints_missed, zones_entered
from tests.simulation.rehearsals.rehearsed import loaded, scenarios

pytestmark = [pytest.mark.django_db, pytest.mark.long]

ASSETS = 300
SPARED_DEG = 0.002
INSPECTOR = Performance(battery_wh=263.2, mass_kg=3.77, max_airspeed_mps=19.0)


def put_zones_beside(spared: list[Any]) -> int:
    """Random zones all over the region but for these places; how many."""
    put_random_zones(3)
    for zone in NoFlyZone.objects.all():
        if any(zone.geometry.distance(Point(*place, srid=4326)) < SPARED_DEG for place in spared):
            zone.delete()
    mark_ground_changed()
    build_graph()
    return NoFlyZone.objects.count()


@pytest.mark.parametrize("conditions", ["calm", "strong-wind"])
@pytest.mark.parametrize("file_name", ["elme-valley.osm.pbf", "quillmoor.osm.pbf", "columbus-ohio.osm.pbf", "nepal-power-2025.osm.pbf"])
def test_a_mission_past_towers_hits_and_misses_nothing(region_file: Any, file_name: str, conditions: str, tmp_path: Path) -> None:
    import_osm(path=region_file(file_name))
    cut_out(ASSETS)
    hills = Hills()
    hills.bring_in(tmp_path / "hills.tif")
    towers = list(Asset.objects.filter(kind="tower", vanished_at=None))
    places = np.array([tower.centre.coords for tower in towers])
    middle = places[np.argmin(np.abs(places - np.median(places, axis=0)).sum(axis=1))]
    nearest = np.argsort(np.hypot(*((places - middle) * (np.cos(np.radians(middle[1])), 1.0)).T))[:40:5]
    uavs = tuple(
        UavRequest(name, LonLat(middle[0] + 0.004 * side, middle[1] + 0.006), None, 9.0, EndAction.RETURN, performance=INSPECTOR)
        for name, side in (("Tern", -1), ("Gull", 1))
    )
    zones = put_zones_beside([uav.position for uav in uavs] + [places[row].tolist() for row in nearest.tolist()])
    request = PlanRequest(uavs, tuple(TargetRequest(towers[row].pk) for row in nearest.tolist()), Objective.MAKESPAN, True)
    person = an_operator()
    mission = create_mission(organisation=person.organisation, author=person, name="Real", request=request)
    mission = plan_mission(mission=mission, actor=person)
    plan, ground = plan_to_fly(loaded(mission)), planning_read().ground()
    (scenario,) = scenarios(mission, conditions)
    maker = vehicle_maker(plan.stand_ins, scenario, heights_at(ground.dataset_version))
    flown = fly(plan.routes, maker, turnaround_s=600.0, seed=5, on_progress=lambda share: None)
    assessment = judge(flown, surroundings_of(plan, ground), limits_of_settings())
    targets = [target for route in assessment.routes for target in route.targets]
    print(
        file_name,
        conditions,
        zones,
        "zones",
        assessment.level,
        len(targets),
        [(str(finding.level), finding.code, dict(finding.facts)) for finding in assessment.findings],
    )
    assert len(targets) >= 3 and zones >= 5
    assert all(stand_in.airframe == "inspector" for stand_in in plan.stand_ins)
    faults = [fault for route in flown for fault in (*waypoints_missed(route), *zones_entered(route), *things_hit(route, hills))]
    assert faults == []
    assert all(target.is_reached for target in targets)
    assert not {"crashed", "unfinished", "zone-entered", "obstacle", "low"} & {finding.code for finding in assessment.findings}
