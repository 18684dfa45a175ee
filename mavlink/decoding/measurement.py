"""The values of one report of a UAV, from either link, and their plausibility check."""

import math
from dataclasses import dataclass, field, fields, replace

from mavlink.frames import Message

KEPT_FRAMES = 200.0  # length of the running mean
MAX_GAP = 128  # of numbers that wrap at 256; a larger step is a duplicate, a reordered frame or a restart
RADIO_FULL = 254
RADIO_UNKNOWN = 255
RADIO_KEPT_S = 10.0
MAX_MODE_LENGTH = 30
_SMALLEST, _MAX_SMALL, _MAX_INT = 0, 32_767, 2_147_483_647
_COUNTED = (("mission_item", _MAX_INT), ("waypoint_sequence", _MAX_INT))


@dataclass
class LinkQuality:
    """Link quality of one vehicle."""

    _last: dict[int, int] = field(default_factory=dict)  # by component
    _received: float = 0.0
    _sent: float = 0.0
    _radio_percent: float | None = None
    _radio_at_s: float = 0.0

    def count(self, component: int, sequence: int) -> None:
        before = self._last.get(component)
        step = 1 if before is None else (sequence - before) % 256
        if not 1 <= step <= MAX_GAP:
            return
        self._last[component] = sequence
        kept = (1.0 - 1.0 / KEPT_FRAMES) ** step
        self._received = self._received * kept + 1.0
        self._sent = self._sent * kept + step

    def receive_radio(self, message: Message, now_s: float) -> None:
        """Take a RADIO_STATUS; the weaker end counts."""
        ends = [rssi for rssi in (message.rssi, message.remrssi) if rssi != RADIO_UNKNOWN]
        if ends:
            self._radio_percent, self._radio_at_s = 100.0 * min(*ends, RADIO_FULL) / RADIO_FULL, now_s

    def percent(self, now_s: float) -> float | None:
        if self._radio_percent is not None and now_s - self._radio_at_s <= RADIO_KEPT_S:
            return self._radio_percent
        return round(min(100.0 * self._received / self._sent, 100.0), 1) if self._sent else None


@dataclass(frozen=True, slots=True)
class Measurement:
    """Values of one moment; None is unknown. Velocities point north, east and down; the wind is where the air moves to.

    `mission_item` is the autopilot's own count, which only MAVLink reports; `waypoint_sequence` is the waypoint of the approved route.
    """

    longitude_deg: float | None = None
    latitude_deg: float | None = None
    altitude_amsl_m: float | None = None
    altitude_relative_m: float | None = None
    altitude_agl_m: float | None = None
    velocity_north_mps: float | None = None
    velocity_east_mps: float | None = None
    velocity_down_mps: float | None = None
    airspeed_mps: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    heading_deg: float | None = None
    battery_percent: float | None = None
    battery_v: float | None = None
    battery_a: float | None = None
    mode: str = ""
    is_armed: bool | None = None
    is_in_air: bool | None = None
    link_quality_percent: float | None = None
    gps_fix: int | None = None
    satellites: int | None = None
    hdop: float | None = None
    wind_north_mps: float | None = None
    wind_east_mps: float | None = None
    mission_item: int | None = None
    waypoint_sequence: int | None = None


_FLOATS = tuple(field.name for field in fields(Measurement) if field.name.endswith(("_deg", "_m", "_mps", "_percent", "_v", "_a", "hdop")))


def believable(measurement: Measurement) -> Measurement:
    """Return the measurement without impossible values: NaN, places off the Earth, batteries above 100 %. Headings become 0 to < 360."""
    wrong: dict[str, float | int | str | None] = {
        name: None for name in _FLOATS if (value := getattr(measurement, name)) is not None and not math.isfinite(value)
    }
    if not _is_place(measurement.longitude_deg, measurement.latitude_deg):
        wrong |= {"longitude_deg": None, "latitude_deg": None}
    for name in ("battery_percent", "link_quality_percent"):
        if (value := getattr(measurement, name)) is not None and not 0 <= value <= 100:
            wrong[name] = None
    for name, largest in (("gps_fix", _MAX_SMALL), ("satellites", _MAX_SMALL), *_COUNTED):
        if (value := getattr(measurement, name)) is not None and not _SMALLEST <= value <= largest:
            wrong[name] = None
    heading_deg = measurement.heading_deg
    if heading_deg is not None and math.isfinite(heading_deg) and not 0 <= heading_deg < 360:
        wrong["heading_deg"] = heading_deg % 360.0 % 360.0  # twice: the first gives 360 for a tiny negative angle
    if "\0" in measurement.mode or len(measurement.mode) > MAX_MODE_LENGTH:
        wrong["mode"] = measurement.mode.replace("\0", "")[:MAX_MODE_LENGTH]
    return replace(measurement, **wrong) if wrong else measurement  # type: ignore[arg-type]


def _is_place(longitude_deg: float | None, latitude_deg: float | None) -> bool:
    """Return whether this is a place on Earth; false for NaN, which compares false."""
    return longitude_deg is not None and latitude_deg is not None and -180 <= longitude_deg <= 180 and -90 <= latitude_deg <= 90
