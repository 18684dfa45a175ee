"""What is known of approved flights is worked out once while they last, and does not pile up over a season."""

from uuid import UUID, uuid4

from telemetry.services.approved_flights import FORGOTTEN_AFTER_S, OfFlight


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def made(clock: Clock) -> tuple[OfFlight[str], list[int]]:
    worked_out: list[int] = []

    def work_out(approval_id: UUID, uav_id: int, flight: int) -> str:
        worked_out.append(uav_id)
        return f"{approval_id} {uav_id} {flight}"

    return OfFlight(work_out, now_s=clock), worked_out


def test_a_flight_that_lasts_is_worked_out_once() -> None:
    clock, approval = Clock(), uuid4()
    flights, worked_out = made(clock)
    for _ in range(3):
        assert flights(approval, 7, 1) == f"{approval} 7 1"
        clock.now_s += FORGOTTEN_AFTER_S
    assert worked_out == [7]


def test_flights_that_are_over_are_forgotten_when_others_begin() -> None:
    clock = Clock()
    flights, _ = made(clock)
    lasting = uuid4()
    for number in range(1_000):
        flights(lasting, 0, 1)
        flights(uuid4(), number, 1)
        clock.now_s += FORGOTTEN_AFTER_S / 10
    assert len(flights) <= 13


def test_another_flight_of_the_same_uav_is_another_one() -> None:
    clock, approval = Clock(), uuid4()
    flights, worked_out = made(clock)
    assert flights(approval, 7, 1) != flights(approval, 7, 2)
    assert worked_out == [7, 7]
