"""What a companion needs of an autopilot. `kinematic.py` is a stand-in; a real one speaks MAVLink or ROS 2 behind the same six methods."""

from dataclasses import dataclass, field
from typing import Any, Protocol


class Refused(Exception):
    """The autopilot does not do this, and says why."""


@dataclass(frozen=True)
class Events:
    """What has happened since it was asked last: places of targets with their outcome, and how the flight ended (None: it has not).

    photos: each when it was taken [s since 1970], and a capture of the link without its number and time.
    """

    targets: list[tuple[int, str, str]] = field(default_factory=list)  # place, complete or skipped or failed, a note
    flight_ended: str | None = None  # flown or failed
    photos: list[tuple[float, dict[str, Any]]] = field(default_factory=list)


class Autopilot(Protocol):
    """It flies by itself: nothing here needs the link. Commands set a state, so that the same one again changes nothing."""

    def load(self, content: dict[str, Any], now_s: float) -> dict[str, Any]:
        """Put a flight onto it, and return what it holds afterwards, read back. Raises Refused; then it holds what it held."""

    def clear(self, now_s: float) -> None:
        """Raises Refused."""

    def command(self, kind: str, parameters: dict[str, Any], now_s: float) -> None:
        """Begin to do it. Raises Refused."""

    def has_done(self, kind: str, now_s: float) -> bool:
        """Whether the command is seen to be done: an answer is not a flight."""

    def report(self, now_s: float) -> dict[str, Any]:
        """A record of the log without its number and time: position, heights that name their reference, speeds, battery, mode."""

    def events(self, now_s: float) -> Events:
        """Each is told once."""
