"""A record of the log, as exported."""

from dataclasses import dataclass
from datetime import UTC, datetime

REPORTED = (
    "altitude_amsl_m", "altitude_relative_m", "altitude_agl_m",
    "velocity_north_mps", "velocity_east_mps", "velocity_down_mps", "airspeed_mps",
    "roll_deg", "pitch_deg", "heading_deg", "battery_percent", "battery_v", "battery_a", "mode", "is_armed", "is_in_air",
    "link_quality_percent", "gps_fix", "satellites", "hdop", "wind_north_mps", "wind_east_mps", "mission_item", "waypoint_sequence",
)  # fmt: skip
FLAGS = ("is_from_future", "is_late")

Value = float | int | bool | str | None


@dataclass(frozen=True, slots=True)
class LoggedRecord:
    """A UAV's report with its three times. `position` is longitude, latitude [deg]; `values` are those of REPORTED, then FLAGS."""

    id: int
    uav: int
    uav_name: str
    mission: str | None
    stream: str
    sequence: int
    measured_at: datetime
    received_at: datetime
    stored_at: datetime
    position: tuple[float, float] | None
    values: tuple[Value, ...]

    def value(self, name: str) -> Value:
        return self.values[PLACES[name]]

    @property
    def is_on_track(self) -> bool:
        """Return whether it has a position and a possible time."""
        return self.position is not None and not self.value("is_from_future")


PLACES = {name: place for place, name in enumerate((*REPORTED, *FLAGS))}


def time_text(instant: datetime) -> str:
    """Return the time as RFC 3339 in UTC, to the millisecond."""
    return instant.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.") + f"{instant.microsecond // 1000:03d}Z"
