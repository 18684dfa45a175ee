"""The autopilot: carries out a manoeuvre, monitors battery, position and ground, and commands the control loops of the model."""

import math

from inspection.geodesy import LonLat
from operation.reasons import Reason
from simulation.flight.airframe import OwnAction
from simulation.flight.body import OFF_GROUND_M, STEADY_M, Body, Contact
from simulation.flight.camera import LensPose, Shot, lens_offset_m
from simulation.flight.events import Armed, Crashed, Disarmed, LandedAt, ModeChanged, PhotoTaken, TookOff
from simulation.flight.manoeuvre_context import ManoeuvreContext
from simulation.flight.manoeuvres import Hold, Land, Manoeuvre, Return
from simulation.flight.plant import GUIDANCE_STEP_S, CameApart
from simulation.flight.states import FlightMode, Severity

STRENGTH = {FlightMode.RETURN: 1, FlightMode.LAND: 2}  # a present action is not replaced by a weaker one
SETTLES_S = 2.0  # on the ground, until the model is at rest


class Failsafes:
    """Failsafes; each reports and acts once until its cause is gone."""

    def __init__(self) -> None:
        self._battery_level = 0
        self._gps_lost_since_s: float | None = None
        self._has_acted_on_gps = False

    def step(self, context: ManoeuvreContext, mode: FlightMode, battery_percent: float, *, is_gps_lost: bool) -> Manoeuvre | None:
        """Return a new manoeuvre; None: no change."""
        manoeuvre = self._gps(context, mode, is_gps_lost=is_gps_lost)
        return self._battery(context, mode, battery_percent) or manoeuvre

    def _battery(self, context: ManoeuvreContext, mode: FlightMode, percent: float) -> Manoeuvre | None:
        settings = context.settings
        thresholds = (settings.battery_warn_percent, settings.battery_low_percent, settings.battery_critical_percent)
        level = sum(percent <= threshold for threshold in thresholds)
        if level <= self._battery_level:
            self._battery_level = level
            return None
        self._battery_level = level
        if level == 1:
            context.report(Reason("battery_at", {"percent": round(percent)}), Severity.WARNING)
            return None
        action = settings.battery_low_action if level == 2 else settings.battery_critical_action
        severity = Severity.WARNING if level == 2 else Severity.CRITICAL
        why = Reason("battery_low" if level == 2 else "battery_critical", {"percent": round(percent)})
        return _act(context, mode, action, why, severity)

    def _gps(self, context: ManoeuvreContext, mode: FlightMode, *, is_gps_lost: bool) -> Manoeuvre | None:
        if not is_gps_lost:
            if self._gps_lost_since_s is not None:
                context.report("GPS fix again")
            self._gps_lost_since_s, self._has_acted_on_gps = None, False
            return None
        if self._gps_lost_since_s is None:
            self._gps_lost_since_s = context.now_s
            context.report(Reason("dead_reckoning"), Severity.WARNING)
        if self._has_acted_on_gps or context.now_s - self._gps_lost_since_s < context.settings.gps_lost_patience_s:
            return None
        self._has_acted_on_gps = True
        return _act(context, mode, context.settings.gps_lost_action, Reason("gps_lost"), Severity.CRITICAL)


def _act(context: ManoeuvreContext, mode: FlightMode, action: OwnAction, why: Reason, severity: Severity) -> Manoeuvre | None:
    manoeuvre = _manoeuvre(action)
    if manoeuvre is None or not context.is_in_air or STRENGTH.get(mode, 0) >= STRENGTH.get(manoeuvre.mode, 0) > 0:
        context.report(why, severity)
        return None
    context.report(Reason(f"{why.code}_{manoeuvre.mode}", why.params), severity)
    return manoeuvre


def _manoeuvre(action: OwnAction) -> Manoeuvre | None:
    if action is OwnAction.HOLD:
        return Hold()
    if action is OwnAction.RETURN:
        return Return()
    return Land() if action is OwnAction.LAND else None


class Autopilot:
    """The autopilot. `revision` counts its changes."""

    def __init__(self, body: Body, context: ManoeuvreContext, lens_m: tuple[float, float, float]) -> None:
        """lens_m: of the camera's lens from the antenna, forward, right and up."""
        self.body, self.context, self.lens_m = body, context, lens_m
        self.manoeuvre: Manoeuvre = Hold()
        self.is_crashed = False
        self.revision = 0
        self._failsafes = Failsafes()
        self._ticks = 0
        self._armed_ticks = 0  # on the ground
        self._rest_ticks = 0
        self._heading_rad = body.motion.heading_rad
        self._look_around()

    @property
    def is_gps_lost(self) -> bool:
        return self.context.faults.is_gps_lost(self.now_s)

    def arm(self) -> None:
        self.context.is_armed, self._armed_ticks = True, 0
        self.body.plant.set_armed(True)
        self.body.plant.set_grounded(True)
        self.context.events.append(Armed(self.now_s))
        self.begin(self.manoeuvre)

    def begin(self, manoeuvre: Manoeuvre, *, is_own: bool = False) -> None:
        if manoeuvre.mode is not self.manoeuvre.mode:
            self.context.events.append(ModeChanged(self.now_s, manoeuvre.mode, is_own))
        self.manoeuvre = manoeuvre
        self.revision += 1
        manoeuvre.begin(self.context)

    @property
    def now_s(self) -> float:
        """Return the simulated seconds since the start."""
        return self._ticks * GUIDANCE_STEP_S

    def step(self) -> None:
        """Advance 0.04 s of simulated time."""
        self._ticks += 1
        self.revision += 1
        context = self.context
        context.now_s = self.now_s
        self.body.navigate(is_gps_lost=self.is_gps_lost)
        if self.is_crashed:
            return
        if self._is_parked():
            self._operate_camera()
            return
        self.body.air.step(context.agl_m)
        self._fly()
        try:
            self.body.advance()
        except CameApart as error:
            self._crash(Reason("flight_model_failed", {"error": str(error)}))
            return
        self._look_around()
        self._touch()
        self._operate_camera()

    def _is_parked(self) -> bool:
        """Return whether it is disarmed and at rest on the ground: then only time advances."""
        if self.context.is_armed or self.context.is_in_air:
            self._rest_ticks = 0
            return False
        self._rest_ticks += 1
        if self._rest_ticks * GUIDANCE_STEP_S <= SETTLES_S:
            return False
        self.body.park()
        return True

    def _fly(self) -> None:
        context = self.context
        if not context.is_armed:
            return
        if self.body.battery_percent <= 0.0:
            context.report(Reason("battery_empty"), Severity.CRITICAL)
            self.disarm()
            return
        own = self._failsafes.step(context, self.manoeuvre.mode, self.body.battery_percent, is_gps_lost=self.is_gps_lost)
        if own is not None:
            self.begin(own, is_own=True)
        self.manoeuvre.step(context)
        if self.manoeuvre.is_done and context.is_in_air:
            self.begin(Hold(), is_own=True)
        elif not context.is_in_air:
            self._wait_on_ground()
            if not context.is_armed:
                return
        self._command()

    def _command(self) -> None:
        context = self.context
        above_m = max(self.body.above_standing_m, 0.0)
        command = context.guidance.step(GUIDANCE_STEP_S, context.here, above_m=above_m, effort=self.body.motion.effort)
        (east, north, up), (a_east, a_north, a_up) = command.velocity, command.acceleration
        if not context.is_in_air and not self.manoeuvre.lifts_off:
            up = -1.0
        u, v, _ = command.along
        if context.gimbal.target is not None and (context.settings.turns_to_target or not context.gimbal.pans):
            x, y = context.gimbal.target[0] - context.here[0], context.gimbal.target[1] - context.here[1]
            if math.hypot(x, y) > 0.5:
                self._heading_rad = math.atan2(x, y)
        elif context.heading_deg is not None:
            self._heading_rad = math.radians(context.heading_deg)
        elif math.hypot(u, v) > 0.2:
            self._heading_rad = math.atan2(u, v)
        self.body.plant.fly((north, east, -up), (a_north, a_east, -a_up), self._heading_rad)

    def _wait_on_ground(self) -> None:
        """Disarm after a time if it is armed and has not taken off."""
        self._armed_ticks += 1
        if self._armed_ticks * GUIDANCE_STEP_S > self.context.settings.disarm_on_ground_s and not (
            self.manoeuvre.lifts_off and not self.manoeuvre.is_done
        ):
            self.context.report("Disarmed: no take-off")
            self.disarm()

    def _look_around(self) -> None:
        context, body = self.context, self.body
        context.here, context.velocity, context.agl_m = body.believed(), body.velocity, body.agl_m
        context.facing_deg = math.degrees(body.motion.heading_rad) % 360.0
        if context.is_in_air:
            context.flown_m += math.hypot(context.velocity[0], context.velocity[1]) * GUIDANCE_STEP_S

    def _touch(self) -> None:
        """Detect take-off, landing and impact."""
        context, body = self.context, self.body
        if not context.is_in_air:
            if context.is_armed and body.above_standing_m > STEADY_M:
                body.plant.set_grounded(False)
            if body.above_standing_m > OFF_GROUND_M:
                context.is_in_air = True
                context.events.append(TookOff(self.now_s))
            return
        contact = body.contact()
        if contact is Contact.OVERTURNED:
            self._crash(Reason("overturned"))
        elif contact is Contact.HARD:
            self._crash(Reason("hit_ground", {"speed": round(body.impact_mps, 1)}))
        elif contact is Contact.SOFT:
            if context.is_armed and not self.manoeuvre.is_landing:
                context.report(Reason("touched_ground"), Severity.WARNING)
            self._landed()

    def _landed(self) -> None:
        context = self.context
        context.is_in_air = False
        self.body.plant.set_armed(False)
        self.body.plant.set_grounded(True)
        context.events.append(LandedAt(self.now_s, self.body.position))
        self.manoeuvre.step(context)  # a mission reports its last item before the motors stop
        self.disarm()

    def disarm(self) -> None:
        context = self.context
        self.body.plant.set_armed(False)
        if context.is_armed:
            context.is_armed = False
            context.events.append(Disarmed(self.now_s))
        if not context.is_in_air:
            self.body.plant.set_grounded(True)
            context.camera.reset()
            context.look_ahead()
            if self.manoeuvre.mode is not FlightMode.HOLD:
                self.begin(Hold(), is_own=True)
        self.revision += 1

    def _crash(self, reason: Reason) -> None:
        context = self.context
        self.is_crashed = True
        context.is_in_air = False
        self.disarm()
        context.events.append(Crashed(self.now_s, self.body.position, reason))
        context.report(Reason("crashed", {"reason": reason}), Severity.CRITICAL)
        self.body.stop()

    def _operate_camera(self) -> None:
        if self.is_crashed:
            return
        context = self.context
        context.gimbal.step(GUIDANCE_STEP_S, context.here, context.facing_deg)
        shot = context.camera.due(context.now_s, context.flown_m)
        if shot is not None:
            self._take_photo(shot)

    def _take_photo(self, shot: Shot) -> None:
        context, motion = self.context, self.body.motion
        east_m, north_m, up_m = lens_offset_m(self.lens_m, motion.roll_rad, motion.pitch_rad, motion.heading_rad)
        frame, attitude = context.frame, context.gimbal.attitude
        pose = LensPose(
            LonLat(motion.lon_deg + east_m / frame.metres_per_degree_east, motion.lat_deg + north_m / frame.metres_per_degree_north),
            motion.altitude_amsl_m + up_m,
            motion.altitude_amsl_m - context.home_amsl_m + up_m,
            (context.facing_deg + attitude.yaw_deg) % 360.0,
            attitude.pitch_deg,
        )
        position = context.position_of(context.here)
        context.events.append(
            PhotoTaken(self.now_s, context.camera.number, position, motion.altitude_amsl_m, shot.item, shot.sequence, pose)
        )
