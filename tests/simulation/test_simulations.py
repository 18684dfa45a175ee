"""Simulated UAVs in real time: who may be stood in for, quotas, leases, lifetimes, and what a lost simulator leaves."""

import socket
from dataclasses import replace

import pytest

from missions.models import CredentialKind, LinkKind, Mission, MissionState, Uav
from missions.services.commands.refused import Refused
from simulation.models import SimulationChange, SimulationState
from simulation.selectors import simulations_of_mission
from simulation.serializers.simulations import simulation_json
from simulation.services.simulations import IsOver, NoPortFree, QuotaReached, change_simulation, end_simulation, end_vehicle
from simulation.services.simulator_leases import end_single_ones, end_those_over, release_simulations, renew_simulations, take_changes
from simulation.simulator.options import SimulatorOptions, options_of_settings
from simulation.simulator.process import Simulator
from tests.accounts.users import a_user
from tests.missions.flights import approved, dispatched, fleet, planned
from tests.missions.worlds import world
from tests.simulation.simulations import LONG_AGO, fresh, lose, pool, stand_ins, taken
from tests.telemetry.gateway.station import wait_for
from workspace.models import AuditEntry, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return a_user()


@pytest.fixture
def mission(person: User) -> Mission:
    return approved(person, fleet("Tern"), world().towers[:1])[0]


def reasons(refused: pytest.ExceptionInfo[Refused]) -> list[tuple[str, int | None]]:
    return [(reason.code, reason.uav) for reason in refused.value.reasons]


# Who is stood in for


def test_a_stand_in_has_its_uavs_name_id_and_key_and_stands_where_the_route_begins(person, mission):
    (vehicle,) = stand_ins(mission, person, speed=5.0).vehicles.all()
    tern = Uav.objects.get()
    assert (vehicle.name, vehicle.uav, vehicle.system_id, vehicle.port) == ("Tern", tern, tern.mavlink_system_id, None)
    assert tern.credentials.filter(kind=CredentialKind.MAVLINK_KEY, revoked_at=None).count() == 1
    assert vehicle.position.coords == pytest.approx(mission.mission_uavs.get().start.coords)


def test_a_key_and_an_id_that_are_there_stay(person, mission):
    Uav.objects.update(mavlink_system_id=42, allows_unsigned=True)
    (vehicle,) = stand_ins(mission, person).vehicles.all()
    assert vehicle.system_id == 42
    assert not Uav.objects.get().credentials.exists()


def test_a_real_uav_is_never_stood_in_for(person):
    mission = dispatched(person, fleet("Tern", "Kite"), world().towers[:2])
    Uav.objects.filter(name="Kite").update(is_simulated=False)
    with pytest.raises(Refused) as refused:
        stand_ins(mission, person)
    assert reasons(refused) == [("real_uav", 1)]
    assert not Uav.objects.exclude(mavlink_system_id=None).exists(), "nothing of it is done"


def test_one_that_is_no_longer_simulated_is_given_up_in_flight(person, mission):
    simulation = stand_ins(mission, person)
    assert taken()
    Uav.objects.update(is_simulated=False)
    assert end_those_over(holder="one/a", ids=[simulation.pk]) == {simulation.pk}
    assert fresh(simulation).reason == "uav-changed"


def test_one_behind_a_companion_is_not_stood_in_for(person, mission):
    Uav.objects.update(link=LinkKind.HTTP)
    with pytest.raises(Refused) as refused:
        stand_ins(mission, person)
    assert reasons(refused) == [("not_by_mavlink", 0)]


def test_only_what_is_approved_is_flown(person):
    with pytest.raises(Refused) as refused:
        stand_ins(planned(person, fleet("Tern"), world().towers[:1]), person)
    assert reasons(refused) == [("not_approved", None)]


def test_a_uav_is_stood_in_for_by_one_at_a_time(person, mission):
    first = stand_ins(mission, person)
    with pytest.raises(Refused) as refused:
        stand_ins(mission, person)
    assert reasons(refused) == [("already_simulated", 0)]
    end_simulation(simulation=first, actor=person)
    assert stand_ins(mission, person)


# Quotas and ports


def test_an_organisation_has_so_many_at_once(settings, person):
    settings.MAX_SIMULATED_UAVS = 3
    first = pool(person, 2)
    with pytest.raises(QuotaReached) as reached:
        pool(person, 2)
    assert reached.value.free == 1
    pool(person, 1)
    end_simulation(simulation=first, actor=person)
    assert pool(person, 2)


def test_what_has_outlived_its_time_counts_no_more(settings, person):
    settings.MAX_SIMULATED_UAVS = 2
    first = pool(person, 2)
    type(first).objects.update(lifetime_ends_at=LONG_AGO)
    assert pool(person, 2)


def test_each_has_a_port_of_its_own_that_is_free_again_afterwards(settings, person):
    settings.SIMULATOR_PORTS = "15000-15002"
    first, second = pool(person, 2), pool(person, 1)
    assert list(first.vehicles.values_list("port", "system_id")) == [(15000, 1), (15001, 2)]
    assert list(second.vehicles.values_list("port", flat=True)) == [15002]
    with pytest.raises(NoPortFree):
        pool(person, 1)
    end_simulation(simulation=first, actor=person)
    assert pool(person, 2)


def test_no_simulation_lasts_longer_than_the_setting_says(settings, person):
    settings.MAX_SIMULATION_H = 0.5
    simulation = pool(person, lifetime_s=86_400.0)
    assert (simulation.lifetime_ends_at - fresh(simulation).created_at).total_seconds() == pytest.approx(1_800, abs=5)


def test_a_port_that_another_program_has_is_told_by_its_name(settings, person):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        port = other.getsockname()[1]
        settings.SIMULATOR_PORTS = f"{port}-{port}"
        simulation = pool(person, 1)
        simulator = Simulator(SimulatorOptions(name="one", most_load=10.0, gateway=("127.0.0.1", 1), host="127.0.0.1"))
        simulator.round()
    reported = simulation_json(fresh(simulation))
    assert (reported["state"], reported["reason"]) == ("failed", "port-taken"), reported
    assert "SPANWISE_SIMULATOR_PORTS" in reported["message"]
    assert simulator.flights == {}


def test_without_a_gateway_a_missions_uavs_are_told_to_have_none(settings, mission, person):
    settings.GATEWAY_UDP = settings.SIMULATOR_GATEWAY = ""
    of_mission = stand_ins(mission, person)
    simulator = Simulator(options_of_settings(name="one"))
    simulator.round()
    reported = simulation_json(fresh(of_mission))
    assert (reported["state"], reported["reason"]) == ("failed", "no-gateway"), reported
    assert "SPANWISE_SIMULATOR_GATEWAY" in reported["message"]
    assert simulator.flights == {}


# Leases


def test_one_simulator_holds_a_simulation_and_the_longest_waiting_goes_first(person):
    first, second = pool(person), pool(person)
    assert taken("one/a").simulation == first
    assert taken("two/b").simulation == second
    assert taken("one/a", first) is None
    assert renew_simulations(holder="one/a", ids=[first.pk, second.pk], lease_s=5.0) == {first.pk}


def test_what_is_too_much_waits_for_another_unless_nothing_else_is_flown(person):
    first = pool(person, 1)
    taken()
    second = pool(person, 4, speed=10.0)
    assert taken("one/a", first, most_load=39.0) is None
    assert taken("two/b", most_load=39.0).simulation == second


def test_the_same_simulator_started_again_takes_its_own_at_once(person):
    simulation = pool(person)
    taken("one/a")
    assert taken("two/b") is None
    assert taken("one/c").simulation == simulation


def test_a_lost_simulators_pool_begins_anew_on_the_ground(person):
    simulation = pool(person)
    assert taken("one/a")
    lose(simulation, is_in_air=True)
    held = taken("two/b")
    assert len(held.vehicles) == 2
    assert (fresh(simulation).restarts, fresh(simulation).state) == (1, SimulationState.FLYING)
    assert list(simulation.vehicles.values_list("restarts", "reported")) == [(1, {}), (1, {})]


def test_a_missions_uav_that_was_in_the_air_is_gone_with_its_simulator(person, mission):
    simulation = stand_ins(mission, person)
    assert taken("one/a")
    lose(simulation, is_in_air=True)
    assert taken("two/b") is None
    vehicle = simulation.vehicles.get()
    assert (vehicle.state, vehicle.reason) == (SimulationState.FAILED, "simulator-lost")
    assert (fresh(simulation).state, fresh(simulation).reason) == (SimulationState.FAILED, "simulator-lost")
    assert stand_ins(mission, person), "another may be started for it"


def test_a_missions_uav_that_stood_on_the_ground_stands_there_anew(person, mission):
    simulation = stand_ins(mission, person)
    assert taken("one/a")
    lose(simulation, is_in_air=False)
    assert [vehicle.name for vehicle in taken("two/b").vehicles] == ["Tern"]


def test_a_missions_uav_that_had_crashed_does_not_rise_again(person, mission):
    simulation = stand_ins(mission, person)
    assert taken("one/a")
    lose(simulation, is_in_air=False, is_crashed=True)
    assert taken("two/b") is None


def test_what_a_simulator_had_to_give_up_it_takes_again(person):
    """Its database was away for longer than its leases."""
    simulation = pool(person)
    taken("one/a")
    lose(simulation)
    assert taken("one/a").simulation == simulation
    assert fresh(simulation).restarts == 1


def test_nothing_flies_beyond_its_lease_while_the_database_neither_answers_nor_refuses(person):
    simulation = pool(person, 1)
    simulator = Simulator(SimulatorOptions(name="one", most_load=10.0, gateway=("127.0.0.1", 1), host="127.0.0.1", lease_s=1.0))
    simulator.round()
    flight = simulator.flights[simulation.pk]
    wait_for(lambda: flight.is_given_up, "the end of the lease, which nobody renews")
    steps = flight.fleet.report().steps
    simulator.options = replace(simulator.options, lease_s=600.0)
    try:
        simulator.round()
        anew = simulator.flights[simulation.pk]
        assert anew is not flight
        wait_for(lambda: anew.fleet.report().steps > 0, "it begins anew once the database is back")
        assert flight.fleet.report().steps == steps, "the one that was given up stands still"
        assert fresh(simulation).restarts == 1
    finally:
        simulator.flights.pop(simulation.pk).end()


def test_what_is_over_and_was_left_by_a_dead_simulator_bars_no_start(person, mission):
    simulation = stand_ins(mission, person)
    taken()
    end_simulation(simulation=simulation, actor=person)
    with pytest.raises(Refused):
        stand_ins(mission, person)
    lose(simulation)
    assert stand_ins(mission, person)
    assert (fresh(simulation).state, fresh(simulation).reason) == (SimulationState.ENDED, "ended-by-hand")


def test_a_simulator_that_is_stopped_leaves_what_a_lost_one_leaves(person, mission):
    simulation = stand_ins(mission, person)
    assert taken("one/a")
    simulation.vehicles.update(reported={"is_in_air": True})
    release_simulations(holder="one/a")
    assert taken("two/b") is None
    assert fresh(simulation).state == SimulationState.FAILED


# Ends and changes


def test_one_of_several_can_be_ended_alone(person):
    simulation = pool(person, 2)
    first, second = simulation.vehicles.all()
    end_vehicle(vehicle=first, actor=person)
    assert list(simulation.vehicles.values_list("state", "reason")) == [("ended", "ended-by-hand"), ("wanted", "")]
    assert fresh(simulation).state == SimulationState.WANTED
    assert [vehicle.name for vehicle in taken().vehicles] == [second.name]
    assert AuditEntry.objects.get(action="end", actor=person).after["vehicle"] == first.name


def test_one_that_is_flown_is_ended_by_its_simulator(person):
    simulation = pool(person, 2)
    taken("one/a")
    end_vehicle(vehicle=simulation.vehicles.first(), actor=person)
    assert set(simulation.vehicles.values_list("state", flat=True)) == {SimulationState.FLYING}
    assert end_single_ones(holder="two/b", ids=[simulation.pk]) == []
    assert [vehicle.sequence for vehicle in end_single_ones(holder="one/a", ids=[simulation.pk])] == [0]
    assert list(simulation.vehicles.values_list("state", flat=True)) == [SimulationState.ENDED, SimulationState.FLYING]
    assert end_single_ones(holder="one/a", ids=[simulation.pk]) == []


def test_with_the_last_one_the_simulation_ends(person):
    simulation = pool(person, 2)
    for vehicle in simulation.vehicles.all():
        end_vehicle(vehicle=vehicle, actor=person)
        end_vehicle(vehicle=vehicle, actor=person)  # once more changes nothing
    assert (fresh(simulation).state, fresh(simulation).reason) == (SimulationState.ENDED, "ended-by-hand")
    assert AuditEntry.objects.filter(action="end").count() == 2


def test_its_lifetime_ends_it_whether_it_is_held_or_waits(person):
    held, waiting = pool(person), pool(person)
    assert taken().simulation == held
    type(held).objects.update(lifetime_ends_at=LONG_AGO)
    assert end_those_over(holder="one/a", ids=[held.pk]) == {held.pk}
    assert taken("two/b") is None
    assert {fresh(held).reason, fresh(waiting).reason} == {"lifetime-over"}
    assert not AuditEntry.objects.filter(action="end", actor=person).exists()


def test_it_ends_a_while_after_its_mission(person, mission):
    simulation = stand_ins(mission, person)
    assert taken()
    Mission.objects.update(state=MissionState.COMPLETED, ended_at=simulation.lifetime_ends_at)
    assert not end_those_over(holder="one/a", ids=[simulation.pk])
    Mission.objects.update(ended_at=LONG_AGO)
    continuation = Mission.objects.create(organisation=mission.organisation, author=person, name="Continued", continues=mission)
    assert not end_those_over(holder="one/a", ids=[simulation.pk]), "what continues it is flown yet"
    assert list(simulations_of_mission(mission.organisation, continuation.pk)) == [simulation]
    Mission.objects.filter(pk=continuation.pk).update(deleted_at=LONG_AGO)
    assert end_those_over(holder="one/a", ids=[simulation.pk])


def test_one_that_nobody_holds_ends_at_once_and_a_held_one_by_its_holder(person):
    waiting, held = pool(person), pool(person)
    taken("two/b", waiting)
    for simulation in (waiting, held):
        end_simulation(simulation=simulation, actor=person)
    assert fresh(waiting).state == SimulationState.ENDED
    assert fresh(held).state == SimulationState.FLYING
    assert end_those_over(holder="two/b", ids=[held.pk]) == {held.pk}


def test_changes_are_given_out_once_in_their_order(person):
    simulation = pool(person, faults={"gps_lost_for_s": 5.0})
    taken()
    change_simulation(simulation=simulation, actor=person, speed=5.0)
    change_simulation(simulation=simulation, actor=person, vehicle=simulation.vehicles.first(), faults={"motor_failed": 2})
    assert [(c.faults, c.speed) for c in take_changes(ids=[simulation.pk])] == [
        ({"gps_lost_for_s": 5.0}, None), (None, 5.0), ({"motor_failed": 2}, None),
    ]  # fmt: skip
    assert take_changes(ids=[simulation.pk]) == []
    assert fresh(simulation).speed == 5.0


def test_a_fault_goes_with_the_uav_that_had_it(person):
    simulation = pool(person, faults={"motor_failed": 1})
    taken("one/a")
    lose(simulation)
    taken("two/b")
    assert take_changes(ids=[simulation.pk]) == []


def test_what_is_over_is_not_changed(person):
    simulation = pool(person)
    end_simulation(simulation=simulation, actor=person)
    with pytest.raises(IsOver):
        change_simulation(simulation=simulation, actor=person, speed=2.0)
    assert not SimulationChange.objects.exists()


def test_the_history_names_who_did_what(person, mission):
    simulation = stand_ins(mission, person)
    change_simulation(simulation=simulation, actor=person, speed=2.0)
    end_simulation(simulation=simulation, actor=person)
    entries = AuditEntry.objects.filter(subject_type="simulation", actor=person)
    assert sorted(entries.values_list("action", flat=True)) == ["change", "end", "start"]
