"""How long the ground station waits, and how often it tries again."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TransferRules:
    """Of mission transfers; the first three are those that the MAVLink guide recommends.

    A list is asked for or announced every `timeout_s`, an item is sent or asked for again every `item_timeout_s`. What is given up is not a
    message but the lack of progress: a transfer ends when for `silence_s` nothing new has come, however many items got through before. So
    an item is tried some thirty times in what the guide grants five tries, and 200 items pass a link that loses 30 % each way; slower
    links need a longer `item_timeout_s` (on 57 kbit/s 0.25 s repeats what is still under way).

    `attempts` is how often a whole transfer is begun, with reading back in between.
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
        """Without an answer for so long a reading is begun anew: PX4 forgets it after 5 s."""
        return 3 * self.timeout_s

    def longest_s(self, items: int) -> float:
        """Of one transfer, however steadily it goes on."""
        return self.silence_s + 2 * self.timeout_s * items


@dataclass(frozen=True)
class CommandRules:
    """Of commands.

    A command is sent again after `timeout_s` without an answer, at most `retries` times. Its effect must show within `effect_s` after the
    vehicle said yes, leaving the ground within `lift_off_s`. A refusal counts after `refusal_s`, in case it was the late answer to an
    earlier command. While the vehicle says that it is at work, it is waited for as long as `in_progress_s` from one report to the next.
    A state older than `fresh_s` is not taken for the present one.
    """

    timeout_s: float = 1.5
    retries: int = 5
    effect_s: float = 3.0
    lift_off_s: float = 20.0
    refusal_s: float = 1.0
    in_progress_s: float = 10.0
    fresh_s: float = 3.0
