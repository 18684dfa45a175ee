"""A simulated UAV: it is given a mission and orders, stepped, and asked for its state. It knows no clock and no socket."""

import math
from collections.abc import Sequence

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from missions.mavlink.content import MissionItem
from simulation.flight.air import Air
from simulation.flight.airframe import Airframe
from simulation.flight.battery import Battery
from simulation.flight.camera import Camera
from simulation.flight.cockpit import Cockpit
from simulation.flight.events import Armed, Crashed, Disarmed, Event, LandedAt, ModeChanged, PhotoTaken, TookOff
from simulation.flight.failsafes import Failsafes
from simulation.flight.faults import Faults
from simulation.flight.ground import FlatGround, Ground
from simulation.flight.guidance import Guidance
from simulation.flight.manoeuvres import GoTo, Hold, Land, Manoeuvre, Return, TakeOff
from simulation.flight.mission import Mission, first_to_fly
from simulation.flight.navigation import Navigation
from simulation.flight.orders import CannotFly, Order, orders
from simulation.flight.plant import GUIDANCE_STEP_S, J_PER_WH, CameApart, Motion, Plant
from simulation.flight.settings import Settings
from simulation.flight.states import DONE, Gps, Landed, MissionState, Mode, Outcome, Refused, Severity, UavState
from simulation.flight.weather import Weather

OFF_GROUND_M = 0.3  # above standing: from here on it flies
STEADY_M = 0.2  # above standing: from here on the loops may integrate
OVERTURNED_RAD = math.radians(60.0)
HARD_DOWN_MPS, HARD_ALONG_MPS = 3.0, 2.5  # what the legs bear
SETTLES_S = 2.0  # on the ground, until the model rests
GROUND_EACH_M = 1.0  # the ground is asked for its height each time so far has been flown
LOW_M, LOW_GROUND_EACH_M = 15.0, 0.2
NO_FIX, FIX = Gps(0, 0, 99.9), Gps(3, 14, 0.7)
TIMES_SEED = 2_654_435_761  # keeps the draws of gusts, drift and turbulence apart (Knuth's multiplier)


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
        ground_m = ground.elevation_m(home)
        self._ground_m = ground_m if math.isfinite(ground_m) else 0.0
        self._ground_at = home
        self.airframe = airframe
        self._plant = Plant(airframe, home, ground_m=self._ground_m, heading_deg=heading_deg, seed=seed, physics_hz=physics_hz)
        self._motion: Motion = self._plant.motion
        self._air = Air(self._plant, weather or Weather(), ground_m=self._ground_m, seed=seed * TIMES_SEED + 1)
        self._navigation = Navigation(seed * TIMES_SEED + 2)
        self._battery = Battery.charged(airframe, battery_percent)
        self._failsafes = Failsafes()
        self._cockpit = Cockpit(
            airframe=airframe,
            settings=settings or Settings(),
            ground=ground,
            home=home,
            home_amsl_m=self._ground_m,
            frame=LocalFrame.around(home.lon, home.lat),
            guidance=Guidance(airframe),
            camera=Camera(),
            speed_mps=airframe.cruise_speed_mps,
            facing_deg=heading_deg,
        )
        self.items: tuple[MissionItem, ...] = ()
        self._orders: tuple[Order, ...] = ()
        self._first = 0
        self._mission: Mission | None = None
        self._manoeuvre: Manoeuvre = Hold()
        self._faults = Faults()
        self.is_crashed = False
        self._ticks = 0
        self._armed_ticks = 0  # on the ground
        self._rest_ticks = 0
        self._parked_j = 0.0
        self._heading_rad = math.radians(heading_deg)
        self._state: UavState | None = None
        self.faults = faults or Faults()
        self._look_around(self._motion)

    # --- what it is told -----------------------------------------------------------------------------------------------------------

    @property
    def weather(self) -> Weather:
        return self._air.weather

    @weather.setter
    def weather(self, weather: Weather) -> None:
        self._air.change(weather)

    @property
    def settings(self) -> Settings:
        return self._cockpit.settings

    @settings.setter
    def settings(self, settings: Settings) -> None:
        self._cockpit.settings = settings

    @property
    def faults(self) -> Faults:
        return self._faults

    @faults.setter
    def faults(self, faults: Faults) -> None:
        if faults.motor_failed != self._faults.motor_failed:
            self._plant.fail_motor(faults.motor_failed)
        if faults.battery_wh_left is not None and faults.battery_wh_left != self._faults.battery_wh_left:
            self._battery = self._battery.with_left(faults.battery_wh_left, self._used_wh)
        self._faults = self._cockpit.faults = faults
        self._state = None

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
        self._state = None
        if self._manoeuvre.mode is Mode.MISSION:
            self._begin(self._mission or Hold())
        return DONE

    def clear(self) -> Outcome:
        return self.load(())

    def arm(self) -> Outcome:
        if self.is_crashed:
            return Refused("crashed", "The UAV has crashed.")
        if self._cockpit.is_armed:
            return DONE
        if self._percent <= self.settings.battery_critical_percent:
            return Refused("battery", f"The battery holds {self._percent:.0f} %.")
        if self.is_gps_lost:
            return Refused("gps", "There is no GPS fix.")
        self._cockpit.is_armed, self._armed_ticks = True, 0
        self._plant.set_armed(True)
        self._plant.set_grounded(True)
        self._cockpit.events.append(Armed(self.now_s))
        self._begin(self._manoeuvre)
        return DONE

    def disarm(self, *, force: bool = False) -> Outcome:
        if self._cockpit.is_in_air and not force:
            return Refused("in-air", "The UAV is in the air.")
        self._disarm()
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
            return self._order(Hold()) if self._manoeuvre.mode is not Mode.GO_TO else DONE
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
        self._cockpit.speed_mps = min(max(speed_mps, 0.2), self.airframe.max_speed_mps)
        self._state = None
        if self._cockpit.is_in_air and not self._manoeuvre.is_landing and self._manoeuvre.mode in (Mode.MISSION, Mode.GO_TO):
            self._manoeuvre.begin(self._cockpit)
        return DONE

    def set_current(self, index: int) -> Outcome:
        """The item to be flown next."""
        if not self._first <= index < len(self._orders):
            return Refused("index", f"There is no item {index} to fly.")
        self._mission = Mission(self._orders, index)
        self._state = None
        if self._manoeuvre.mode is Mode.MISSION:
            self._begin(self._mission)
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
        self._begin(manoeuvre)
        return DONE

    def _begin(self, manoeuvre: Manoeuvre, *, is_own: bool = False) -> None:
        if manoeuvre.mode is not self._manoeuvre.mode:
            self._cockpit.events.append(ModeChanged(self.now_s, manoeuvre.mode, is_own))
        self._manoeuvre = manoeuvre
        self._state = None
        manoeuvre.begin(self._cockpit)

    # --- what it does --------------------------------------------------------------------------------------------------------------

    @property
    def now_s(self) -> float:
        """Simulated seconds since the start."""
        return self._ticks * GUIDANCE_STEP_S

    def step(self) -> None:
        """0.04 s of simulated time."""
        self._ticks += 1
        self._state = None
        cockpit = self._cockpit
        cockpit.now_s = self.now_s
        self._navigation.step(GUIDANCE_STEP_S, is_gps_lost=self.is_gps_lost)
        if self.is_crashed or self._is_parked():
            return
        self._air.step(cockpit.agl_m)
        self._fly()
        try:
            motion = self._plant.advance()
        except CameApart as error:
            self._crash(f"The flight model: {error}.")
            return
        before = self._motion
        self._look_around(motion)
        self._touch(motion, before)

    def take_events(self) -> list[Event]:
        """What happened since the last call."""
        events, self._cockpit.events = self._cockpit.events, []
        return events

    def _is_parked(self) -> bool:
        """Disarmed and at rest on the ground: time passes, and nothing moves."""
        if self._cockpit.is_armed or self._cockpit.is_in_air:
            self._rest_ticks = 0
            return False
        self._rest_ticks += 1
        if self._rest_ticks * GUIDANCE_STEP_S <= SETTLES_S:
            return False
        self._parked_j += self._motion.power_w * GUIDANCE_STEP_S
        return True

    def _fly(self) -> None:
        cockpit = self._cockpit
        if not cockpit.is_armed:
            return
        if self._percent <= 0.0:
            cockpit.say("Battery empty: the motors stop", Severity.CRITICAL)
            self._disarm()
            return
        own = self._failsafes.step(cockpit, self._manoeuvre.mode, self._percent, is_gps_lost=self.is_gps_lost)
        if own is not None:
            self._begin(own, is_own=True)
        self._manoeuvre.step(cockpit)
        if self._manoeuvre.is_done and cockpit.is_in_air:
            self._begin(Hold(), is_own=True)
        elif not cockpit.is_in_air:
            self._wait_on_ground()
            if not cockpit.is_armed:
                return
        if cockpit.camera.is_due(cockpit.now_s, cockpit.flown_m):
            self._take_photo()
        self._command()

    def _command(self) -> None:
        cockpit = self._cockpit
        agl_m = max(cockpit.agl_m - self._plant.leg_m, 0.0)
        command = cockpit.guidance.step(GUIDANCE_STEP_S, cockpit.here, agl_m=agl_m, effort=self._motion.effort)
        (east, north, up), (a_east, a_north, a_up) = command.velocity, command.acceleration
        if not cockpit.is_in_air and not self._manoeuvre.lifts_off:
            up = -1.0
        u, v, _ = command.along
        if cockpit.looks_at is not None:
            x, y = cockpit.looks_at[0] - cockpit.here[0], cockpit.looks_at[1] - cockpit.here[1]
            if math.hypot(x, y) > 0.5:
                self._heading_rad = math.atan2(x, y)
        elif cockpit.heading_deg is not None:
            self._heading_rad = math.radians(cockpit.heading_deg)
        elif math.hypot(u, v) > 0.2:
            self._heading_rad = math.atan2(u, v)
        self._plant.fly((north, east, -up), (a_north, a_east, -a_up), self._heading_rad)

    def _wait_on_ground(self) -> None:
        """Armed, and not off the ground: not for long."""
        self._armed_ticks += 1
        if self._armed_ticks * GUIDANCE_STEP_S > self.settings.disarm_on_ground_s and not (
            self._manoeuvre.lifts_off and not self._manoeuvre.is_done
        ):
            self._cockpit.say("Disarmed: no take-off")
            self._disarm()

    def _look_around(self, motion: Motion) -> None:
        """Where the UAV is, and the ground below it."""
        cockpit = self._cockpit
        self._motion = motion
        position = LonLat(motion.lon_deg, motion.lat_deg)
        east_m, north_m = cockpit.level_of(position)
        flown_m = math.hypot(motion.east_mps, motion.north_mps) * GUIDANCE_STEP_S
        cockpit.flown_m += flown_m if cockpit.is_in_air else 0.0
        off_east_m, off_north_m = self._navigation.error_m
        cockpit.here = (east_m + off_east_m, north_m + off_north_m, motion.altitude_amsl_m - cockpit.home_amsl_m)
        cockpit.velocity = (motion.east_mps, motion.north_mps, -motion.down_mps)
        cockpit.facing_deg = math.degrees(motion.heading_rad) % 360.0
        at_east_m, at_north_m = cockpit.level_of(self._ground_at)
        each_m = GROUND_EACH_M if cockpit.agl_m > LOW_M else LOW_GROUND_EACH_M
        if math.hypot(east_m - at_east_m, north_m - at_north_m) > each_m:
            ground_m = cockpit.ground.elevation_m(position)
            self._ground_at = position
            if math.isfinite(ground_m) and ground_m != self._ground_m:
                self._ground_m = ground_m
                self._plant.set_ground_m(ground_m)
        cockpit.agl_m = motion.altitude_amsl_m - self._ground_m

    def _touch(self, motion: Motion, before: Motion) -> None:
        """Off the ground, onto it, or into it: how hard is told by the speed before the legs took it up."""
        cockpit = self._cockpit
        above_m = cockpit.agl_m - self._plant.leg_m
        if not cockpit.is_in_air:
            if cockpit.is_armed and above_m > STEADY_M:
                self._plant.set_grounded(False)
            if above_m > OFF_GROUND_M:
                cockpit.is_in_air = True
                cockpit.events.append(TookOff(self.now_s))
            return
        tilt = max(abs(motion.roll_rad), abs(motion.pitch_rad))
        if above_m > 0.5 or not (self._plant.legs_down or above_m < 0.0 or tilt > OVERTURNED_RAD):
            return
        along_mps = math.hypot(before.east_mps, before.north_mps)
        if tilt > OVERTURNED_RAD:
            self._crash("It overturned.")
        elif self._plant.legs_down and (before.down_mps > HARD_DOWN_MPS or along_mps > HARD_ALONG_MPS):
            self._crash(f"It hit the ground at {math.hypot(before.down_mps, along_mps):.1f} m/s.")
        elif self._plant.legs_down and (self._manoeuvre.is_landing or not cockpit.is_armed):
            self._landed()
        elif self._plant.legs_down and not self._manoeuvre.is_landing:
            cockpit.say("Touched the ground outside of a landing", Severity.WARNING)
            self._landed()

    def _landed(self) -> None:
        cockpit = self._cockpit
        cockpit.is_in_air = False
        self._plant.set_armed(False)
        self._plant.set_grounded(True)
        cockpit.events.append(LandedAt(self.now_s, LonLat(self._motion.lon_deg, self._motion.lat_deg)))
        self._manoeuvre.step(cockpit)  # a mission's last item is told before the motors are
        self._disarm()

    def _disarm(self) -> None:
        cockpit = self._cockpit
        self._plant.set_armed(False)
        if cockpit.is_armed:
            cockpit.is_armed = False
            cockpit.events.append(Disarmed(self.now_s))
        if not cockpit.is_in_air:
            self._plant.set_grounded(True)
            cockpit.camera.stop()
            cockpit.heading_deg = cockpit.looks_at = None
            if self._manoeuvre.mode is not Mode.HOLD:
                self._begin(Hold(), is_own=True)
        self._state = None

    def _crash(self, reason: str) -> None:
        cockpit = self._cockpit
        self.is_crashed = True
        cockpit.is_in_air = False
        self._disarm()
        cockpit.events.append(Crashed(self.now_s, LonLat(self._motion.lon_deg, self._motion.lat_deg), reason))
        cockpit.say(f"Crashed: {reason}", Severity.CRITICAL)
        self._motion = self._motion._replace(north_mps=0.0, east_mps=0.0, down_mps=0.0, power_w=0.0)

    def _take_photo(self) -> None:
        cockpit, motion = self._cockpit, self._motion
        position = cockpit.position_of(cockpit.here)
        item = self._mission.index if self._mission is not None and self._manoeuvre is self._mission else None
        cockpit.events.append(PhotoTaken(self.now_s, cockpit.camera.number, position, motion.altitude_amsl_m, cockpit.facing_deg, item))

    # --- what it says --------------------------------------------------------------------------------------------------------------

    @property
    def is_gps_lost(self) -> bool:
        return self._faults.is_gps_lost(self.now_s)

    @property
    def _used_wh(self) -> float:
        return (self._motion.used_j + self._parked_j) / J_PER_WH

    @property
    def _percent(self) -> float:
        return self._battery.percent_after(self._used_wh)

    @property
    def is_armed(self) -> bool:
        return self._cockpit.is_armed

    @property
    def mission_state(self) -> MissionState:
        return self._mission_state()

    @property
    def battery_percent(self) -> float:
        return self._percent

    @property
    def true_place(self) -> tuple[float, float, float, float, float]:
        """What a long record of a flight is made of, cheaper than `state`: seconds, lon, lat, height above home and above ground."""
        motion, cockpit = self._motion, self._cockpit
        return self.now_s, motion.lon_deg, motion.lat_deg, cockpit.here[2], cockpit.agl_m

    @property
    def state(self) -> UavState:
        """Of this step; made when it is asked for."""
        if self._state is None:
            self._state = self._told()
        return self._state

    def _told(self) -> UavState:
        cockpit, motion = self._cockpit, self._motion
        volts, amperes = self._battery.under_load(self._used_wh, motion.power_w)
        return UavState(
            at_s=self.now_s,
            position=cockpit.position_of(cockpit.here),
            true_position=LonLat(motion.lon_deg, motion.lat_deg),
            altitude_amsl_m=motion.altitude_amsl_m,
            altitude_relative_m=cockpit.here[2],
            altitude_agl_m=cockpit.agl_m,
            velocity_ned_mps=(motion.north_mps, motion.east_mps, motion.down_mps),
            roll_deg=math.degrees(motion.roll_rad),
            pitch_deg=math.degrees(motion.pitch_rad),
            heading_deg=cockpit.facing_deg,
            roll_rate_dps=math.degrees(motion.roll_rad_s),
            pitch_rate_dps=math.degrees(motion.pitch_rad_s),
            yaw_rate_dps=math.degrees(motion.yaw_rad_s),
            airspeed_mps=0.0 if self.is_crashed else self._plant.airspeed_mps,
            ground_speed_mps=math.hypot(motion.north_mps, motion.east_mps),
            wind_ned_mps=self._air.wind_ned_mps,
            battery_percent=self._percent,
            battery_used_wh=self._used_wh,
            battery_v=volts,
            battery_a=amperes,
            is_armed=cockpit.is_armed,
            is_in_air=cockpit.is_in_air,
            landed=self._landed_state(),
            mode=self._manoeuvre.mode,
            is_crashed=self.is_crashed,
            gps=NO_FIX if self.is_gps_lost else FIX,
            current_item=self._current_item(),
            mission_state=self._mission_state(),
            home=cockpit.home,
            home_amsl_m=cockpit.home_amsl_m,
            target_speed_mps=cockpit.speed_mps,
        )

    def _landed_state(self) -> Landed:
        cockpit = self._cockpit
        if not cockpit.is_in_air:
            return Landed.TAKING_OFF if cockpit.is_armed and self._manoeuvre.lifts_off else Landed.ON_GROUND
        if self._manoeuvre.is_landing:
            return Landed.LANDING
        return Landed.TAKING_OFF if self._manoeuvre.mode is Mode.TAKE_OFF else Landed.IN_AIR

    def _current_item(self) -> int:
        mission = self._mission
        return 0 if mission is None else min(mission.index, len(self._orders) - 1)

    def _mission_state(self) -> MissionState:
        mission = self._mission
        if mission is None:
            return MissionState.NONE
        if mission.is_done:
            return MissionState.COMPLETE
        if self._manoeuvre is mission:
            return MissionState.ACTIVE
        return MissionState.NOT_STARTED if mission.index == self._first else MissionState.PAUSED
