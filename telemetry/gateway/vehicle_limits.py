"""What a vehicle would not fly by its own parameters: asked for, and told before anything of a mission is sent."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from django.conf import settings

from mavlink.addressing import Ends
from mavlink.autopilot_type import Flavour
from mavlink.mission_sync.limits import FIRST_LEG, PARAMETERS, LimitWarning, count_warnings, leg_warnings
from mavlink.parameters import ParameterReading
from mavlink.rtl import fence_off_by
from mavlink.vehicle_plan import FlightLoad
from telemetry.gateway.conversation import Conversation
from telemetry.gateway.preparation import CannotCarry
from telemetry.gateway.session import Session

RETRIES = 2  # a parameter that a vehicle does not have draws no answer
ADVICE = {
    "far-first-waypoint": f"Bring the UAV to where its flight begins, or raise {FIRST_LEG} on it.",
    "long-leg": "Revoke, and approve it again with points put in on longer legs.",
}
FENCE_PARAMETERS = ("FENCE_ENABLE", "FENCE_AUTOENABLE", "FENCE_TYPE")
FENCE_OFF = "The fence on the UAV does nothing: {parameter}."
UNTOLD = "The UAV has not told how far apart waypoints may be."


async def reason_not_to_load(load: FlightLoad, session: Session, *, is_wanted: Callable[[], bool]) -> CannotCarry | None:
    """Legs that the vehicle would refuse. It is asked if it has not told, and again before it is refused: it may have been set anew."""
    if session.flavour is Flavour.ARDUPILOT and load.fence and FENCE_PARAMETERS[0] not in session.state.parameters:
        await _read(FENCE_PARAMETERS, session, is_wanted)  # for warnings_of
    if session.flavour is not Flavour.PX4:
        return None
    if not session.limits or session.questions.may_ask_limits(session.state) or leg_warnings(load, session.limits, session.state.position):
        session.questions.limits_left = 0
        await _read(PARAMETERS, session, is_wanted)
    refused = leg_warnings(load, session.limits, session.state.position)
    return _refusal(refused) if refused else None


async def _read(names: Sequence[str], session: Session, is_wanted: Callable[[], bool]) -> None:
    reading = ParameterReading(names, session.state, Ends(session.uav.system), replace(settings.TRANSFER_RULES, retries=RETRIES))
    await Conversation(session, reading, is_wanted).run(on_change=lambda: None)


def warnings_of(load: FlightLoad, session: Session) -> str:
    """What may go wrong although it is sent; empty where nothing is known."""
    if session.flavour is None:
        return ""
    words = [warning.words for warning in count_warnings(load, session.flavour)]
    if session.flavour is Flavour.PX4 and not session.limits:
        words.append(UNTOLD)
    off_by = fence_off_by(session.flavour, session.state.parameters) if load.fence else ""
    if off_by:
        words.append(FENCE_OFF.format(parameter=off_by))
    return " ".join(words)


def _refusal(refused: tuple[LimitWarning, ...]) -> CannotCarry:
    first, others = refused[0], [warning for warning in refused[1:] if warning.code == "long-leg"]
    more = [f"So are {len(others)} more legs." if len(others) > 1 else "So is one more leg."] if others else []
    advice = [ADVICE[code] for code in dict.fromkeys(warning.code for warning in refused)]
    return CannotCarry(first.code, " ".join(["The UAV would not fly it.", first.words, *more, *advice]))
