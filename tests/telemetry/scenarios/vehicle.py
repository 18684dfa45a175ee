"""What a scenario does to its vehicle, and sees of it beside what the gateway tells."""

from typing import Protocol

from inspection.geodesy import LonLat
from mavlink.mission_sync.wire import OnboardItem
from mavlink.vehicle_plan import MissionType
from tests.missions.worlds import UAV_AT

HOME_AMSL_M = 100.0
RALLY_AT = LonLat(UAV_AT.lon + 0.001, UAV_AT.lat)


class ScenarioVehicle(Protocol):
    """The real firmware or the scripted vehicle. `at` is its home, `place` where it is: longitude, latitude."""

    at: tuple[float, float]

    def reboot(self) -> None: ...

    def lose_power(self) -> None: ...

    def set(self, name: str, value: float) -> None: ...

    def held(self, kind: MissionType) -> list[OnboardItem]: ...

    def shorten(self) -> None: ...

    @property
    def is_armed(self) -> bool: ...

    @property
    def custom_mode(self) -> int: ...

    @property
    def height_m(self) -> float: ...

    @property
    def place(self) -> tuple[float, float]: ...

    @property
    def is_ready(self) -> bool: ...
