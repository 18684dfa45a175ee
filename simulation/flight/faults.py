"""What goes wrong: a value that can be replaced in flight."""

from dataclasses import dataclass

MOTORS = 4


class ImpossibleFault(ValueError):
    """A fault that this UAV cannot have."""


@dataclass(frozen=True, slots=True)
class Faults:
    """Times are simulated seconds since the start.

    link_lost_until_s   nothing is sent or heard until then; the link is the endpoint's matter
    gps_lost_until_s    no fix until then: the UAV goes by dead reckoning, which drifts
    battery_wh_left     what the battery holds from now on, less what is drawn from then; None: as it was
    motor_failed        index of a rotor that stands still, 0 to 3
    stuck_item          index of a mission item that is never done
    clock_offset_s      added to the UAV's own idea of the time of day; the endpoint's matter
    """

    link_lost_until_s: float = 0.0
    gps_lost_until_s: float = 0.0
    battery_wh_left: float | None = None
    motor_failed: int | None = None
    stuck_item: int | None = None
    clock_offset_s: float = 0.0

    def __post_init__(self) -> None:
        if self.motor_failed is not None and not 0 <= self.motor_failed < MOTORS:
            raise ImpossibleFault(f"There is no motor {self.motor_failed}: there are {MOTORS}, counted from 0.")
        if self.battery_wh_left is not None and not self.battery_wh_left >= 0.0:
            raise ImpossibleFault("A battery does not hold less than nothing.")
        if any(value != value for value in (self.link_lost_until_s, self.gps_lost_until_s, self.clock_offset_s)):
            raise ImpossibleFault("Times of faults are numbers.")

    def is_link_lost(self, now_s: float) -> bool:
        return now_s < self.link_lost_until_s

    def is_gps_lost(self, now_s: float) -> bool:
        return now_s < self.gps_lost_until_s
