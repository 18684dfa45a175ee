"""Combines a vehicle's messages into one measurement for each position that it reports."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding.measurement import Measurement, believable
from mavlink.frames import Message

PIECE = 50  # characters of a full piece; a shorter one is the last
TIMEOUT_S = 3.0
MAX_OPEN = 8
MAX_TEXT_LENGTH = 500
KEPT_S = 10.0  # older values count as unknown
E7 = 1e7
UNKNOWN_U16 = 65_535
UNKNOWN_SATELLITES = 255
FIX_2D = 2
Values = dict[str, Any]


@dataclass(frozen=True)
class StatusText:
    """severity: MAV_SEVERITY, 0 emergency to 7 debug."""

    severity: int
    text: str
    received_s: float


@dataclass
class _Open:
    severity: int
    received_s: float
    pieces: dict[int, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        ends = range(max(self.pieces) + 1)
        return "".join(self.pieces.get(number, "…") for number in ends)


@dataclass
class TextCollector:
    """Assembles the status texts of one vehicle. A text that misses a piece after the timeout is returned with a gap."""

    _open: dict[tuple[int, int], _Open] = field(default_factory=dict)

    def receive(self, message: Message, now_s: float) -> list[StatusText]:
        text = _clean(message.text)
        number = getattr(message, "id", 0)
        if number == 0:
            return [StatusText(message.severity, text, now_s)] if text else []
        key = (message.get_srcComponent(), number)
        collected = self._open.setdefault(key, _Open(message.severity, now_s))
        collected.pieces[message.chunk_seq] = text
        last = next((place for place, piece in collected.pieces.items() if len(piece) < PIECE), None)
        if last is not None and all(place in collected.pieces for place in range(last)):
            return [_closed(self._open.pop(key))]
        return self._overdue(now_s, most=MAX_OPEN)

    def tick(self, now_s: float) -> list[StatusText]:
        return self._overdue(now_s, most=MAX_OPEN)

    def _overdue(self, now_s: float, *, most: int) -> list[StatusText]:
        over = [key for key, collected in self._open.items() if now_s - collected.received_s > TIMEOUT_S]
        over += [key for key in self._open if key not in over][: max(len(self._open) - len(over) - most, 0)]
        return [_closed(self._open.pop(key)) for key in over]


def _closed(collected: _Open) -> StatusText:
    return StatusText(collected.severity, collected.text[:MAX_TEXT_LENGTH], collected.received_s)


def _clean(text: str | bytes) -> str:
    words = text.decode(errors="replace") if isinstance(text, bytes) else text
    return "".join(letter if letter.isprintable() else " " for letter in words.rstrip("\0"))


@dataclass(frozen=True)
class FlownState:
    """The vehicle's own state; see mavlink/vehicle_state.py."""

    mode: str = ""
    is_armed: bool | None = None
    is_in_air: bool | None = None
    mission_item: int | None = None
    link_quality_percent: float | None = None


@dataclass
class MeasurementDecoder:
    """Decodes the measurements of one vehicle from every message of its autopilot."""

    _values: dict[str, tuple[float, Values]] = field(default_factory=dict)

    def receive(self, message: Message, now_s: float) -> None:
        read = _READ.get(message.get_type())
        if read is not None and (values := read(message)) is not None:
            self._values[message.get_type()] = (now_s, values)

    def measurement(self, message: Message, flown: FlownState, now_s: float) -> Measurement:
        """Return the position of a GLOBAL_POSITION_INT joined with the latest other values."""
        known: Values = {}
        for name in _READ:  # later names override earlier ones
            at_s, values = self._values.get(name, (-math.inf, {}))
            if now_s - at_s <= KEPT_S:
                known |= {field: value for field, value in values.items() if value is not None}
        known |= {field: value for field, value in _position(message, known.get("gps_fix")).items() if value is not None}
        return believable(
            Measurement(
                **known,
                mode=flown.mode,
                is_armed=flown.is_armed,
                is_in_air=flown.is_in_air,
                mission_item=flown.mission_item,
                link_quality_percent=flown.link_quality_percent,
            )
        )


def is_place(latitude_e7: int, longitude_e7: int, gps_fix: int | None = None) -> bool:
    """Return whether this is a place on Earth, and not the zeros of a vehicle without a position."""
    if latitude_e7 == 0 and longitude_e7 == 0 and (gps_fix is None or gps_fix < FIX_2D):
        return False
    return abs(latitude_e7) <= 900_000_000 and abs(longitude_e7) <= 1_800_000_000


def _position(message: Message, gps_fix: int | None) -> Values:
    values: Values = {
        "altitude_relative_m": message.relative_alt / 1000,
        "velocity_north_mps": message.vx / 100,
        "velocity_east_mps": message.vy / 100,
        "velocity_down_mps": message.vz / 100,
        "heading_deg": message.hdg / 100 if message.hdg != UNKNOWN_U16 else None,
    }
    if is_place(message.lat, message.lon, gps_fix):
        values |= {"latitude_deg": message.lat / E7, "longitude_deg": message.lon / E7, "altitude_amsl_m": message.alt / 1000}
    return values


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _degrees(angle_rad: float) -> float | None:
    return math.degrees(angle_rad) if math.isfinite(angle_rad) else None


def _attitude(message: Message) -> Values:
    return {"roll_deg": _degrees(message.roll), "pitch_deg": _degrees(message.pitch), "heading_deg": _degrees(message.yaw)}


def _hud(message: Message) -> Values:
    return {"airspeed_mps": _finite(message.airspeed)}


def _system_status(message: Message) -> Values:
    return {
        "battery_v": message.voltage_battery / 1000 if message.voltage_battery != UNKNOWN_U16 else None,
        "battery_a": message.current_battery / 100 if message.current_battery >= 0 else None,
        "battery_percent": float(message.battery_remaining) if 0 <= message.battery_remaining <= 100 else None,
    }


def _battery(message: Message) -> Values | None:
    """Decode the first battery. A voltage above 65.5 V is split over two cells."""
    if message.id != 0:
        return None
    cells = [cell for cell in message.voltages if cell != UNKNOWN_U16]
    cells += [cell for cell in getattr(message, "voltages_ext", []) if 0 < cell < UNKNOWN_U16]
    return {
        "battery_v": sum(cells) / 1000 if cells else None,
        "battery_a": message.current_battery / 100 if message.current_battery >= 0 else None,
        "battery_percent": float(message.battery_remaining) if 0 <= message.battery_remaining <= 100 else None,
    }


def _gps(message: Message) -> Values:
    return {
        "gps_fix": message.fix_type,
        "satellites": message.satellites_visible if message.satellites_visible != UNKNOWN_SATELLITES else None,
        "hdop": message.eph / 100 if message.eph != UNKNOWN_U16 else None,
    }


def _wind(message: Message) -> Values | None:
    """Decode ArduPilot's wind, which names where it blows from. Exactly 0 m/s means neither measured nor estimated."""
    if not (math.isfinite(message.direction) and math.isfinite(message.speed)) or message.speed == 0.0:
        return None
    from_rad = math.radians(message.direction)
    return {"wind_north_mps": -message.speed * math.cos(from_rad), "wind_east_mps": -message.speed * math.sin(from_rad)}


def _wind_estimate(message: Message) -> Values:
    """Decode PX4's wind, which names where the air moves to."""
    return {"wind_north_mps": _finite(message.wind_x), "wind_east_mps": _finite(message.wind_y)}


_READ: dict[str, Callable[[Message], Values | None]] = {
    "ATTITUDE": _attitude,
    "VFR_HUD": _hud,
    "SYS_STATUS": _system_status,
    "BATTERY_STATUS": _battery,
    "GPS_RAW_INT": _gps,
    "WIND": _wind,
    "WIND_COV": _wind_estimate,
}


def is_vehicle(message: Message) -> bool:
    """Return whether a HEARTBEAT comes from the autopilot of a vehicle, not from a ground station, camera or radio."""
    not_flying = {mavlink.MAV_TYPE_GCS, mavlink.MAV_TYPE_ANTENNA_TRACKER, mavlink.MAV_TYPE_ADSB}
    return message.autopilot != mavlink.MAV_AUTOPILOT_INVALID and message.type not in not_flying
