"""Which messages a vehicle is asked for: by intervals, by streams only where intervals bring nothing, and within a budget."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.vehicle_state import VehicleState
from telemetry.gateway.heartbeat import FRAME_BYTES, INTERVALS_S, MAX_STRETCH_FACTOR, intervals_s
from telemetry.gateway.message_requests import ASK_AGAIN_S, LISTENS_S, STATION_GONE_S, MessageRequests

POSITION, BATTERY = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, mavlink.MAVLINK_MSG_ID_BATTERY_STATUS
GIMBAL = mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS
WANTED = set(intervals_s(AutopilotType.ARDUPILOT, 0.0))


def copter() -> VehicleState:
    state = VehicleState(7, autopilot_type=AutopilotType.ARDUPILOT, firmware=(4, 6, 0))
    state.home = state.position
    return state


def asked(messages: list) -> tuple[set[int], list[int]]:
    """Messages by intervals, and whether streams are started (1) or stopped (0)."""
    intervals = {int(m.param1) for m in messages if m.get_type() == "COMMAND_LONG" and m.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL}
    return intervals, [m.start_stop for m in messages if m.get_type() == "REQUEST_DATA_STREAM"]


def feed(message_requests: MessageRequests, now_s: float, *numbers: int) -> None:
    for number in numbers:
        message_requests.receive(mavlink.mavlink_map[number](*[0] * len(mavlink.mavlink_map[number].fieldnames)), now_s)


def refusal() -> object:
    return mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAV_RESULT_UNSUPPORTED)


def test_an_ardupilot_is_asked_for_intervals_and_its_streams_are_stopped_once_nobody_else_is_heard() -> None:
    message_requests = MessageRequests()
    assert asked(message_requests.due(copter(), 100.0, has_position=False)) == (WANTED, [])
    for second in range(1, 300):
        feed(message_requests, 100.0 + second, *WANTED)
        messages = message_requests.due(copter(), 100.0 + second, has_position=True)
        assert asked(messages) == ((WANTED, [0]) if second == LISTENS_S else (set(), []))
        if second == LISTENS_S:
            kinds = [message.get_type() for message in messages]
            assert kinds.index("REQUEST_DATA_STREAM") < kinds.index("COMMAND_LONG"), "stopping ends intervals"


def test_streams_of_a_second_ground_station_are_stopped_once_it_is_gone_and_not_before() -> None:
    message_requests, stopped_s = MessageRequests(), []
    for second in range(400):
        feed(message_requests, float(second), *WANTED)
        if 3 <= second < 200 and second % 4 == 0:
            message_requests.note_station(float(second))
        _intervals, streams = asked(message_requests.due(copter(), float(second), has_position=second > 0))
        stopped_s += [second] if streams else []
    assert stopped_s == [196 + STATION_GONE_S]


def test_a_message_that_does_not_come_is_asked_for_again_by_itself_ever_more_rarely() -> None:
    message_requests, times = MessageRequests(), []
    message_requests.due(copter(), 0.0, has_position=False)
    for second in range(1, 200):
        feed(message_requests, float(second), *(WANTED - {BATTERY}))
        intervals, streams = asked(message_requests.due(copter(), float(second), has_position=True))
        if streams:  # all are asked for again as the streams are stopped
            continue
        assert intervals <= {BATTERY}
        times += [second] if intervals else []
    assert times and len(times) <= 6 and times[-1] - times[-2] > times[1] - times[0]


def test_the_attitude_of_a_gimbal_is_asked_for_again_only_where_there_is_one() -> None:
    for has_gimbal in (False, True):
        message_requests, found = MessageRequests(), set()
        assert GIMBAL in asked(message_requests.due(copter(), 0.0, has_position=False))[0]
        for second in range(1, 100):
            feed(message_requests, float(second), *(WANTED - {GIMBAL}), *([GIMBAL] if has_gimbal and second < 20 else []))
            intervals, streams = asked(message_requests.due(copter(), float(second), has_position=True))
            found |= set() if streams else intervals
        assert found == ({GIMBAL} if has_gimbal else set())


def test_streams_are_started_where_intervals_are_refused() -> None:
    message_requests = MessageRequests()
    message_requests.due(copter(), 0.0, has_position=False)
    message_requests.receive(refusal(), 0.5)
    assert asked(message_requests.due(copter(), ASK_AGAIN_S, has_position=False))[1] == [1]
    assert asked(message_requests.due(copter(), 100.0, has_position=True))[1] == [], "they are not stopped: there is nothing else"


def test_streams_are_started_where_intervals_bring_no_position() -> None:
    message_requests = MessageRequests()
    found = [asked(message_requests.due(copter(), ASK_AGAIN_S * round_, has_position=False))[1] for round_ in range(4)]
    assert found == [[], [], [1], [1]]


def test_a_px4_is_never_asked_for_streams() -> None:
    message_requests, state = MessageRequests(), VehicleState(7, autopilot_type=AutopilotType.PX4)
    for second in range(0, 60, 5):
        assert asked(message_requests.due(state, float(second), has_position=False))[1] == []


def bytes_s(budget_bytes_s: float) -> float:
    wanted = intervals_s(AutopilotType.ARDUPILOT, budget_bytes_s)
    return sum((mavlink.mavlink_map[number].unpacker.size + FRAME_BYTES) / every_s for number, every_s in wanted.items())


def test_a_budget_is_kept_as_long_as_positions_come_once_a_second() -> None:
    assert intervals_s(AutopilotType.ARDUPILOT, 0.0)[POSITION] == INTERVALS_S[POSITION] == 0.2
    assert 600.0 < bytes_s(0.0) < 1_500.0
    assert bytes_s(400.0) <= 400.5
    assert intervals_s(AutopilotType.ARDUPILOT, 1.0)[POSITION] == 0.2 * MAX_STRETCH_FACTOR == 1.0
