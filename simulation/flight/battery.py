"""What is left in the battery, and its voltage under load."""

from dataclasses import dataclass

from simulation.flight.airframe import Airframe

LEAST_V = 1.0


@dataclass(frozen=True, slots=True)
class Battery:
    """`left_wh` at the moment when `used_wh` was drawn; what is drawn after that comes off it."""

    airframe: Airframe
    left_wh: float
    used_wh: float = 0.0

    @classmethod
    def charged(cls, airframe: Airframe, percent: float) -> "Battery":
        return cls(airframe, airframe.battery_wh * percent / 100.0)

    def left_after(self, used_wh: float) -> float:
        return max(self.left_wh - (used_wh - self.used_wh), 0.0)

    def percent_after(self, used_wh: float) -> float:
        return 100.0 * self.left_after(used_wh) / self.airframe.battery_wh

    def with_left(self, left_wh: float, used_wh: float) -> "Battery":
        """Weakened, or exchanged, at this moment."""
        return Battery(self.airframe, min(left_wh, self.airframe.battery_wh), used_wh)

    def under_load(self, used_wh: float, power_w: float) -> tuple[float, float]:
        """Volts and amperes: an open voltage that falls with the charge, less what the current takes of it."""
        airframe = self.airframe
        share = self.left_after(used_wh) / airframe.battery_wh
        open_v = airframe.cells * (airframe.empty_cell_v + (airframe.full_cell_v - airframe.empty_cell_v) * share)
        # P = U I and U = open - R I: the root with the small current; beyond the greatest power the voltage breaks down to half.
        under_root = max(open_v**2 - 4.0 * airframe.resistance_ohm * power_w, 0.0)
        volts = max(0.5 * (open_v + under_root**0.5), LEAST_V)
        return volts, power_w / volts
