"""What a UAV's flight takes: its battery, weight, rotors and drag, by default those of the PX4 Iris."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

GRAVITY_MPS2 = 9.806_65
STANDARD_DENSITY = 1.225  # kg/m3, ISO 2533 at sea level

# The Iris of PX4's Gazebo models (iris.sdf.jinja, gazebo_motor_model.cpp): 1.5 kg, sensors and rotors 0.045 kg; rotors of 0.128 m radius.
IRIS_MASS_KG = 1.545
IRIS_ROTOR_DISK_M2 = 4 * math.pi * 0.128**2
IRIS_MAX_AIRSPEED_MPS = 11.0  # where the tilt limit of 35 degrees leaves room for control; 12.9 m/s is all it can do
IRIS_BATTERY_WH = 56.6  # 3S 5.1 Ah
# Rotor drag 1.75e-4 N per rad/s and m/s, four rotors at 805 rad/s in the hover: 0.56 N per m/s, with 15.15 N of thrust.
IRIS_ROTOR_DRAG = 0.0372
IRIS_DRAG_AREA_M2 = 0.012
IRIS_DRAG_TO_WEIGHT = IRIS_ROTOR_DRAG * IRIS_MAX_AIRSPEED_MPS + (
    0.5 * STANDARD_DENSITY * IRIS_DRAG_AREA_M2 * IRIS_MAX_AIRSPEED_MPS**2 / (IRIS_MASS_KG * GRAVITY_MPS2)
)  # at its maximum airspeed: 0.47
MAX_BODY_DRAG = 0.5  # of all drag at the maximum airspeed

MASSES_KG = (0.05, 1_000.0)
BATTERIES_WH = (1.0, 100_000.0)
RESERVES_PERCENT = (0.0, 90.0)
AIRSPEEDS_MPS = (1.0, 100.0)
ROTOR_DISKS_M2 = (0.001, 1_000.0)
EFFICIENCIES = (0.1, 0.95)  # of a hover: a fault of units lies outside


class InvalidPerformance(ValueError):
    """Figures that no UAV has; `place` names the entry as the JSON does, `bounds` are what it has to lie between."""

    def __init__(self, place: str, message: str, bounds: tuple[float, float] | None = None) -> None:
        super().__init__(f"{place}: {message}")
        self.place = place
        self.message = message
        self.bounds = bounds


@dataclass(frozen=True)
class Performance:
    """How a UAV turns a battery into flight. Raises InvalidPerformance.

    battery_wh         energy of a full battery; None: seconds can be told, watt-hours left cannot
    mass_kg            at take-off
    reserve_percent    of the battery that no plan uses
    max_airspeed_mps   the fastest it flies through the air; None: its cruising speed, which it is known to fly
    climb_speed_mps    straight up; None: as the plan's rules have it; likewise descent_speed_mps
    rotor_disk_m2      the circles of all rotors together
    hover_power_w      measured in a hover in calm air of 1.225 kg/m3; None: worked out with the efficiency
    efficiency         share of electrical power that lifts in the hover: figure of merit x motors x speed controllers; the Iris flies
                       20 minutes on 56.6 Wh with 0.52
    avionics_w         autopilot, radio, camera
    drag_area_m2       CdA of all but the rotors, along the rotors' plane; None: see body_drag_area_m2
    rotor_drag         drag of the rotors in their plane for each newton of thrust and m/s of air [s/m]; None: see disk_drag
    """

    battery_wh: float | None = None
    mass_kg: float = IRIS_MASS_KG
    reserve_percent: float = 20.0
    max_airspeed_mps: float | None = None
    climb_speed_mps: float | None = None
    descent_speed_mps: float | None = None
    rotor_disk_m2: float = IRIS_ROTOR_DISK_M2
    hover_power_w: float | None = None
    efficiency: float = 0.52
    avionics_w: float = 8.0
    drag_area_m2: float | None = None
    rotor_drag: float | None = None

    def __post_init__(self) -> None:
        _check(self.battery_wh, *BATTERIES_WH, "battery_wh")
        _check(self.mass_kg, *MASSES_KG, "mass_kg")
        _check(self.reserve_percent, *RESERVES_PERCENT, "reserve_percent")
        _check(self.max_airspeed_mps, *AIRSPEEDS_MPS, "max_airspeed_mps")
        _check(self.climb_speed_mps, 0.1, 30.0, "climb_speed_mps")
        _check(self.descent_speed_mps, 0.1, 30.0, "descent_speed_mps")
        _check(self.rotor_disk_m2, *ROTOR_DISKS_M2, "rotor_disk_m2")
        _check(self.efficiency, *EFFICIENCIES, "efficiency")
        _check(self.avionics_w, 0.0, 10_000.0, "avionics_w")
        _check(self.drag_area_m2, 0.0, 100.0, "drag_area_m2")
        _check(self.rotor_drag, 0.0, 1.0, "rotor_drag")
        low, high = EFFICIENCIES
        if self.hover_power_w is not None and not low <= self.hover_efficiency <= high:
            least_w, most_w = (self.avionics_w + self._ideal_hover_w / share for share in (high, low))
            words = f"must be from {least_w:.0f} to {most_w:.0f} for this mass and these rotors"
            raise InvalidPerformance("hover_power_w", words, (least_w, most_w))

    @property
    def weight_n(self) -> float:
        return self.mass_kg * GRAVITY_MPS2

    @property
    def body_drag_area_m2(self) -> float:
        """drag_area_m2, or the Iris's for each kilogram, as the Inspector has it as well within a tenth; see disk_drag.

        At a stated maximum airspeed it is at most half of what drag is there: a fast UAV is slender.
        """
        if self.drag_area_m2 is not None:
            return self.drag_area_m2
        if self.max_airspeed_mps is None:
            return IRIS_DRAG_AREA_M2
        area_m2 = IRIS_DRAG_AREA_M2 * self.mass_kg / IRIS_MASS_KG
        return min(area_m2, MAX_BODY_DRAG * self._drag_at_limit_n / (0.5 * STANDARD_DENSITY * self.max_airspeed_mps**2))

    @property
    def disk_drag(self) -> float:
        """rotor_drag, or what the body leaves of the Iris's share of drag to weight at the stated maximum airspeed [s/m].

        An airspeed limit is where the tilt leaves room for control: at theirs the Iris and the Inspector both have 0.47 to 0.49 of their
        weight as drag (tilts of 25 and 26 degrees). Without a stated airspeed the Iris's.
        """
        if self.rotor_drag is not None:
            return self.rotor_drag
        if self.max_airspeed_mps is None:
            return IRIS_ROTOR_DRAG
        body_n = 0.5 * STANDARD_DENSITY * self.body_drag_area_m2 * self.max_airspeed_mps**2
        return max(self._drag_at_limit_n - body_n, 0.0) / (self.weight_n * self.max_airspeed_mps)

    @property
    def _drag_at_limit_n(self) -> float:
        """What a UAV whose drag is not stated has at its maximum airspeed."""
        return IRIS_DRAG_TO_WEIGHT * self.weight_n

    @property
    def usable_wh(self) -> float | None:
        """What a plan may use of the battery."""
        return None if self.battery_wh is None else self.battery_wh * (1.0 - self.reserve_percent / 100.0)

    @property
    def hover_efficiency(self) -> float:
        """The efficiency that the measured hover shows, or else the one given."""
        if self.hover_power_w is None:
            return self.efficiency
        return self._ideal_hover_w / (self.hover_power_w - self.avionics_w) if self.hover_power_w > self.avionics_w else math.inf

    def with_mass(self, mass_kg: float) -> "Performance":
        """With other payload on the same rotors: a measured hover takes as much more as thrust to the power of 1.5. Raises
        InvalidPerformance."""
        _check(mass_kg, *MASSES_KG, "mass_kg")
        lifting_w = None if self.hover_power_w is None else (self.hover_power_w - self.avionics_w) * (mass_kg / self.mass_kg) ** 1.5
        return replace(self, mass_kg=mass_kg, hover_power_w=None if lifting_w is None else self.avionics_w + lifting_w)

    @property
    def _ideal_hover_w(self) -> float:
        """Momentum theory: T ** 1.5 / sqrt(2 rho A)."""
        return float(self.weight_n**1.5 / math.sqrt(2.0 * STANDARD_DENSITY * self.rotor_disk_m2))


# What the API and a UAV type hold; the rest is the same for all.
PERFORMANCE_KEYS = ("battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps", "rotor_disk_m2", "hover_power_w")
# What a UAV may have of its own; its rotors are its type's.
OWN_PERFORMANCE_KEYS = ("battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps")


def performance_to_json(performance: Performance) -> dict[str, Any]:
    return {key: getattr(performance, key) for key in PERFORMANCE_KEYS}


def performance_from_json(value: Any) -> Performance:
    """A performance from the API's keys; what is null or left out is as it is by default. Raises InvalidPerformance."""
    if value is None:
        return BY_DEFAULT
    if not isinstance(value, Mapping):
        raise InvalidPerformance("performance", "must be an object")
    read: dict[str, Any] = {}
    for key, entry in value.items():
        if key not in PERFORMANCE_KEYS:
            raise InvalidPerformance(key, "is not known")
        if entry is None:
            continue
        if isinstance(entry, bool) or not isinstance(entry, int | float):
            raise InvalidPerformance(key, "must be a number")
        try:
            read[key] = float(entry)
        except OverflowError:
            raise InvalidPerformance(key, "is too large") from None
    return Performance(**read) if read else BY_DEFAULT


def _check(value: float | None, low: float, high: float, place: str) -> None:
    if value is not None and not low <= value <= high:
        raise InvalidPerformance(place, f"must be from {low:g} to {high:g}", (low, high))


BY_DEFAULT = Performance()
