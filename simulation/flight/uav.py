"""A simulated UAV: takes a mission and orders, is stepped, and reports its state. Uses no clock and no socket."""

import math
from collections.abc import Sequence

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from operation.reasons import Reason
from planning.views.camera import Camera
from simulation.flight.airframe import Airframe, Settings
from simulation.flight.autopilot import Autopilot
from simulation.flight.body import Body
from simulation.flight.camera import SIMULATED_CAMERA, CameraShutter
from simulation.flight.events import Event
from simulation.flight.faults import Faults, Weather
from simulation.flight.gimbal import StabilisedGimbal
from simulation.flight.guidance import Guidance
from simulation.flight.manoeuvre_context import ManoeuvreContext
from simulation.flight.manoeuvres import GoTo, Hold, Land, Manoeuvre, Return, TakeOffManoeuvre
from simulation.flight.mission import MissionManoeuvre, first_to_fly
from simulation.flight.orders import CannotFly, Order, orders
from simulation.flight.plant import FlatGround, GroundElevation
from simulation.flight.states import (
    DONE,
    FlightMode,
    Gps,
    Landed,
    MissionItemState,
    OrderRefused,
    Outcome,
    RallyPoint,
    Severity,
    SimulatedState,
)

NO_FIX, FIX = Gps(0, 0, 99.9), Gps(3, 14, 0.7)
SETTLES_S = 2.0  # on the ground, until the model is at rest
MIN_SPEED_MPS = 0.2


def reported(
    body: Body,
    context: ManoeuvreContext,
    manoeuvre: Manoeuvre,
    *,
    current_item: int,
    mission: MissionItemState,
    is_crashed: bool,
    is_gps_lost: bool,
) -> SimulatedState:
    motion = body.motion
    volts, amperes = body.volts_and_amperes()
    return SimulatedState(
        at_s=context.now_s,
        position=context.position_of(context.here),
        true_position=body.position,
        altitude_amsl_m=motion.altitude_amsl_m,
        altitude_relative_m=context.here[2],
        altitude_agl_m=body.agl_m,
        velocity_ned_mps=(motion.north_mps, motion.east_mps, motion.down_mps),
        roll_deg=math.degrees(motion.roll_rad),
        pitch_deg=math.degrees(motion.pitch_rad),
        heading_deg=context.facing_deg,
        roll_rate_dps=math.degrees(motion.roll_rad_s),
        pitch_rate_dps=math.degrees(motion.pitch_rad_s),
        yaw_rate_dps=math.degrees(motion.yaw_rad_s),
        airspeed_mps=0.0 if is_crashed else body.plant.airspeed_mps,
        ground_speed_mps=math.hypot(motion.north_mps, motion.east_mps),
        wind_ned_mps=body.air.wind_ned_mps,
        battery_percent=body.battery_percent,
        battery_used_wh=body.used_wh,
        battery_v=volts,
        battery_a=amperes,
        is_armed=context.is_armed,
        is_in_air=context.is_in_air,
        landed=_landed(context, manoeuvre),
        mode=manoeuvre.mode,
        is_crashed=is_crashed,
        gps=NO_FIX if is_gps_lost else FIX,
        current_item=current_item,
        mission_state=mission,
        home=context.home,
        home_amsl_m=context.home_amsl_m,
        target_speed_mps=context.speed_mps,
        gimbal=context.gimbal.attitude,
        photos=context.camera.number,
    )


def _landed(context: ManoeuvreContext, manoeuvre: Manoeuvre) -> Landed:
    if not context.is_in_air:
        return Landed.TAKING_OFF if context.is_armed and manoeuvre.lifts_off else Landed.ON_GROUND
    if manoeuvre.is_landing:
        return Landed.LANDING
    return Landed.TAKING_OFF if manoeuvre.mode is FlightMode.TAKE_OFF else Landed.IN_AIR


class SimulatedUav:
    """A UAV that stands disarmed on the ground at `home` when `now_s` is 0.

    `step` advances 0.04 s and never raises during a flight: a diverged model counts as a crash. Equal airframe, place, weather, seed and
    orders at equal steps give bit-identical flights. `weather`, `faults` and `settings` can be replaced at any time.
    """

    def __init__(
        self,
        airframe: Airframe,
        home: LonLat,
        *,
        ground: GroundElevation | None = None,
        weather: Weather | None = None,
        seed: int = 0,
        heading_deg: float = 0.0,
        battery_percent: float = 100.0,
        settings: Settings | None = None,
        faults: Faults | None = None,
        camera: Camera = SIMULATED_CAMERA,
        physics_hz: int = 250,
    ) -> None:
        if not (abs(home.lon) <= 180.0 and abs(home.lat) < 89.9 and math.isfinite(heading_deg) and 0.0 <= battery_percent <= 100.0):
            raise ValueError("A UAV stands somewhere on earth, faces somewhere, and its battery holds from 0 to 100 %.")
        ground = ground or FlatGround()
        self.airframe, self.camera = airframe, camera
        self._body = body = Body(
            airframe,
            home,
            ground=ground,
            weather=weather or Weather(),
            seed=seed,
            heading_deg=heading_deg,
            battery_percent=battery_percent,
            physics_hz=physics_hz,
        )
        self._context = ManoeuvreContext(
            airframe=airframe,
            settings=settings or Settings(),
            ground=ground,
            home=home,
            home_amsl_m=body.home_amsl_m,
            frame=body.frame,
            guidance=Guidance(airframe),
            gimbal=StabilisedGimbal(camera.gimbal),
            camera=CameraShutter(camera.min_interval_s),
            speed_mps=airframe.cruise_speed_mps,
            facing_deg=heading_deg,
        )
        self.items: tuple[MissionItem, ...] = ()
        self._orders: tuple[Order, ...] = ()
        self._first = 0
        self._mission: MissionManoeuvre | None = None
        self._pilot = Autopilot(body, self._context, camera.offset_m)
        self._state: SimulatedState | None = None
        self._reported_at = -1
        self.faults = faults or Faults()

    # --- input -------------------------------------------------------------------------------------------------------------------------

    @property
    def weather(self) -> Weather:
        return self._body.air.weather

    @weather.setter
    def weather(self, weather: Weather) -> None:
        self._body.air.change(weather)

    @property
    def settings(self) -> Settings:
        return self._context.settings

    @settings.setter
    def settings(self, settings: Settings) -> None:
        self._context.settings = settings

    @property
    def rally_points(self) -> tuple[RallyPoint, ...]:
        """Return the rally points: RTL flies to the nearest, or home if that is nearer."""
        return self._context.rally_points

    @rally_points.setter
    def rally_points(self, rally_points: tuple[RallyPoint, ...]) -> None:
        self._context.rally_points = rally_points

    @property
    def faults(self) -> Faults:
        return self._context.faults

    @faults.setter
    def faults(self, faults: Faults) -> None:
        before = self._context.faults
        if faults.motor_failed != before.motor_failed:
            self._body.plant.fail_motor(faults.motor_failed)
            if faults.motor_failed is not None:
                self._context.report(f"Motor {faults.motor_failed + 1} has failed", Severity.CRITICAL)
        if faults.battery_wh_left is not None and faults.battery_wh_left != before.battery_wh_left:
            self._body.weaken(faults.battery_wh_left)
        self._context.faults = faults
        self._pilot.revision += 1

    def load(self, items: Sequence[MissionItem], *, is_home_first: bool = False) -> Outcome:
        """Load the whole list, or nothing if it is refused. `is_home_first`: item 0 is home and not flown, as on ArduPilot.

        A mission in progress continues with the first item of the new list from the UAV's position.
        """
        try:
            read = orders(items, is_home_first=is_home_first)
        except CannotFly as error:
            return OrderRefused(error.code, str(error))
        self.items, self._orders, self._first = tuple(items), read, first_to_fly(read, is_home_first=is_home_first)
        self._mission = MissionManoeuvre(read, self._first) if len(read) > self._first else None
        self._pilot.revision += 1
        if self._pilot.manoeuvre.mode is FlightMode.MISSION:
            self._pilot.begin(self._mission or Hold())
        return DONE

    def clear(self) -> Outcome:
        return self.load(())

    def arm(self) -> Outcome:
        if self.is_crashed:
            return OrderRefused("crashed", "The UAV has crashed.")
        if self._context.is_armed:
            return DONE
        if self.battery_percent <= self.settings.battery_critical_percent:
            return OrderRefused("battery", Reason("battery_holds", {"percent": round(self.battery_percent)}))
        if self.is_gps_lost:
            return OrderRefused("gps", Reason("no_gps_fix"))
        self._pilot.arm()
        return DONE

    def disarm(self, *, force: bool = False) -> Outcome:
        if self._context.is_in_air and not force:
            return OrderRefused("in-air", "The UAV is in the air.")
        self._pilot.disarm()
        return DONE

    def take_off(self, height_relative_m: float | None = None) -> Outcome:
        """Climb vertically; an unarmed UAV does so once armed. None: to the height in the settings."""
        height_m = self.settings.take_off_height_m if height_relative_m is None else height_relative_m
        if not (math.isfinite(height_m) and 0.5 <= height_m <= 1_000.0):
            return OrderRefused("height", Reason("take_off_not_flown", {"height": height_m}))
        return self._order(TakeOffManoeuvre(height_m))

    def set_mode(self, mode: FlightMode) -> Outcome:
        if mode is FlightMode.MISSION:
            return self._fly_mission()
        if mode is FlightMode.TAKE_OFF:
            return self.take_off()
        if mode is FlightMode.GO_TO:
            return self._order(Hold()) if self._pilot.manoeuvre.mode is not FlightMode.GO_TO else DONE
        return self._order(Return() if mode is FlightMode.RETURN else Land() if mode is FlightMode.LAND else Hold())

    def hold(self) -> Outcome:
        return self.set_mode(FlightMode.HOLD)

    def land(self) -> Outcome:
        return self.set_mode(FlightMode.LAND)

    def return_home(self) -> Outcome:
        return self.set_mode(FlightMode.RETURN)

    def go_to(self, position: LonLat, altitude_relative_m: float, heading_deg: float | None = None) -> Outcome:
        if not (abs(position.lon) <= 180.0 and abs(position.lat) <= 90.0 and abs(altitude_relative_m) <= 10_000.0):
            return OrderRefused("place", "That is no place to fly to.")
        if not self._context.is_in_air:
            return OrderRefused("on-ground", "The UAV is on the ground.")
        east_m, north_m = self._context.level_of(position)
        outcome = self._order(GoTo((east_m, north_m, altitude_relative_m)))
        if outcome.is_done and heading_deg is not None and math.isfinite(heading_deg):
            self._context.heading_deg = heading_deg % 360.0
        return outcome

    def change_speed(self, speed_mps: float) -> Outcome:
        """Set the ground speed until a mission item changes it."""
        if not (math.isfinite(speed_mps) and speed_mps > 0.0):
            return OrderRefused("speed", "A speed is above 0.")
        self._context.speed_mps = min(max(speed_mps, MIN_SPEED_MPS), self.airframe.max_speed_mps)
        self._pilot.revision += 1
        if (
            self._context.is_in_air
            and not self._pilot.manoeuvre.is_landing
            and self._pilot.manoeuvre.mode in (FlightMode.MISSION, FlightMode.GO_TO)
        ):
            self._pilot.manoeuvre.begin(self._context)
        return DONE

    def set_current(self, index: int) -> Outcome:
        """Set the item to fly next."""
        if not self._first <= index < len(self._orders):
            return OrderRefused("index", f"There is no item {index} to fly.")
        self._mission = MissionManoeuvre(self._orders, index)
        self._pilot.revision += 1
        if self._pilot.manoeuvre.mode is FlightMode.MISSION:
            self._pilot.begin(self._mission)
        return DONE

    def operate(self, item: MissionItem) -> Outcome:
        """Carry out an item to gimbal, nose or camera at once, as a command does."""
        try:
            (order,) = orders((item,), is_home_first=False)
        except CannotFly as error:
            return OrderRefused(error.code, str(error))
        return DONE if self._context.do(order) else OrderRefused("unsupported", "It is an order for missions alone.")

    def _fly_mission(self) -> Outcome:
        if self._mission is None:
            return OrderRefused("no-mission", Reason("no_mission"))
        if self._mission.is_done:
            if self._context.is_in_air:
                return OrderRefused("complete", "The mission is complete.")
            self._mission = MissionManoeuvre(self._orders, self._first)
        return self._order(self._mission)

    def _order(self, manoeuvre: Manoeuvre) -> Outcome:
        if self.is_crashed:
            return OrderRefused("crashed", "The UAV has crashed.")
        self._context.look_ahead()
        self._pilot.begin(manoeuvre)
        return DONE

    def step(self) -> None:
        """Advance 0.04 s of simulated time."""
        self._pilot.step()

    # --- output ------------------------------------------------------------------------------------------------------------------------

    @property
    def now_s(self) -> float:
        """Return the simulated seconds since the start."""
        return self._pilot.now_s

    @property
    def is_crashed(self) -> bool:
        return self._pilot.is_crashed

    @property
    def is_gps_lost(self) -> bool:
        return self._pilot.is_gps_lost

    def take_events(self) -> list[Event]:
        """Return the events since the last call."""
        events, self._context.events = self._context.events, []
        return events

    @property
    def is_armed(self) -> bool:
        return self._context.is_armed

    @property
    def mission_state(self) -> MissionItemState:
        return self._mission_state()

    @property
    def battery_percent(self) -> float:
        return self._body.battery_percent

    @property
    def true_place(self) -> tuple[float, float, float, float, float]:
        """Return seconds, lon, lat, height above home and above ground; cheaper than `state`, for long recordings."""
        motion, context = self._body.motion, self._context
        return self.now_s, motion.lon_deg, motion.lat_deg, context.here[2], context.agl_m

    @property
    def state(self) -> SimulatedState:
        """Return the state of this step, computed on demand."""
        if self._state is None or self._reported_at != self._pilot.revision:
            self._reported_at = self._pilot.revision
            self._state = reported(
                self._body,
                self._context,
                self._pilot.manoeuvre,
                current_item=self._current_item(),
                mission=self._mission_state(),
                is_crashed=self.is_crashed,
                is_gps_lost=self.is_gps_lost,
            )
        return self._state

    def _current_item(self) -> int:
        mission = self._mission
        return 0 if mission is None else min(mission.index, len(self._orders) - 1)

    def _mission_state(self) -> MissionItemState:
        mission = self._mission
        if mission is None:
            return MissionItemState.NONE
        if mission.is_done:
            return MissionItemState.COMPLETE
        if self._pilot.manoeuvre is mission:
            return MissionItemState.ACTIVE
        return MissionItemState.NOT_STARTED if mission.index == self._first else MissionItemState.PAUSED
