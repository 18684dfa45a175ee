"""Context of a manoeuvre: the UAV's state and its controls."""

import math
from dataclasses import dataclass, field

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from operation.reasons import Reason
from simulation.flight.airframe import Airframe, Settings
from simulation.flight.camera import CameraShutter
from simulation.flight.course import Vector, Via, course
from simulation.flight.events import Event, StatusTextSent
from simulation.flight.faults import Faults
from simulation.flight.gimbal import StabilisedGimbal
from simulation.flight.guidance import Gate, Guidance
from simulation.flight.orders import Above, LookAt, Order, OrderPlace, PointCamera, StopPhotos, TakePhotos, Turn
from simulation.flight.plant import GroundElevation
from simulation.flight.states import RallyPoint, Severity


@dataclass
class ManoeuvreContext:
    """Vectors are metres to east, north and up of the home; `here` is the UAV's estimated position.

    `heading_deg` overrides the heading along the course; so does the gimbal's target where the gimbal has no yaw, with precedence.
    """

    airframe: Airframe
    settings: Settings
    ground: GroundElevation
    home: LonLat
    home_amsl_m: float
    frame: LocalFrame
    guidance: Guidance
    gimbal: StabilisedGimbal
    camera: CameraShutter
    speed_mps: float
    faults: Faults = field(default_factory=Faults)
    now_s: float = 0.0
    here: Vector = (0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    agl_m: float = 0.0
    facing_deg: float = 0.0
    rally_points: tuple[RallyPoint, ...] = ()
    flown_m: float = 0.0
    is_armed: bool = False
    is_in_air: bool = False
    heading_deg: float | None = None
    events: list[Event] = field(default_factory=list)

    def report(self, text: Reason | str, severity: Severity = Severity.INFO) -> None:
        self.events.append(StatusTextSent(self.now_s, text, severity))

    def level_of(self, position: LonLat) -> tuple[float, float]:
        """Return east and north of home [m]."""
        east_m = (position.lon - self.home.lon) * self.frame.metres_per_degree_east
        return east_m, (position.lat - self.home.lat) * self.frame.metres_per_degree_north

    def position_of(self, place: Vector) -> LonLat:
        lon = self.home.lon + place[0] / self.frame.metres_per_degree_east
        return LonLat(lon, self.home.lat + place[1] / self.frame.metres_per_degree_north)

    def vector_of(self, place: OrderPlace) -> Vector:
        """Return the place of an order; open values are those of the UAV."""
        east_m, north_m = self.here[:2] if place.position is None else self.level_of(place.position)
        if place.height_m is None:
            return east_m, north_m, self.here[2]
        if place.above is Above.HOME:
            return east_m, north_m, place.height_m
        if place.above is Above.SEA:
            return east_m, north_m, place.height_m - self.home_amsl_m
        ground_m = self.ground.elevation_m(self.position_of((east_m, north_m, 0.0)))
        return east_m, north_m, place.height_m + (ground_m - self.home_amsl_m if math.isfinite(ground_m) else 0.0)

    def look_at(self, place: OrderPlace | None) -> None:
        """Look at a place; None: ahead again."""
        if place is None:
            self.gimbal.centre()
        else:
            self.gimbal.look_at(self.vector_of(place))

    def do(self, order: Order, item: int | None = None) -> bool:
        """Carry out an order to gimbal, nose or camera. Returns False for other orders. item: of the mission that holds the order."""
        if isinstance(order, LookAt):
            self.look_at(order.place)
        elif isinstance(order, PointCamera):
            self.gimbal.turn(order.pitch_deg, order.yaw_deg, is_from_north=order.is_from_north)
            if order.turns_uav and not self.gimbal.pans and order.yaw_deg is not None:
                self.heading_deg = order.yaw_deg % 360.0
        elif isinstance(order, Turn):
            before_deg = self.facing_deg if order.is_relative else 0.0
            self.heading_deg = (before_deg + order.angle_deg) % 360.0
        elif isinstance(order, TakePhotos):
            self.camera.start(order, self.now_s, self.flown_m, item)
        elif isinstance(order, StopPhotos):
            self.camera.stop()
        else:
            return False
        return True

    def look_ahead(self) -> None:
        self.heading_deg = None
        self.gimbal.centre()

    def nearest_rally_point(self) -> Vector:
        """Return the destination of RTL: home or a nearer rally point, with the point's own height."""
        points = [(*self.level_of(rally_point.position), rally_point.height_relative_m) for rally_point in self.rally_points]
        return min([(0.0, 0.0, 0.0), *points], key=lambda point: math.dist(point[:2], self.here[:2]))

    def fly_through(self, vias: list[Via], gates: dict[int, Gate] | None = None) -> None:
        """Fly from here through these points to a stop at the last."""
        self.guidance.follow(course(self.here, vias, self.guidance.speed_limits), self.velocity, gates)

    def fly_to(self, place: Vector) -> None:
        self.fly_through([Via(place, self.speed_mps)])

    def stand(self) -> None:
        """Brake, and hold where the UAV comes to a stop."""
        east, north, up = self.velocity
        speed_mps = math.sqrt(east * east + north * north + up * up)
        if speed_mps < 0.5:
            self.guidance.hold(self.here)
            return
        way = speed_mps / (2.0 * self.airframe.acceleration_mps2)
        x, y, z = self.here
        self.fly_through([Via((x + east * way, y + north * way, z + up * way), speed_mps)])

    def is_there(self, within_m: float) -> bool:
        """Return whether it has stopped at the end of the course."""
        return self.guidance.is_at_end and math.dist(self.guidance.goal, self.here) < within_m
