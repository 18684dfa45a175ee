"""Where and how high an autopilot flies home by itself, as its parameters say. Heights count from where it took off.

Sources, read: ArduPilot/ardupilot ArduCopter/mode_rtl.cpp (compute_return_target) and libraries/AP_Rally/AP_Rally.cpp, both of the years
in which heights were centimetres; PX4/PX4-Autopilot src/modules/navigator/rtl_params.yaml and geofence_avoidance_params.yaml. Seen in
parts only: ArduPilot's change to metres of January 2026 (convert_params), libraries/AC_Avoidance/AP_OAPathPlanner.cpp, PX4's rtl.cpp
(computeReturnAltitude). ArduPilot's RTL_OPTIONS concern the pilot's yaw alone.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

PX4, ARDUPILOT = "px4", "ardupilot"
# Of each group a vehicle has one; the first sets the height, the second says whether it flies straight at that height.
PARAMETERS = {
    PX4: (("RTL_RETURN_ALT",), ("RTL_TYPE",), ("RTL_MIN_DIST",), ("RTL_CONE_ANG",), ("NAV_ACC_RAD",), ("GF_AVOID_NODES",), ("GF_ACTION",)),
    ARDUPILOT: (
        ("RTL_ALT_M", "RTL_ALT"), ("RTL_ALT_TYPE",), ("RTL_CLIMB_MIN_M", "RTL_CLIMB_MIN"), ("RTL_CONE_SLOPE",), ("OA_TYPE",),
        ("RALLY_INCL_HOME",), ("RALLY_TOTAL",),
        ("FENCE_ENABLE",), ("FENCE_AUTOENABLE",), ("FENCE_TYPE",), ("FENCE_ALT_MAX",), ("FENCE_MARGIN",),
    ),
}  # fmt: skip
NAMES = {autopilot: frozenset(name for group in groups for name in group) for autopilot, groups in PARAMETERS.items()}
BENDING = {PX4: ("RTL_TYPE", "GF_AVOID_NODES"), ARDUPILOT: ("RTL_ALT_TYPE", "OA_TYPE")}  # unless 0: over terrain, round fences, …
IN_CENTIMETRES = frozenset({"RTL_ALT", "RTL_CLIMB_MIN"})
MIN_CONE_SLOPE = 0.5  # ArduPilot: below that there is no cone
FENCES_HEIGHT, FENCES_POLYGONS = 1, 4  # bits of FENCE_TYPE
HOLDS_AT_FENCE = 2  # PX4's GF_ACTION: from here on it does something; 0 is nothing, 1 a warning alone (geofence_params.yaml)
# where it is not told
USUAL = {"RTL_CONE_SLOPE": 3.0, "FENCE_MARGIN": 2.0, "RTL_MIN_DIST": 10.0, "RTL_CONE_ANG": 45.0, "NAV_ACC_RAD": 10.0}


@dataclass(frozen=True)
class RtlBehaviour:
    """`parameter` sets `height_m`.

    `bends_by` is the parameter by which it does not fly straight at one height, `untold` one that would say whether it does; empty: none.
    `shuns_home`: it goes to a rally point although home is nearer. `rally_points` are those that it holds; None: it does not tell.
    """

    parameter: str
    height_m: float
    bends_by: str = ""
    untold: str = ""
    shuns_home: bool = False
    rally_points: int | None = None

    def level_m(self, current_m: float, away_m: float, goal_m: float) -> float:
        """From a place at `current_m`, so far away from where it goes, which is home (0) or a rally point at `goal_m`."""
        raise NotImplementedError

    def at_height(self, height_m: float) -> Self:
        return replace(self, height_m=height_m)

    def value_for(self, height_m: float) -> str:
        """As the parameter is to be set, rounded up: "4600 (46 m)" where it counts centimetres."""
        metres = math.ceil(height_m)
        return f"{metres * 100} ({metres} m)" if self.parameter in IN_CENTIMETRES else f"{metres} m"


@dataclass(frozen=True)
class CopterRtl(RtlBehaviour):
    """ArduPilot's. `climb_m` it climbs at least; `cone_slope` is the metres that it climbs at most for each metre away.

    Its fence lowers it to `ceiling_m`, but never takes it down from where it is.
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
    """Within `near_m` of where it goes it stays in a cone of so many degrees beside the plumb line (0: no cone); within `accepted_m` it is
    as good as there.
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
    """Of the parameters as the vehicle told them; None where it has not told its height."""
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
    """Return the parameter of a vehicle and the value that set its return height, rounded up to whole metres; None where it told none."""
    known = PARAMETERS.get(autopilot or "", ((),))[0]
    name = next((name for name in known if name in parameters), None)
    metres = float(math.ceil(height_m))
    return None if name is None else (name, metres * 100.0 if name in IN_CENTIMETRES else metres)


def fence_off_by(autopilot: str, parameters: Mapping[str, float]) -> str:
    """The parameter by which an autopilot ignores the fence that it holds, as "FENCE_ENABLE 0"; empty: it does not, or has not told."""
    if autopilot == PX4 and parameters.get("GF_ACTION", HOLDS_AT_FENCE) < HOLDS_AT_FENCE:
        return f"GF_ACTION {parameters['GF_ACTION']:g}"
    if autopilot != ARDUPILOT or "FENCE_ENABLE" not in parameters:
        return ""
    if not parameters["FENCE_ENABLE"] and not parameters.get("FENCE_AUTOENABLE"):
        return "FENCE_ENABLE 0"
    kinds = int(parameters.get("FENCE_TYPE", FENCES_POLYGONS))
    return "" if kinds & FENCES_POLYGONS else f"FENCE_TYPE {kinds}"


def fence_on_by(autopilot: str, parameters: Mapping[str, float]) -> str:
    """The parameter by which an autopilot minds the fence that it holds, as "FENCE_ENABLE 1"; empty: it does not, or has not told."""
    names = {PX4: ("GF_ACTION",), ARDUPILOT: ("FENCE_ENABLE", "FENCE_AUTOENABLE")}.get(autopilot, ())
    if not names or names[0] not in parameters or fence_off_by(autopilot, parameters):
        return ""
    return next(f"{name} {parameters[name]:g}" for name in names if parameters.get(name))


def _ceiling_m(values: Mapping[str, float]) -> float | None:
    """Of a fence that is on, or put on at the take-off."""
    is_on = bool(values.get("FENCE_ENABLE") or values.get("FENCE_AUTOENABLE")) and int(values.get("FENCE_TYPE", 0)) & FENCES_HEIGHT
    return values["FENCE_ALT_MAX"] - values["FENCE_MARGIN"] if is_on and "FENCE_ALT_MAX" in values else None
