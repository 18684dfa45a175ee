"""The demo missions: planned with complete types, passing their own rehearsal, marked, asked for once, and removed with their UAVs."""

import pytest
from django.core.management import call_command
from django.test import Client
from django.utils import timezone

from missions.models import Base, Mission, MissionUav, Uav, UavType
from missions.services.mission_copies import duplicate_mission
from simulation.services import demo_missions
from simulation.services.demo_missions import (
    DEMO_MISSIONS,
    MAKE_DEMO_MISSIONS,
    make_demo_missions,
    missions_made,
    remove_demo_data,
    want_demo_missions,
)
from tests.accounts.users import a_user, client_of
from tests.simulation.rehearsals.random_rehearsals import rehearse_mission
from tests.simulation.rehearsals.test_random_rehearsals import faults_of
from workspace.models import Job, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def administrator(demo_region: None, db: None) -> User:
    call_command("load_demo")
    return a_user(role=Role.ADMINISTRATOR)


@pytest.fixture
def planned_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Flights need a gateway and a simulator: they are left out here, and made in the browser tests' installation."""
    monkeypatch.setattr(demo_missions, "fly_demo_mission", lambda **arguments: "")


def make(person: User) -> list[Mission]:
    since = timezone.now()
    reported: list[str] = []
    while make_demo_missions(
        organisation=person.organisation, actor=person, since=since, progress=lambda words, share: reported.append(words)
    ):
        assert len(reported) <= len(DEMO_MISSIONS), "each step plans one"
    keys = missions_made(organisation=person.organisation, since=since)
    made = {mission.name: mission for mission in Mission.objects.filter(pk__in=keys)}
    return [made[demo.name] for demo in DEMO_MISSIONS if demo.name in made]


@pytest.mark.usefixtures("planned_only")
def test_each_is_planned_with_energy(administrator: User) -> None:
    missions = make(administrator)
    assert [mission.name for mission in missions] == [demo.name for demo in DEMO_MISSIONS]
    for mission in missions:
        assert mission.is_demo and mission.total_energy_wh
        assert not mission.plan_warnings
        assert not mission.targets.exclude(unassigned_reason="").exists()
    assert any(route.mission_uav.uav.name == "Osprey 2" for route in missions[1].routes.all())


@pytest.mark.long
@pytest.mark.usefixtures("planned_only")
def test_each_passes_its_own_rehearsal(administrator: User) -> None:
    for mission in make(administrator):
        calm = not mission.conditions.get("wind")
        found = rehearse_mission(mission, seed=3, scenario="calm" if calm else "as-planned")
        assert found is not None
        assert faults_of(found) == []


@pytest.mark.long
@pytest.mark.usefixtures("planned_only")
def test_made_again_they_are_as_they_were(administrator: User) -> None:
    assert len(make(administrator)) == len(DEMO_MISSIONS)
    assert make(administrator) == []


@pytest.mark.long
@pytest.mark.usefixtures("planned_only")
def test_removed_they_take_uavs_types_and_bases_along_but_not_what_other_missions_have(administrator: User) -> None:
    missions = make(administrator)
    own = duplicate_mission(mission=missions[2], author=administrator, name="Own")
    gone = remove_demo_data(organisation=administrator.organisation, actor=administrator)
    assert gone == {"missions": 3, "uavs": 3}
    assert list(Mission.objects.values_list("name", flat=True)) == ["Own"]
    assert list(Uav.objects.values_list("name", flat=True)) == ["Kestrel 1"]
    assert list(UavType.objects.values_list("name", flat=True)) == ["Kestrel"]
    assert list(Base.objects.values_list("name", flat=True)) == ["Elmsgard depot"]
    assert MissionUav.objects.filter(mission=own).exists()


def test_two_who_ask_get_one_job(administrator: User) -> None:
    first, second = (want_demo_missions(organisation=administrator.organisation, actor=administrator) for _ in range(2))
    assert first == second
    assert Job.objects.filter(task=MAKE_DEMO_MISSIONS).count() == 1


@pytest.mark.long
def test_only_administrators_make_and_remove_them(administrator: User, client: Client) -> None:
    operator = client_of(a_user(Role.OPERATOR))
    assert operator.get("/api/v1/demo-data").json()["can_be_made"] is True
    assert operator.post("/api/v1/demo-data", "{}", content_type="application/json", HTTP_IDEMPOTENCY_KEY="1").status_code == 403
    assert operator.delete("/api/v1/demo-data").status_code == 403
    assert client.get("/api/v1/demo-data").status_code == 401


@pytest.mark.long
@pytest.mark.usefixtures("planned_only")
def test_once_removed_they_can_be_made_again_with_their_uavs(administrator: User) -> None:
    make(administrator)
    remove_demo_data(organisation=administrator.organisation, actor=administrator)
    assert not Uav.objects.exists()
    assert client_of(administrator).get("/api/v1/demo-data").json()["can_be_made"] is True
    assert len(make(administrator)) == len(DEMO_MISSIONS)
    assert Uav.objects.filter(is_demo=True).count() == 4
