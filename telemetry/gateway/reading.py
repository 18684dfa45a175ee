"""What is asked of a vehicle just before it flies its list: whether it holds the approved one, and whence it counts its heights.

Somebody else may have put another list on it since it was loaded, and it may have booted elsewhere.
"""

from collections.abc import Callable
from dataclasses import dataclass

from django.conf import settings

from missions.mavlink.content import FlightLoad, MissionType
from telemetry.gateway.conversation import Conversation, Keeper
from telemetry.gateway.session import Session
from telemetry.ground_station.compare import differences
from telemetry.ground_station.download import Download
from telemetry.ground_station.ends import Ends
from telemetry.ground_station.flavour import RESTARTS, Flavour
from telemetry.ground_station.home_reading import HomeReading
from telemetry.ground_station.parameters import ParameterReading
from telemetry.ground_station.transfer import TransferState
from telemetry.ground_station.wire import held_list

READINGS = 2  # a difference counts when a second reading shows it: the first may have been a late answer


@dataclass(frozen=True)
class Reading:
    """`code` and `words` say why it is not `is_aboard`."""

    is_aboard: bool
    code: str = ""
    words: str = ""


async def read_aboard(session: Session, load: FlightLoad, is_wanted: Callable[[], bool]) -> Reading | None:
    """None once it is not wanted any more. A fence or rally points that the load has none of are not asked for."""
    for kind in MissionType:
        if not load.of(kind):
            continue
        for _ in range(READINGS):
            reading = await _read(session, load, kind, is_wanted)
            if reading is None or reading.is_aboard:
                break
        if reading is None or not reading.is_aboard:
            return reading
    return Reading(True)


async def ask_for_the_present(session: Session, is_wanted: Callable[[], bool]) -> None:
    """Its state then has its home, and of an ArduPilot in the air how it would go on; what it does not tell is as old as it was."""
    ends, rules = Ends(session.uav.system), settings.TRANSFER_RULES
    asked: list[Keeper] = [HomeReading(session.state, ends, rules)]
    if session.flavour is Flavour.ARDUPILOT and session.state.is_in_air:
        session.state.parameters.pop(RESTARTS, None)
        asked.append(ParameterReading((RESTARTS,), session.state, ends, rules))
    for keeper in asked:
        await Conversation(session, keeper, is_wanted).run(on_change=lambda: None)


async def _read(session: Session, load: FlightLoad, kind: MissionType, is_wanted: Callable[[], bool]) -> Reading | None:
    download = Download(kind, Ends(session.uav.system), settings.TRANSFER_RULES)
    outcome = await Conversation(session, download, is_wanted).run(on_change=lambda: None)
    if outcome is None:
        return None
    name = kind.name.lower()
    if outcome.state is not TransferState.DONE:
        return Reading(False, outcome.code, f"Nothing was sent: the {name} on the vehicle could not be read.")
    flavour = session.flavour or Flavour.OTHER
    found = differences(load.of(kind), held_list(download.read, kind, flavour), flavour)
    if not found:
        return Reading(True)
    more = f" and {len(found) - 1} more" if len(found) > 1 else ""
    return Reading(False, "other-list", f"Nothing was sent: the {name} on the vehicle is not the approved one ({found[0]}{more}).")
