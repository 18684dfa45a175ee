"""The airframes that can be flown: each is a JSBSim model file and a row here."""

from dataclasses import dataclass

from planning.rules import FlightRules

AS_PLANNED = FlightRules()


@dataclass(frozen=True, slots=True)
class Airframe:
    """What the autopilot has to know of a model file; the file has the physics, and names the source of each figure.

    max_airspeed_mps       what plans may count on; the tilt limit leaves some more, for gusts
    max_speed_mps          over ground, whatever a mission asks for
    climb_mps, descent_mps as plans count on, and as an operator sets the autopilot; each airframe can do more
    acceleration_mps2      along a straight leg, speeding up and slowing down
    corner_mps2            across, in the rounded corner before a waypoint that is passed; ArduCopter's is twice its WPNAV_ACCEL of 2.5
    empty_cell_v, full_cell_v, resistance_ohm
                           the battery's open voltage between 0 and 100 %, and what a current takes of it
    """

    code: str
    name: str
    mass_kg: float
    battery_wh: float
    cells: int
    max_airspeed_mps: float
    max_speed_mps: float
    cruise_speed_mps: float
    climb_mps: float = AS_PLANNED.climb_speed_mps
    descent_mps: float = AS_PLANNED.climb_speed_mps
    acceleration_mps2: float = 2.0
    corner_mps2: float = 2.5
    empty_cell_v: float = 3.5
    full_cell_v: float = 4.2
    resistance_ohm: float = 0.02


AIRFRAMES = {
    airframe.code: airframe
    for airframe in (
        Airframe(
            code="iris",
            name="Iris",
            mass_kg=1.545,
            battery_wh=56.6,  # 3S 5.1 Ah
            cells=3,
            max_airspeed_mps=11.0,
            max_speed_mps=10.0,
            cruise_speed_mps=5.0,  # PX4's MPC_XY_CRUISE
        ),
        Airframe(
            code="inspector",
            name="Inspector",
            mass_kg=3.77,
            battery_wh=263.2,  # 2 x 131.6 Wh
            cells=6,
            max_airspeed_mps=19.0,
            max_speed_mps=17.0,
            cruise_speed_mps=10.0,
            corner_mps2=5.0,
            resistance_ohm=0.03,
        ),
    )
}
