"""RTL behaviour of an autopilot: where it flies and how high, by its parameters. Heights are above its take-off.

Sources, read: ArduPilot/ardupilot ArduCopter/mode_rtl.cpp (compute_return_target) and libraries/AP_Rally/AP_Rally.cpp, both from before
heights were in metres; PX4/PX4-Autopilot src/modules/navigator/rtl_params.yaml and geofence_avoidance_params.yaml. Read in parts:
ArduPilot's change to metres of January 2026 (convert_params), libraries/AC_Avoidance/AP_OAPathPlanner.cpp, PX4's rtl.cpp
(computeReturnAltitude). ArduPilot's RTL_OPTIONS affect only the pilot's yaw.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

PX4, ARDUPILOT = "px4", "ardupilot"
# A vehicle has one parameter of each group. The first group sets the height, the second whether it flies straight at that height.
PARAMETERS = {
    PX4: (("RTL_RETURN_ALT",), ("RTL_TYPE",), ("RTL_MIN_DIST",), ("RTL_CONE_ANG",), ("NAV_ACC_RAD",), ("GF_AVOID_NODES",), ("GF_ACTION",)),
    ARDUPILOT: (
        ("RTL_ALT_M", "RTL_ALT"), ("RTL_ALT_TYPE",), ("RTL_CLIMB_MIN_M", "RTL_CLIMB_MIN"), ("RTL_CONE_SLOPE",), ("OA_TYPE",),
        ("RALLY_INCL_HOME",), ("RALLY_TOTAL",),
        ("FENCE_ENABLE",), ("FENCE_AUTOENABLE",), ("FENCE_TYPE",), ("FENCE_ALT_MAX",), ("FENCE_MARGIN",),
    ),
}  # fmt: skip
NAMES = {autopilot: frozenset(name for group in groups for name in group) for autopilot, groups in PARAMETERS.items()}
BENDING = {PX4: ("RTL_TYPE", "GF_AVOID_NODES"), ARDUPILOT: ("RTL_ALT_TYPE", "OA_TYPE")}  # unless 0: over terrain, around fences, …
IN_CENTIMETRES = frozenset({"RTL_ALT", "RTL_CLIMB_MIN"})
MIN_CONE_SLOPE = 0.5  # ArduPilot: lower values disable the cone
FENCES_HEIGHT, FENCES_POLYGONS = 1, 4  # bits of FENCE_TYPE
HOLDS_AT_FENCE = 2  # PX4's GF_ACTION: 0 is no action, 1 only a warning, from 2 on it acts (geofence_params.yaml)
# defaults of parameters that were not reported
USUAL = {"RTL_CONE_SLOPE": 3.0, "FENCE_MARGIN": 2.0, "RTL_MIN_DIST": 10.0, "RTL_CONE_ANG": 45.0, "NAV_ACC_RAD": 10.0}


@dataclass(frozen=True)
class RtlBehaviour:
    """RTL as configured on a vehicle. `parameter` sets `height_m`.

    `bends_by` is the parameter that makes it deviate from a straight line at one height, `untold` one that was not reported and would
    decide that; both empty if none. `shuns_home`: it flies to a rally point even if home is nearer. `rally_points` is how many it holds;
    None if not reported.
    """

    parameter: str
    height_m: float
    bends_by: str = ""
    untold: str = ""
    shuns_home: bool = False
    rally_points: int | None = None

    def level_m(self, current_m: float, away_m: float, goal_m: float) -> float:
        """Return the height of the RTL flight that begins at height `current_m`.

        `away_m` is the distance to the destination: home, with `goal_m` 0, or a rally point at height `goal_m`.
        """
        raise NotImplementedError

    def at_height(self, height_m: float) -> Self:
        return replace(self, height_m=height_m)

    def value_for(self, height_m: float) -> str:
        """Return the parameter value for a height, rounded up: "4600 (46 m)" if the parameter is in centimetres."""
        metres = math.ceil(height_m)
        return f"{metres * 100} ({metres} m)" if self.parameter in IN_CENTIMETRES else f"{metres} m"


@dataclass(frozen=True)
class CopterRtl(RtlBehaviour):
    """RTL of ArduPilot. It climbs at least `climb_m`, and at most `cone_slope` metres per metre of distance.

    Its fence limits the height to `ceiling_m`, but never makes it descend.
    """

    climb_m: float = 0.0
    cone_slope: float | None = None
    ceiling_m: float | None = None

    def level_m(self, current_m: float, away_m: float, goal_m: float) -> float:
        least_m = current_m + self.climb_m
        wanted_m = max(goal_m, self.height_m, least_m)
        if self.cone_slope is not None:
            wanted_m = min(wanted_m, max(away_m * self.cone_slope, least_m))
        if self.ceiling_m is not None:
            wanted_m = min(wanted_m, self.ceiling_m)
        return max(wanted_m, current_m)


@dataclass(frozen=True)
class Px4Rtl(RtlBehaviour):
    """RTL of PX4.

    Within `near_m` of the destination it stays in a cone with `cone_deg` from the vertical (0: no cone). Within `accepted_m` it counts as
    arrived.
    """

    near_m: float = USUAL["RTL_MIN_DIST"]
    cone_deg: float = USUAL["RTL_CONE_ANG"]
    accepted_m: float = USUAL["NAV_ACC_RAD"]

    def level_m(self, current_m: float, away_m: float, goal_m: float) -> float:
        return max(current_m, goal_m + min(self.height_m, self._above_goal_m(away_m)))

    def _above_goal_m(self, away_m: float) -> float:
        if self.cone_deg <= 0.0:
            return math.inf
        if away_m <= self.accepted_m:
            return 2.0 * away_m
        if away_m > self.near_m:
            return math.inf
        return max(away_m / math.tan(math.radians(min(max(self.cone_deg, 1.0), 89.0))), 2.0 * self.accepted_m)


def rtl_behaviour(autopilot: str, parameters: Mapping[str, float]) -> RtlBehaviour | None:
    """Return the RTL behaviour by the parameters that the vehicle reported; None without its return height."""
    groups = PARAMETERS.get(autopilot)
    if groups is None:
        return None
    height, straight, *_ = groups
    parameter = next((name for name in height if name in parameters), None)
    if parameter is None:
        return None
    values = USUAL | {name: value / 100.0 if name in IN_CENTIMETRES else value for name, value in parameters.items()}
    bends_by = next((f"{name} {values[name]:g}" for name in BENDING[autopilot] if values.get(name)), "")
    untold = "" if straight[0] in parameters else straight[0]
    if autopilot == PX4:
        return Px4Rtl(
            parameter, values[parameter], bends_by, untold,
            near_m=values["RTL_MIN_DIST"], cone_deg=values["RTL_CONE_ANG"], accepted_m=values["NAV_ACC_RAD"],
        )  # fmt: skip
    slope = values["RTL_CONE_SLOPE"]
    return CopterRtl(
        parameter,
        values[parameter],
        bends_by,
        untold,
        shuns_home=values.get("RALLY_INCL_HOME") == 0.0,
        rally_points=int(values["RALLY_TOTAL"]) if "RALLY_TOTAL" in values else None,
        climb_m=max(values.get("RTL_CLIMB_MIN_M", values.get("RTL_CLIMB_MIN", 0.0)), 0.0),
        cone_slope=slope if slope >= MIN_CONE_SLOPE else None,
        ceiling_m=_ceiling_m(values),
    )


def return_height_parameter(autopilot: str | None, parameters: Mapping[str, float], height_m: float) -> tuple[str, float] | None:
    """Return the parameter and value that set a vehicle's return height, rounded up to metres; None if it reported no such parameter."""
    known = PARAMETERS.get(autopilot or "", ((),))[0]
    name = next((name for name in known if name in parameters), None)
    metres = float(math.ceil(height_m))
    return None if name is None else (name, metres * 100.0 if name in IN_CENTIMETRES else metres)


def fence_off_by(autopilot: str, parameters: Mapping[str, float]) -> str:
    """Return the parameter that disables the vehicle's fence, as "FENCE_ENABLE 0"; empty if none does or it was not reported."""
    if autopilot == PX4 and parameters.get("GF_ACTION", HOLDS_AT_FENCE) < HOLDS_AT_FENCE:
        return f"GF_ACTION {parameters['GF_ACTION']:g}"
    if autopilot != ARDUPILOT or "FENCE_ENABLE" not in parameters:
        return ""
    if not parameters["FENCE_ENABLE"] and not parameters.get("FENCE_AUTOENABLE"):
        return "FENCE_ENABLE 0"
    kinds = int(parameters.get("FENCE_TYPE", FENCES_POLYGONS))
    return "" if kinds & FENCES_POLYGONS else f"FENCE_TYPE {kinds}"


def fence_on_by(autopilot: str, parameters: Mapping[str, float]) -> str:
    """Return the parameter that enables the vehicle's fence, as "FENCE_ENABLE 1"; empty if none does or it was not reported."""
    names = {PX4: ("GF_ACTION",), ARDUPILOT: ("FENCE_ENABLE", "FENCE_AUTOENABLE")}.get(autopilot, ())
    if not names or names[0] not in parameters or fence_off_by(autopilot, parameters):
        return ""
    return next(f"{name} {parameters[name]:g}" for name in names if parameters.get(name))


def _ceiling_m(values: Mapping[str, float]) -> float | None:
    """Return the height limit of a fence that is on, or that is enabled at take-off."""
    is_on = bool(values.get("FENCE_ENABLE") or values.get("FENCE_AUTOENABLE")) and int(values.get("FENCE_TYPE", 0)) & FENCES_HEIGHT
    return values["FENCE_ALT_MAX"] - values["FENCE_MARGIN"] if is_on and "FENCE_ALT_MAX" in values else None
