"""A simulated UAV: it is given a mission and orders, stepped, and asked for its state. It knows no clock and no socket."""

import math
from collections.abc import Sequence

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.flight.airframe import Airframe, Settings
from simulation.flight.autopilot import Autopilot
from simulation.flight.body import Body
from simulation.flight.camera import Camera
from simulation.flight.events import Event
from simulation.flight.faults import Faults, Weather
from simulation.flight.guidance import Guidance
from simulation.flight.manoeuvre_context import Cockpit
from simulation.flight.manoeuvres import GoTo, Hold, Land, Manoeuvre, Return, TakeOff
from simulation.flight.mission import Mission, first_to_fly
from simulation.flight.orders import CannotFly, Order, orders
from simulation.flight.plant import FlatGround, Ground
from simulation.flight.states import DONE, Gps, Haven, Landed, MissionState, Mode, Outcome, Refused, Severity, UavState

NO_FIX, FIX = Gps(0, 0, 99.9), Gps(3, 14, 0.7)
SETTLES_S = 2.0  # on the ground, until the model rests
MIN_SPEED_MPS = 0.2


def reported(
    body: Body, cockpit: Cockpit, manoeuvre: Manoeuvre, *, current_item: int, mission: MissionState, is_crashed: bool, is_gps_lost: bool
) -> UavState:
    motion = body.motion
    volts, amperes = body.volts_and_amperes()
    return UavState(
        at_s=cockpit.now_s,
        position=cockpit.position_of(cockpit.here),
        true_position=body.position,
        altitude_amsl_m=motion.altitude_amsl_m,
        altitude_relative_m=cockpit.here[2],
        altitude_agl_m=body.agl_m,
        velocity_ned_mps=(motion.north_mps, motion.east_mps, motion.down_mps),
        roll_deg=math.degrees(motion.roll_rad),
        pitch_deg=math.degrees(motion.pitch_rad),
        heading_deg=cockpit.facing_deg,
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
        is_armed=cockpit.is_armed,
        is_in_air=cockpit.is_in_air,
        landed=_landed(cockpit, manoeuvre),
        mode=manoeuvre.mode,
        is_crashed=is_crashed,
        gps=NO_FIX if is_gps_lost else FIX,
        current_item=current_item,
        mission_state=mission,
        home=cockpit.home,
        home_amsl_m=cockpit.home_amsl_m,
        target_speed_mps=cockpit.speed_mps,
    )


def _landed(cockpit: Cockpit, manoeuvre: Manoeuvre) -> Landed:
    if not cockpit.is_in_air:
        return Landed.TAKING_OFF if cockpit.is_armed and manoeuvre.lifts_off else Landed.ON_GROUND
    if manoeuvre.is_landing:
        return Landed.LANDING
    return Landed.TAKING_OFF if manoeuvre.mode is Mode.TAKE_OFF else Landed.IN_AIR


class SimulatedUav:
    """Stands disarmed on the ground at `home`, where `now_s` is 0.

    `step` advances 0.04 s and never raises for what a flight can bring: a state that is no number any more is a crash. The same airframe,
    place, weather, seed and orders at the same steps give the same flight to the last bit. `weather`, `faults` and `settings` can be
    replaced at any time.
    """

    def __init__(
        self,
        airframe: Airframe,
        home: LonLat,
        *,
        ground: Ground | None = None,
        weather: Weather | None = None,
        seed: int = 0,
        heading_deg: float = 0.0,
        battery_percent: float = 100.0,
        settings: Settings | None = None,
        faults: Faults | None = None,
        physics_hz: int = 250,
    ) -> None:
        if not (abs(home.lon) <= 180.0 and abs(home.lat) < 89.9 and math.isfinite(heading_deg) and 0.0 <= battery_percent <= 100.0):
            raise ValueError("A UAV stands somewhere on earth, faces somewhere, and its battery holds from 0 to 100 %.")
        ground = ground or FlatGround()
        self.airframe = airframe
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
        self._cockpit = Cockpit(
            airframe=airframe,
            settings=settings or Settings(),
            ground=ground,
            home=home,
            home_amsl_m=body.home_amsl_m,
            frame=body.frame,
            guidance=Guidance(airframe),
            camera=Camera(),
            speed_mps=airframe.cruise_speed_mps,
            facing_deg=heading_deg,
        )
        self.items: tuple[MissionItem, ...] = ()
        self._orders: tuple[Order, ...] = ()
        self._first = 0
        self._mission: Mission | None = None
        self._pilot = Autopilot(body, self._cockpit)
        self._state: UavState | None = None
        self._told_at = -1
        self.faults = faults or Faults()

    # --- what it is told -----------------------------------------------------------------------------------------------------------

    @property
    def weather(self) -> Weather:
        return self._body.air.weather

    @weather.setter
    def weather(self, weather: Weather) -> None:
        self._body.air.change(weather)

    @property
    def settings(self) -> Settings:
        return self._cockpit.settings

    @settings.setter
    def settings(self, settings: Settings) -> None:
        self._cockpit.settings = settings

    @property
    def havens(self) -> tuple[Haven, ...]:
        """Rally points: a return leads to the nearest of them, or home where that is nearer."""
        return self._cockpit.havens

    @havens.setter
    def havens(self, havens: tuple[Haven, ...]) -> None:
        self._cockpit.havens = havens

    @property
    def faults(self) -> Faults:
        return self._cockpit.faults

    @faults.setter
    def faults(self, faults: Faults) -> None:
        before = self._cockpit.faults
        if faults.motor_failed != before.motor_failed:
            self._body.plant.fail_motor(faults.motor_failed)
            if faults.motor_failed is not None:
                self._cockpit.report(f"Motor {faults.motor_failed + 1} has failed", Severity.CRITICAL)
        if faults.battery_wh_left is not None and faults.battery_wh_left != before.battery_wh_left:
            self._body.weaken(faults.battery_wh_left)
        self._cockpit.faults = faults
        self._pilot.revision += 1

    def load(self, items: Sequence[MissionItem], *, is_home_first: bool = False) -> Outcome:
        """The whole list or, refused, nothing of it. `is_home_first`: item 0 is home and not flown, as ArduPilot has it.

        A mission under way goes on with the first item of the new list, from where the UAV is.
        """
        try:
            read = orders(items, is_home_first=is_home_first)
        except CannotFly as error:
            return Refused(error.code, str(error))
        self.items, self._orders, self._first = tuple(items), read, first_to_fly(read, is_home_first=is_home_first)
        self._mission = Mission(read, self._first) if len(read) > self._first else None
        self._pilot.revision += 1
        if self._pilot.manoeuvre.mode is Mode.MISSION:
            self._pilot.begin(self._mission or Hold())
        return DONE

    def clear(self) -> Outcome:
        return self.load(())

    def arm(self) -> Outcome:
        if self.is_crashed:
            return Refused("crashed", "The UAV has crashed.")
        if self._cockpit.is_armed:
            return DONE
        if self.battery_percent <= self.settings.battery_critical_percent:
            return Refused("battery", f"The battery holds {self.battery_percent:.0f} %.")
        if self.is_gps_lost:
            return Refused("gps", "There is no GPS fix.")
        self._pilot.arm()
        return DONE

    def disarm(self, *, force: bool = False) -> Outcome:
        if self._cockpit.is_in_air and not force:
            return Refused("in-air", "The UAV is in the air.")
        self._pilot.disarm()
        return DONE

    def take_off(self, height_relative_m: float | None = None) -> Outcome:
        """Straight up; a UAV that is not armed yet does so once it is. None: as high as the settings have it."""
        height_m = self.settings.take_off_height_m if height_relative_m is None else height_relative_m
        if not (math.isfinite(height_m) and 0.5 <= height_m <= 1_000.0):
            return Refused("height", f"A take-off to {height_m:g} m is not flown.")
        return self._order(TakeOff(height_m))

    def set_mode(self, mode: Mode) -> Outcome:
        if mode is Mode.MISSION:
            return self._fly_mission()
        if mode is Mode.TAKE_OFF:
            return self.take_off()
        if mode is Mode.GO_TO:
            return self._order(Hold()) if self._pilot.manoeuvre.mode is not Mode.GO_TO else DONE
        return self._order(Return() if mode is Mode.RETURN else Land() if mode is Mode.LAND else Hold())

    def hold(self) -> Outcome:
        return self.set_mode(Mode.HOLD)

    def land(self) -> Outcome:
        return self.set_mode(Mode.LAND)

    def return_home(self) -> Outcome:
        return self.set_mode(Mode.RETURN)

    def go_to(self, position: LonLat, altitude_relative_m: float, heading_deg: float | None = None) -> Outcome:
        if not (abs(position.lon) <= 180.0 and abs(position.lat) <= 90.0 and abs(altitude_relative_m) <= 10_000.0):
            return Refused("place", "That is no place to fly to.")
        if not self._cockpit.is_in_air:
            return Refused("on-ground", "The UAV is on the ground.")
        east_m, north_m = self._cockpit.level_of(position)
        outcome = self._order(GoTo((east_m, north_m, altitude_relative_m)))
        if outcome.is_done and heading_deg is not None and math.isfinite(heading_deg):
            self._cockpit.heading_deg = heading_deg % 360.0
        return outcome

    def change_speed(self, speed_mps: float) -> Outcome:
        """Over ground, until a mission item says otherwise."""
        if not (math.isfinite(speed_mps) and speed_mps > 0.0):
            return Refused("speed", "A speed is above 0.")
        self._cockpit.speed_mps = min(max(speed_mps, MIN_SPEED_MPS), self.airframe.max_speed_mps)
        self._pilot.revision += 1
        if self._cockpit.is_in_air and not self._pilot.manoeuvre.is_landing and self._pilot.manoeuvre.mode in (Mode.MISSION, Mode.GO_TO):
            self._pilot.manoeuvre.begin(self._cockpit)
        return DONE

    def set_current(self, index: int) -> Outcome:
        """The item to be flown next."""
        if not self._first <= index < len(self._orders):
            return Refused("index", f"There is no item {index} to fly.")
        self._mission = Mission(self._orders, index)
        self._pilot.revision += 1
        if self._pilot.manoeuvre.mode is Mode.MISSION:
            self._pilot.begin(self._mission)
        return DONE

    def _fly_mission(self) -> Outcome:
        if self._mission is None:
            return Refused("no-mission", "There is no mission.")
        if self._mission.is_done:
            if self._cockpit.is_in_air:
                return Refused("complete", "The mission is complete.")
            self._mission = Mission(self._orders, self._first)
        return self._order(self._mission)

    def _order(self, manoeuvre: Manoeuvre) -> Outcome:
        if self.is_crashed:
            return Refused("crashed", "The UAV has crashed.")
        self._cockpit.heading_deg = self._cockpit.looks_at = None
        self._pilot.begin(manoeuvre)
        return DONE

    def step(self) -> None:
        """0.04 s of simulated time."""
        self._pilot.step()

    # --- what it says --------------------------------------------------------------------------------------------------------------

    @property
    def now_s(self) -> float:
        """Simulated seconds since the start."""
        return self._pilot.now_s

    @property
    def is_crashed(self) -> bool:
        return self._pilot.is_crashed

    @property
    def is_gps_lost(self) -> bool:
        return self._pilot.is_gps_lost

    def take_events(self) -> list[Event]:
        """What happened since the last call."""
        events, self._cockpit.events = self._cockpit.events, []
        return events

    @property
    def is_armed(self) -> bool:
        return self._cockpit.is_armed

    @property
    def mission_state(self) -> MissionState:
        return self._mission_state()

    @property
    def battery_percent(self) -> float:
        return self._body.battery_percent

    @property
    def true_place(self) -> tuple[float, float, float, float, float]:
        """What a long record of a flight is made of, cheaper than `state`: seconds, lon, lat, height above home and above ground."""
        motion, cockpit = self._body.motion, self._cockpit
        return self.now_s, motion.lon_deg, motion.lat_deg, cockpit.here[2], cockpit.agl_m

    @property
    def state(self) -> UavState:
        """Of this step; made when it is asked for."""
        if self._state is None or self._told_at != self._pilot.revision:
            self._told_at = self._pilot.revision
            self._state = reported(
                self._body,
                self._cockpit,
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

    def _mission_state(self) -> MissionState:
        mission = self._mission
        if mission is None:
            return MissionState.NONE
        if mission.is_done:
            return MissionState.COMPLETE
        if self._pilot.manoeuvre is mission:
            return MissionState.ACTIVE
        return MissionState.NOT_STARTED if mission.index == self._first else MissionState.PAUSED
