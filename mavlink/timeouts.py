"""Timeouts and retries of the ground station."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TransferRules:
    """Timeouts of mission transfers; the first three values are the MAVLink guide's recommendations.

    A list is requested or announced every `timeout_s`, an item sent or requested again every `item_timeout_s`. A transfer ends when no
    progress is made for `silence_s`, however many items were transferred before. An item thus gets some thirty tries in the time of the
    guide's five, and 200 items pass a link with 30 % loss each way. Slower links need a longer `item_timeout_s`: on 57 kbit/s, 0.25 s
    repeats items still in transmission.

    `attempts` is how often a whole transfer is tried, with a readback in between.
    """

    timeout_s: float = 1.5
    item_timeout_s: float = 0.25
    retries: int = 5
    attempts: int = 3

    def __post_init__(self) -> None:
        if not (0 < self.item_timeout_s <= self.timeout_s and self.retries >= 1 and self.attempts >= 1):
            raise ValueError("item_timeout_s must be above 0 and not above timeout_s; retries and attempts at least 1")

    @property
    def silence_s(self) -> float:
        return self.timeout_s * (1 + self.retries)

    @property
    def restart_s(self) -> float:
        """Return the time without an answer after which a download restarts: PX4 drops it after 5 s."""
        return 3 * self.timeout_s

    def longest_s(self, items: int) -> float:
        """Return the maximum duration of one transfer."""
        return self.silence_s + 2 * self.timeout_s * items


@dataclass(frozen=True)
class CommandRules:
    """Timeouts of commands.

    A command is sent again after `timeout_s` without an answer, at most `retries` times. Its effect must show within `effect_s` after the
    acceptance, the take-off within `lift_off_s`. A refusal counts after `refusal_s`, as it may be the late answer to an earlier command.
    While the vehicle reports progress, each further report may take `in_progress_s`. A state older than `fresh_s` does not count as
    current.
    """

    timeout_s: float = 1.5
    retries: int = 5
    effect_s: float = 3.0
    lift_off_s: float = 20.0
    refusal_s: float = 1.0
    in_progress_s: float = 10.0
    fresh_s: float = 3.0
