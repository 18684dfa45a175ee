"""How high an autopilot flies home by itself, as its parameters say.

Read in ArduCopter's mode_rtl.cpp and PX4's rtl.cpp. Heights count from where it took off.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

PX4, ARDUPILOT = "px4", "ardupilot"
# Of each group a vehicle has one; ArduPilot has changed from centimetres to metres, and the names with it.
PARAMETERS = {
    PX4: (("RTL_RETURN_ALT",), ("RTL_MIN_DIST",), ("RTL_TYPE",)),
    ARDUPILOT: (("RTL_ALT_M", "RTL_ALT"), ("RTL_CLIMB_MIN_M", "RTL_CLIMB_MIN"), ("RTL_CONE_SLOPE",), ("RTL_ALT_TYPE",)),
}
NAMES = {autopilot: frozenset(name for group in groups for name in group) for autopilot, groups in PARAMETERS.items()}
IN_CENTIMETRES = frozenset({"RTL_ALT", "RTL_CLIMB_MIN"})
USUAL_CONE_SLOPE, LEAST_CONE_SLOPE = 3.0, 0.5  # ArduPilot: below that there is no cone
USUAL_MIN_DISTANCE_M = 10.0  # PX4


@dataclass(frozen=True)
class OwnReturn:
    """`parameter` sets `height_m`. `is_straight`: it flies straight at one level, and not over terrain or along a landing pattern.

    `climb_m` it climbs at least. Near home it does not climb so far: `cone_slope` metres for each metre away, or not at all within
    `near_m`.
    """

    autopilot: str
    parameter: str
    height_m: float
    is_straight: bool = True
    climb_m: float = 0.0
    cone_slope: float | None = None
    near_m: float = 0.0

    def level_m(self, current_m: float, away_m: float, haven_m: float, *, is_rally: bool) -> float:
        """From a place at `current_m`, so far away from where it goes, which is home (0) or a rally point at `haven_m`."""
        least_m = current_m + self.climb_m
        if self.autopilot == ARDUPILOT:
            wanted_m = max(haven_m if is_rally else self.height_m, least_m)
            if self.cone_slope is not None:
                wanted_m = min(wanted_m, max(away_m * self.cone_slope, least_m))
            return wanted_m
        return least_m if away_m <= self.near_m else max(haven_m + self.height_m, least_m)

    def at_height(self, height_m: float) -> "OwnReturn":
        return OwnReturn(self.autopilot, self.parameter, height_m, self.is_straight, self.climb_m, self.cone_slope, self.near_m)

    def value_for(self, height_m: float) -> str:
        """As the parameter is to be set, rounded up: "4600 (46 m)" where it counts centimetres."""
        metres = math.ceil(height_m)
        return f"{metres * 100} ({metres} m)" if self.parameter in IN_CENTIMETRES else f"{metres} m"


def own_return(autopilot: str, parameters: Mapping[str, float]) -> OwnReturn | None:
    """Of the parameters as the vehicle told them; None where it has not told its height."""
    groups = PARAMETERS.get(autopilot)
    if groups is None:
        return None
    told = [next(((name, _metres(name, parameters[name])) for name in group if name in parameters), None) for group in groups]
    if told[0] is None:
        return None
    parameter, height_m = told[0]
    values = [None if one is None else one[1] for one in told[1:]]
    if autopilot == PX4:
        near_m, kind = values
        return OwnReturn(PX4, parameter, height_m, not kind, near_m=USUAL_MIN_DISTANCE_M if near_m is None else max(near_m, 0.0))
    climb_m, slope, kind = values
    slope = USUAL_CONE_SLOPE if slope is None else slope
    return OwnReturn(ARDUPILOT, parameter, height_m, not kind, max(climb_m or 0.0, 0.0), slope if slope >= LEAST_CONE_SLOPE else None)


def _metres(name: str, value: float) -> float:
    return value / 100.0 if name in IN_CENTIMETRES else value
