"""The state of a UAV as it is told, put together from its parts."""

import math

from simulation.flight.body import Body
from simulation.flight.cockpit import Cockpit
from simulation.flight.manoeuvres import Manoeuvre
from simulation.flight.states import Gps, Landed, MissionState, Mode, UavState

NO_FIX, FIX = Gps(0, 0, 99.9), Gps(3, 14, 0.7)


def told(
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
