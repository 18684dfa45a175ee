"""Photos of a model of a tower, planned and flown by the simulated UAV: for tests and benchmarks."""

from typing import NamedTuple

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import LAND, FrozenRoute, FrozenWaypoint, TakeOff
from mavlink.mission_items import flight_loads
from planning.energy.conditions import Conditions
from planning.task import Task, TaskKind, ViewsRequest
from planning.trajectory.photo_flights import photo_legs_of, with_photo_flights
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from planning.views.camera import Camera
from planning.views.coverage import coverage_of
from planning.views.photo_flight import SPEED_MPS, photo_flight
from planning.views.solids import patches_of
from planning.views.view_plan import ViewPlan
from planning.views.visibility import Poses, RayCaster, axes_of
from simulation.flight.airframe import AIRFRAMES, Settings
from simulation.flight.events import PhotoTaken
from simulation.flight.faults import Weather
from simulation.flight.flown import Ending, FlownFlightLog, fly_mission
from simulation.flight.uav import SimulatedUav
from simulation.rehearsing.weather_scenario import Named, named_scenario
from tests.planning.views.geometry_oracle import to_triangles_m, to_wires_m
from tests.planning.views.towers import StandingTower

FRAME = LocalFrame.around(9.0, 47.0)
AWAY_M = 250.0  # the take-off from the tower, across its line
HIGH_M = 80.0  # of the way there
PATCH_M = 0.8


class Flown(NamedTuple):
    """Of one tower in one weather: spare_m is the nearest approach beyond the clearance; the worst of the photos; shares of the surface."""

    spare_m: float
    away_m: float
    off_deg: float
    photos: int
    taken: int
    planned_share: float
    flown_share: float


def flown(stands: StandingTower, plan: ViewPlan, camera: Camera, code: Named, *, turns_to_target: bool = True) -> Flown:
    """Fly the plan of a tower in a weather; turns_to_target as in Settings. Raises RuntimeError where it is not flown to its end."""
    _, log = flight_of(stands, plan, camera, code, turns_to_target=turns_to_target)
    metres = FRAME.to_metres(np.array([[sample.lon, sample.lat] for sample in log.samples]))
    places = np.column_stack([metres, [sample.altitude_relative_m for sample in log.samples]])
    near = places[np.hypot(*metres.T) < AWAY_M / 2.0]
    poses = _poses([event for event in log.events if isinstance(event, PhotoTaken)])
    planned = plan.poses
    count = min(len(poses), len(planned))
    away_m = np.linalg.norm(poses.position[:count] - planned.position[:count], axis=1)
    return Flown(
        _nearest_m(stands, near) - stands.clearance_m,
        float(away_m.max(initial=0.0)),
        float(_angles_deg(poses, planned, count).max(initial=0.0)),
        len(planned),
        len(poses),
        _share(stands, planned, plan, camera),
        _share(stands, poses, plan, camera),
    )


def flight_of(
    stands: StandingTower, plan: ViewPlan, camera: Camera, code: Named, *, turns_to_target: bool = True
) -> tuple[FrozenRoute, FlownFlightLog]:
    """Return the route through the photos and the log of its flight. Raises as `flown`."""
    route = _route(stands, plan, camera)
    scenario = named_scenario(code, Conditions())
    weather = Weather(scenario.conditions, scenario.gusts_mps, turbulence_mps_at_20ft=scenario.turbulence_mps_at_20ft)
    settings = Settings(turns_to_target=turns_to_target)
    uav = SimulatedUav(
        AIRFRAMES["inspector"], route.take_off.position, weather=weather, seed=33, camera=camera, settings=settings
    )  # fmt: skip
    if not uav.load(flight_loads(route)[0].mission).is_done:
        raise RuntimeError("the UAV does not take the items")
    log = fly_mission(uav)
    if log.ending is not Ending.LANDED:
        raise RuntimeError(f"the flight ended {log.ending}")
    return route, log


def _route(stands: StandingTower, plan: ViewPlan, camera: Camera) -> FrozenRoute:
    """From a place beside the line over the tower, through the photos, and back."""
    flight = photo_flight(plan, FRAME, 0.0, lambda places: np.zeros(len(places)), stands.clearance_m, camera.gimbal)
    start, tower = LonLat(*FRAME.to_degrees(np.array([[AWAY_M, 0.0]]))[0].tolist()), LonLat(*FRAME.origin)
    high_m = max(HIGH_M, float(flight.agl_m.max()) + 2.0)
    points = RoutePoints.of([
        RoutePoint(start, WaypointKind.START, high_m),
        RoutePoint(tower, WaypointKind.TARGET, high_m, target=0, task=Task(TaskKind.PHOTO, 3.0, views=ViewsRequest(0.002, camera))),
        RoutePoint(start, WaypointKind.END, high_m),
    ])  # fmt: skip
    whole = with_photo_flights(Waypoints(points, points.agl_m.copy(), points.agl_m.copy()), {0: flight})
    slow = photo_legs_of(whole.points)
    waypoints = tuple(
        FrozenWaypoint(
            number, point.position, point.kind, point.agl_m, relative_m, amsl_m, point.task, point.target,
            SPEED_MPS if slow[number] else None,
        )
        for number, (point, amsl_m, relative_m) in enumerate(whole)
    )  # fmt: skip
    return FrozenRoute("Tern", TakeOff(start, 0.0), 10.0, LAND, waypoints)


def _poses(photos: list[PhotoTaken]) -> Poses:
    places = FRAME.to_metres(np.array([photo.pose.position for photo in photos], dtype=np.float64).reshape(-1, 2))
    up_m = np.array([photo.pose.altitude_amsl_m for photo in photos])
    yaw, pitch = (np.array([getattr(photo.pose, name) for photo in photos]) for name in ("yaw_deg", "pitch_deg"))
    return Poses(np.column_stack([places, up_m]), yaw, pitch)


def _angles_deg(one: Poses, other: Poses, count: int) -> np.ndarray:
    """Between the optical axes of the first photos of both."""
    axes = [axes_of(poses.yaw_deg[:count], poses.pitch_deg[:count])[2] for poses in (one, other)]
    return np.degrees(np.arccos(np.clip(np.einsum("ni,ni->n", *axes), -1.0, 1.0)))


def _share(stands: StandingTower, poses: Poses, plan: ViewPlan, camera: Camera) -> float:
    """Of the whole surface, on patches finer than the planner's."""
    patches = patches_of(stands.solid, PATCH_M)
    shown = coverage_of(poses, plan.lens, camera, patches, RayCaster([stands.solid])).shown
    return float(patches.area_m2[shown].sum() / patches.area_m2.sum())


def _nearest_m(stands: StandingTower, places: np.ndarray) -> float:
    low = places[places[:, 2] < float(stands.solid.box[1][2]) + 40.0]
    nearest = to_triangles_m(low, stands.solid.triangles).min()
    for start, end in ((0, 1), (2, 0)):
        nearest = min(nearest, to_wires_m(low, stands.supports, start, end).min())
    return float(nearest)
