"""From an approved route to a vehicle that holds it: every kind of item is taken, and kept, by both autopilots."""

import pytest

from inspection.geodesy import LonLat
from mavlink.approved_route import END_ACTIONS
from mavlink.fence import fence_of, rally_items
from mavlink.legs import with_points_between
from mavlink.mission_items import flight_loads
from mavlink.mission_sync.outcome import SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.timeouts import TransferRules
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from tests.mavlink.routes import start_and_end, waypoint
from tests.mavlink.test_fence import square
from tests.telemetry.vehicles.channel import Channel
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES, known


@pytest.mark.parametrize("end_action", END_ACTIONS)
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_approved_route_is_held_by_its_hash(autopilot_type: str, end_action: str):
    tasks = [Task(kind, hold_s) for kind in TaskKind for hold_s in (0.0, 3.4, 12.0)]
    points = [
        waypoint(number, WaypointKind.TARGET, task=task, target=number, relative_m=60.0 + 1.37 * number, speed_mps=3.3 + 0.1 * number)
        for number, task in enumerate(tasks, 1)
    ]
    route = start_and_end(*points, end_action=end_action)
    fence = fence_of([square("harbour", 100, 100), square("tower", 300, 200, 33.3)], route)
    rally = rally_items([(LonLat(9.801, 55.401), 42.3)])
    (load,) = flight_loads(route, fence=fence.items, rally=rally)
    load = with_points_between(load, 50.0)
    vehicle = AUTOPILOT_TYPES[autopilot_type]()
    outcome = Channel(MissionSync(load, known(vehicle), ADDRESSING, TransferRules()), vehicle).run()
    assert (outcome.state, outcome.sha256) == (SyncState.READY, load.content_sha256), outcome.differences
