"""What is kept from a zone in time and height."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ZoneRules:
    time_margin_s: float = 300.0  # before a zone begins to apply and after it has ended
    height_margin_m: float = 10.0  # below a zone's lower limit and above its upper one

    def __post_init__(self) -> None:
        if not (self.time_margin_s >= 0 and self.height_margin_m >= 0):
            raise ValueError(f"margins ({self.time_margin_s} s, {self.height_margin_m} m) are at least 0")
