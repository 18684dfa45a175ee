"""Parameters of a simulated UAV: each has its effect, or is fixed at the value that matches the vehicle's behaviour.

All are sent as 32-bit floats, so that both encodings of integers agree.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.flight.airframe import Settings
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import Outgoing, Station

BY_NAME = -1
REAL32 = mavlink.MAV_PARAM_TYPE_REAL32
NAME_LENGTH = 16

Configure = Callable[[Settings], None]


@dataclass(frozen=True)
class Parameter:
    """Settable between `lowest` and `highest`; fixed if these are equal.

    `setting` is the autopilot's setting that it shows, multiplied by `per_unit`; without one it shows `value`.
    """

    name: str
    lowest: float
    highest: float
    setting: str = ""
    per_unit: float = 1.0
    value: float = 0.0

    @property
    def is_fixed(self) -> bool:
        return self.lowest == self.highest


def fixed(name: str, value: float) -> Parameter:
    return Parameter(name, value, value, value=value)


PX4 = (
    Parameter("MIS_TAKEOFF_ALT", 1.0, 80.0, "take_off_height_m"),
    Parameter("RTL_RETURN_ALT", 0.0, 150.0, "return_height_m"),
    fixed("RTL_MIN_DIST", 0.0),
    fixed("RTL_CONE_ANG", 0.0),
    fixed("RTL_TYPE", 0.0),
    fixed("GF_AVOID_NODES", 0.0),
    fixed("MIS_DIST_1WP", 0.0),  # not limited
    fixed("MIS_DIST_WPS", 0.0),
    Parameter("NAV_ACC_RAD", 0.5, 50.0, "acceptance_m"),
    Parameter("BAT_LOW_THR", 0.05, 0.5, "battery_low_percent", 0.01),
    Parameter("BAT_CRIT_THR", 0.03, 0.25, "battery_critical_percent", 0.01),
    Parameter("COM_DISARM_PRFLT", 1.0, 600.0, "disarm_on_ground_s"),
    Parameter("GF_ACTION", 0.0, 3.0, value=2.0),
)
ARDUPILOT = (
    Parameter("RTL_ALT", 0.0, 15_000.0, "return_height_m", 100.0),
    fixed("RTL_CLIMB_MIN", 0.0),
    fixed("RTL_CONE_SLOPE", 0.0),
    fixed("RTL_ALT_TYPE", 0.0),
    fixed("OA_TYPE", 0.0),
    fixed("RALLY_INCL_HOME", 1.0),
    fixed("RALLY_LIMIT_KM", 0.0),  # not limited
    fixed("RALLY_TOTAL", 0.0),
    fixed("FENCE_TOTAL", 0.0),
    fixed("MIS_RESTART", 0.0),
    fixed("AUTO_OPTIONS", 2.0),  # takes off in AUTO without stick input
    fixed("FS_GCS_ENABLE", 0.0),
    Parameter("WPNAV_RADIUS", 50.0, 5_000.0, "acceptance_m", 100.0),
    Parameter("DISARM_DELAY", 1.0, 127.0, "disarm_on_ground_s"),
    Parameter("FENCE_ENABLE", 0.0, 1.0, value=1.0),
    Parameter("FENCE_ACTION", 0.0, 4.0, value=4.0),
    fixed("FENCE_AUTOENABLE", 0.0),
    fixed("FENCE_TYPE", 4.0),  # polygons and circles
)


def settings_at_start(settings: Settings, autopilot_type: SimulatedAutopilot) -> Settings:
    """Return the settings that no parameter controls and that differ by autopilot."""
    return replace(settings, return_adds_to_rally_point=autopilot_type is SimulatedAutopilot.PX4)


def parameters_of(autopilot_type: SimulatedAutopilot, system: int, settings: Settings, configure: Configure) -> "Parameters":
    if autopilot_type is SimulatedAutopilot.PX4:
        return Parameters([*PX4, fixed("MAV_SYS_ID", float(system))], settings, configure)
    return Parameters([*ARDUPILOT, fixed("SYSID_THISMAV", float(system))], settings, configure)


class Parameters:
    """Handles PARAM_REQUEST_LIST, PARAM_REQUEST_READ and PARAM_SET; each request is answered."""

    def __init__(self, parameters: Iterable[Parameter], settings: Settings, configure: Configure) -> None:
        self._parameters = {parameter.name: parameter for parameter in parameters}
        self._names = list(self._parameters)
        self._settings = settings
        self._configure = configure
        self._values = {parameter.name: _shown(parameter, settings) for parameter in self._parameters.values()}

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def show(self, name: str, value: float) -> None:
        """Set the value of a parameter that shows no setting, if it exists."""
        if name in self._values:
            self._values[name] = value

    def receive(self, message: Any, station: Station) -> list[Outgoing]:
        name = message.get_type()
        if name == "PARAM_REQUEST_LIST":
            return [self._reported(number, station) for number in range(len(self._names))]
        if name == "PARAM_REQUEST_READ":
            return self._read(message, station)
        return self._set(message, station) if name == "PARAM_SET" else []

    def _read(self, message: Any, station: Station) -> list[Outgoing]:
        number = message.param_index
        if number == BY_NAME:
            number = self._names.index(message.param_id) if message.param_id in self._values else len(self._names)
        if not 0 <= number < len(self._names):
            return [_error(message.param_id, message.param_index, mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST, station)]
        return [self._reported(number, station)]

    def _set(self, message: Any, station: Station) -> list[Outgoing]:
        """Answer with the value in force; a refusal adds an error."""
        parameter = self._parameters.get(message.param_id)
        if parameter is None:
            return [_error(message.param_id, BY_NAME, mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST, station)]
        number, value = self._names.index(parameter.name), message.param_value
        if value == self._values[parameter.name]:
            return [self._reported(number, station)]
        if parameter.is_fixed:
            return [_error(parameter.name, number, mavlink.MAV_PARAM_ERROR_READ_ONLY, station), self._reported(number, station)]
        if not (math.isfinite(value) and parameter.lowest <= value <= parameter.highest):
            return [_error(parameter.name, number, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, station), self._reported(number, station)]
        self._values[parameter.name] = value
        if parameter.setting:
            self._settings = replace(self._settings, **{parameter.setting: value / parameter.per_unit})
            self._configure(self._settings)
        return [Outgoing(self._reported(number, station).message)]  # to all, as other stations show the old value

    def _reported(self, number: int, station: Station) -> Outgoing:
        name = self._names[number]
        message = mavlink.MAVLink_param_value_message(name.encode(), self._values[name], REAL32, len(self._names), number)
        return Outgoing(message, station)


def _shown(parameter: Parameter, settings: Settings) -> float:
    return float(getattr(settings, parameter.setting)) * parameter.per_unit if parameter.setting else parameter.value


def _error(name: str, number: int, error: int, station: Station) -> Outgoing:
    identity = name.encode(errors="replace")[:NAME_LENGTH]
    return Outgoing(mavlink.MAVLink_param_error_message(*station.target, identity, number, error), station)
