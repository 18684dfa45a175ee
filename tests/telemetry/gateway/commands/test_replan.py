"""Two UAVs fly, one drops out: what it leaves is offered, accepted, and flown by the other: held, loaded and started in the air."""

import pytest
from django.utils import timezone
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.wire import onboard_list
from mavlink.vehicle_plan import MissionType
from missions.models import CommandKind, CommandState, Mission, MissionState, OfferState, TargetState, Uav, UavCommand
from missions.selectors.missions import mission_of_organisation
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import dispatch_mission, load_of
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended
from missions.services.commands.steering import command_uav
from missions.services.replanning import accept_offer
from telemetry.models import Alert, UavLink
from telemetry.services.alerts.command_alerts import settle_command_alerts
from tests.accounts.users import a_user
from tests.cases import long
from tests.missions.flights import ground
from tests.missions.replanning.in_flight import Flight, planned_over_a_line
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.gateway.station import gateway_at_work, port_of, unsigned_uav, wait_for
from tests.telemetry.vehicles.ardupilot import ArduPilot
from tests.telemetry.vehicles.px4 import Px4

pytestmark = pytest.mark.django_db(transaction=True)
AUTOPILOT_TYPES = {AutopilotType.PX4: Px4, AutopilotType.ARDUPILOT: ArduPilot}
HOME_M = 100.0


class InAir(Flyer):
    """Its home stays where it took off; `relative_m` is its height above that."""

    home: tuple[float, float] = (0.0, 0.0)
    relative_m: float = 0.0

    def _reports(self, now_s):
        reported, home = super()._reports(now_s)
        reported.relative_alt = round(self.relative_m * 1000)
        home.latitude, home.longitude, home.altitude = round(self.home[1] * 1e7), round(self.home[0] * 1e7), round(HOME_M * 1000)
        return [reported, home]


@pytest.fixture
def mission(own_folders, tmp_path) -> Mission:
    ground(tmp_path / "hill.tif", HOME_M)
    uavs = [unsigned_uav(7, is_simulated=True), unsigned_uav(8, is_simulated=True)]
    mission = planned_over_a_line(a_user(), uavs)
    approve_mission(mission=mission, actor=mission.author)
    return mission


def ended(command: UavCommand) -> UavCommand:
    def found() -> bool:
        command.refresh_from_db()
        return command.state in (CommandState.APPLIED, CommandState.FAILED, CommandState.EXPIRED)

    wait_for(found, f"the end of {command.kind}")
    return command


def stand(vehicle, gateway, mission: Mission, place: int) -> InAir:
    start = mission.routes.get(mission_uav__sequence=place).mission_uav.start.coords
    flyer = InAir(vehicle, port_of(gateway), at=start, altitude_amsl_m=HOME_M)
    flyer.home = start
    return flyer


def fly(flying: InAir, flight: Flight, place: int, waypoint: int, share: float) -> None:
    """To a share of the leg to a waypoint, and until the rows tell so."""
    rows = list(flight.route(place).waypoints.order_by("sequence"))
    before, ahead = rows[waypoint - 1], rows[waypoint]
    lon, lat = (one + share * (to - one) for one, to in zip(before.position.coords[:2], ahead.position.coords[:2], strict=True))
    flying.at, flying.altitude_amsl_m, flying.relative_m = (lon, lat), ahead.altitude_amsl_m, ahead.altitude_relative_m
    uav = flight.uavs[place]
    wait_for(lambda: abs(Uav.objects.get(pk=uav.pk).location.x - lon) < 1e-5, "its position", patience_s=10)


def in_the_air(mission: Mission, flying: list[InAir]) -> Flight:
    """Both are loaded, started and on their way."""
    for upload in dispatch_mission(mission=mission, actor=mission.author):
        assert ended(upload).state == CommandState.APPLIED, upload.outcome
    uavs = [row.uav for row in mission.mission_uavs.select_related("uav")]
    for uav in uavs:
        start = command_uav(uav=uav, kind=CommandKind.START, actor=mission.author)
        assert ended(start).state == CommandState.APPLIED, start.outcome
    flight = Flight(mission_of_organisation(mission.organisation, mission.pk), uavs, mission.author)
    for place, one in enumerate(flying):
        fly(one, flight, place, 1, 0.2)
    return flight


@pytest.mark.parametrize("autopilot_type", [AutopilotType.ARDUPILOT, *long(AutopilotType.PX4)])
def test_what_one_uav_leaves_is_flown_by_the_other(autopilot_type, mission, tmp_path):
    vehicles = [AUTOPILOT_TYPES[autopilot_type](system=7), AUTOPILOT_TYPES[autopilot_type](system=8)]
    with (
        gateway_at_work(tmp_path) as gateway,
        stand(vehicles[0], gateway, mission, 0) as tern,
        stand(vehicles[1], gateway, mission, 1) as kite,
    ):
        flight = in_the_air(mission, [tern, kite])
        lost = flight.targets(0)
        mark_flight_ended(mission_id=mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
        offer = flight.offer()
        assert offer.state == OfferState.OPEN, offer.outcome
        fly(kite, flight, 1, 1, 0.6)  # while a person decides
        accept_offer(offer=offer, actor=mission.author)
        own = flight.uavs[1]
        last = wait_for(
            lambda: UavCommand.objects.filter(uav=own, kind=CommandKind.START, mission=offer.continuation).first(), "the last step"
        )
        assert ended(last).state == CommandState.APPLIED, last.outcome
        steps = UavCommand.objects.filter(uav=own, mission=offer.continuation).order_by("sequence")
        assert [(step.kind, step.state) for step in steps] == [(kind, "applied") for kind in ("hold", "upload-mission", "start")]
        upload = steps[1]
        load = load_of(upload).load
        for kind in MissionType:
            assert not differences(load.of(kind), onboard_list(vehicles[1].held(kind), kind, autopilot_type), autopilot_type)
        assert load.mission[0].command != mavlink.MAV_CMD_NAV_TAKEOFF
        assert UavLink.objects.get(uav=own).loaded_approval == upload.approval_id
        begun = vehicles[1].current_item - (autopilot_type is AutopilotType.ARDUPILOT)
        assert load.mission[begun].waypoint == 1, "the end of the leg on which it was held"
        continuation = Mission.objects.get(pk=offer.continuation_id)
        assert continuation.state == MissionState.ACTIVE

        offset = 1 if autopilot_type is AutopilotType.ARDUPILOT else 0
        session = gateway.sessions[8]
        wait_for(lambda: session.state.is_in_air, "that it is seen in the air")
        kite.report(mavlink.MAVLink_mission_current_message(len(load.mission) - 1 + offset))
        vehicles[1].current_item = len(load.mission) - 1 + offset
        wait_for(lambda: session.state.mission_item == len(load.mission) - 1 + offset, "the landing")
        vehicles[1].is_in_air = vehicles[1].is_armed = False
        wait_for(lambda: Mission.objects.get(pk=continuation.pk).state == MissionState.COMPLETED, "the end of its flight")
    assert set(continuation.targets.values_list("state", flat=True)) == {TargetState.COMPLETE}
    labels = set(mission.targets.filter(sequence__in=lost).values_list("label", flat=True))
    assert labels <= set(continuation.targets.values_list("label", flat=True))
    assert set(mission.targets.filter(sequence__in=lost).values_list("state", flat=True)) == {TargetState.SKIPPED}


@pytest.mark.long
def test_a_uav_that_cannot_be_given_its_route_stays_held_and_it_is_said(mission, tmp_path):
    vehicles = [ArduPilot(system=7), ArduPilot(system=8)]
    with (
        gateway_at_work(tmp_path) as gateway,
        stand(vehicles[0], gateway, mission, 0) as tern,
        stand(vehicles[1], gateway, mission, 1) as kite,
    ):
        flight = in_the_air(mission, [tern, kite])
        mark_flight_ended(mission_id=mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
        offer = flight.offer()
        vehicles[1].refuses = {3: mavlink.MAV_MISSION_NO_SPACE}
        accept_offer(offer=offer, actor=mission.author)
        own = flight.uavs[1]
        upload = wait_for(lambda: UavCommand.objects.filter(uav=own, mission=offer.continuation, kind="upload-mission").first())
        assert ended(upload).state == CommandState.FAILED
        settle_command_alerts()
        alert = Alert.objects.get(uav=own, code="hand-over-failed", closed_at=None)
        assert "return" in alert.message and alert.values["uav"] == own.name
        assert vehicles[1].custom_mode == 17, "in BRAKE"
        assert not UavCommand.objects.filter(uav=own, mission=offer.continuation, kind=CommandKind.START).exists()
        home = command_uav(uav=own, kind=CommandKind.RETURN, actor=mission.author)
        assert ended(home).state == CommandState.APPLIED
        settle_command_alerts()
        alert.refresh_from_db()
        assert alert.closed_at is not None and alert.closed_at <= timezone.now()
