"""What belongs to one organisation is not there in the admin of another: every address, action, choice and filter."""

from typing import Any

import pytest
from django.contrib import admin
from django.core.management import CommandError, call_command
from django.db.models import Model
from django.test import Client
from django.urls import reverse
from django.utils import timezone

import config.urls  # noqa: F401 - the models are registered when the addresses are read
from accounts.users import OperatorsAlone, change_users, delete_user
from missions.models import Approval, InspectionTarget, MissionUav, Route, UavType, Waypoint
from planning.trajectory.waypoints import WaypointKind
from telemetry.models import UnknownVehicle
from tests.accounts.test_invitations import FORM
from tests.accounts.users import a_user, client_of
from tests.cases import long
from tests.inspection.test_admin import form_of, point
from tests.missions.worlds import UAV_AT
from tests.workspace.test_foreign_rows import everything, rows_of
from workspace.admin_pages.scope import OrganisationScopedAdmin
from workspace.models import AuditEntry, Organisation, Role, SignInEntry, SignInOutcome, User

pytestmark = pytest.mark.django_db

NOWHERE = 987_654_321
SCOPED = {model: page for model, page in admin.site._registry.items() if page.organisation_path is not None}  # type: ignore[attr-defined]


def rows_in_the_admin(home: Organisation) -> dict[type[Model], Model]:
    """One row of each model that the admin shows and that belongs to an organisation."""
    rows: dict[type[Model], Model] = {type(row): row for row in rows_of(home).values()}
    mission, uav, keeper = (next(row for row in rows.values() if type(row).__name__ == name) for name in ("Mission", "Uav", "User"))
    mission_uav = MissionUav.objects.get(mission=mission)
    route = Route.objects.create(mission=mission, mission_uav=mission_uav, length_m=1.0, duration_s=1.0, graph_version=1)
    more = [
        home,
        mission_uav,
        route,
        Waypoint.objects.create(
            route=route, sequence=0, kind=WaypointKind.START, position=uav.location, altitude_agl_m=1.0, altitude_relative_m=1.0
        ),
        InspectionTarget.objects.create(mission=mission, sequence=0, label="Mast", position=uav.location),
        Approval.objects.create(mission=mission, approved_by=keeper, document={}, content_sha256="0" * 64),
        AuditEntry.objects.create(organisation=home, actor=keeper, action="x", subject_type="x", subject_id="1"),
        SignInEntry.objects.create(user=keeper, outcome=SignInOutcome.SIGNED_IN, address="192.0.2.1"),
        UnknownVehicle.objects.create(mavlink_system_id=home.pk % 200 + 1, last_message_at=timezone.now(), uav=uav, settled_by=keeper),
    ]
    return {model: row for model, row in (rows | {type(row): row for row in more}).items() if model in SCOPED}


@pytest.fixture
def homes() -> list[Organisation]:
    return [Organisation.objects.create(name=name) for name in ("Grid North", "Harbour South")]


def addresses(model: type[Model], key: Any) -> list[str]:
    """Of one row: every address that its page in the admin has."""
    patterns = [pattern for pattern in SCOPED[model].get_urls() if pattern.name and "object_id" in str(pattern.pattern)]
    return [reverse(f"admin:{pattern.name}", args=[key]) for pattern in patterns]


def reported(answer: Any, key: Any) -> tuple[int, str]:
    return answer.status_code, answer.headers.get("Location", "").replace(str(key), "KEY")


def test_every_page_of_the_admin_says_whose_rows_it_shows(homes: list[Organisation]) -> None:
    assert all(isinstance(page, OrganisationScopedAdmin) for page in admin.site._registry.values())
    assert set(rows_in_the_admin(homes[0])) == set(SCOPED)
    common = {model._meta.app_label for model in admin.site._registry if model not in SCOPED}
    assert common == {"inspection"}, "the ground alone is shared"


@pytest.mark.parametrize("own", [0, *long(1)])
def test_administrators_of_two_organisations_find_none_of_each_others_rows_at_any_address(homes: list[Organisation], own: int) -> None:
    rows = [rows_in_the_admin(home) for home in homes]
    mine, foreign = homes[own], homes[1 - own]
    client = client_of(a_user(Role.ADMINISTRATOR, mine))
    before = everything(mine)
    asked = 0
    for model, row in rows[1 - own].items():
        for there, nowhere in zip(addresses(model, row.pk), addresses(model, NOWHERE), strict=True):
            for method in ("get", "post"):
                body = {"post": "yes"} if method == "post" else {}
                answers = [getattr(client, method)(address, body) for address in (there, nowhere)]
                assert reported(answers[0], row.pk) == reported(answers[1], NOWHERE), (method, there)
                assert answers[0].status_code in (302, 403, 404), (method, there)
                asked += 1
    assert asked > 80
    assert everything(mine) == before
    assert foreign.name not in client.get("/admin/").content.decode()


@pytest.mark.parametrize("own", [1, *long(0)])
def test_lists_filters_searches_and_actions_reach_own_rows_alone(homes: list[Organisation], own: int) -> None:
    rows = [rows_in_the_admin(home) for home in homes]
    mine, foreign = homes[own], homes[1 - own]
    client = client_of(a_user(Role.ADMINISTRATOR, mine))
    before = everything(mine)
    for model, row in rows[1 - own].items():
        if model is Organisation:
            assert client.get(reverse("admin:workspace_organisation_changelist")).status_code == 403
            continue
        address = reverse(f"admin:{model._meta.app_label}_{model._meta.model_name}_changelist")
        page = client.get(address)
        keys = set(page.context["cl"].queryset.values_list("pk", flat=True))
        assert row.pk not in keys, model
        assert rows[own][model].pk in keys, model
        assert foreign.name not in page.content.decode(), model
        for action in ["delete_selected", *(SCOPED[model].actions or [])]:
            client.post(address, {"action": action, "_selected_action": [row.pk], "post": "yes"})
        for question in (f"?id__exact={row.pk}", f"?q={foreign.name}", f"?organisation__id__exact={foreign.pk}"):
            found = client.get(address + question)
            assert found.status_code == 302 or row.pk not in found.context["cl"].queryset.values_list("pk", flat=True), (model, question)
    assert everything(mine) == before


def test_choices_of_a_form_are_own_rows_and_a_foreign_one_is_refused(homes: list[Organisation]) -> None:
    types = [UavType.objects.create(organisation=home, name=f"Quad of {home}") for home in homes]
    client = client_of(a_user(Role.ADMINISTRATOR, homes[0]))
    page = client.get(reverse("admin:missions_uav_add"))
    offered = page.content.decode()
    assert types[0].name in offered
    assert types[1].name not in offered
    form = form_of(page) | {"name": "Kite", "location": point(*UAV_AT)}
    assert "organisation" not in form
    refused = client.post(reverse("admin:missions_uav_add"), form | {"uav_type": types[1].pk})
    assert "uav_type" in refused.context["adminform"].form.errors
    taken = client.post(reverse("admin:missions_uav_add"), form | {"uav_type": types[0].pk, "organisation": homes[1].pk})
    assert taken.status_code == 302, taken.context["adminform"].form.errors
    assert homes[0].uavs.get().name == "Kite"
    again = client.post(reverse("admin:missions_uav_add"), form)
    assert again.status_code == 200, "a name that is taken is told, not stored"
    assert again.context["adminform"].form.errors
    filters = client.get(reverse("admin:missions_uav_changelist")).content.decode()
    assert types[1].name not in filters


def test_nobody_is_moved_to_another_organisation_and_no_password_is_set(homes: list[Organisation]) -> None:
    administrator, person = a_user(Role.ADMINISTRATOR, homes[0]), a_user(Role.VIEWER, homes[0])
    client = client_of(administrator)
    address = reverse("admin:workspace_user_change", args=[person.pk])
    form = form_of(client.get(address))
    assert not {"organisation", "password", "is_installation_operator"} & set(form)
    more = {"organisation": homes[1].pk, "password": "x", "is_installation_operator": "on"}
    assert client.post(address, form | more).status_code == 302
    person.refresh_from_db()
    assert (person.organisation, person.is_installation_operator, person.has_usable_password()) == (homes[0], False, False)
    assert client.get(f"/admin/workspace/user/{person.pk}/password/").status_code in (302, 404)
    assert 'type="password"' not in client.get(f"/admin/workspace/user/{person.pk}/password/", follow=True).content.decode()
    assert client.get("/admin/password_change/").headers["Location"] == "/account"
    assert client.get(reverse("admin:workspace_user_add")).status_code == 403
    found = client.get(reverse("admin:workspace_user_changelist") + "?password__startswith=a")
    assert found.status_code in (302, 400), "a digest is not to be guessed letter by letter"


def test_an_installation_operator_sees_all_organisations(homes: list[Organisation]) -> None:
    rows = [rows_in_the_admin(home) for home in homes]
    client = client_of(User.objects.create_superuser("root"))
    for model in SCOPED:
        page = client.get(reverse(f"admin:{model._meta.app_label}_{model._meta.model_name}_changelist"))
        assert {row[model].pk for row in rows} <= set(page.context["cl"].queryset.values_list("pk", flat=True)), model


def test_nobody_else_takes_an_installation_operators_account_over() -> None:
    operator, administrator = User.objects.create_superuser("root"), a_user(Role.ADMINISTRATOR)
    client = client_of(administrator)
    assert client.post(reverse("admin:workspace_user_change", args=[operator.pk]), {"email": "a@example.org"}).status_code == 403
    assert client.post(reverse("admin:workspace_user_delete", args=[operator.pk]), {"post": "yes"}).status_code == 403
    person = f"/api/v1/users/{operator.pk}"
    headers = {"If-Match": client.get(person).headers["ETag"]}
    answer = client.patch(person, {"email": "a@example.org"}, content_type="application/json", headers=headers)
    assert (answer.status_code, answer.json()["error"]["code"]) == (403, "operators_alone")
    assert client.delete(f"{person}/second-factor").status_code == 403
    with pytest.raises(OperatorsAlone):
        change_users(users=[operator], actor=administrator, role=Role.VIEWER)
    with pytest.raises(OperatorsAlone):
        delete_user(user=operator, actor=administrator)
    assert User.objects.get(username="root").operates_installation


def test_whoever_has_the_machine_names_installation_operators() -> None:
    person = a_user(Role.ADMINISTRATOR)
    call_command("installation_operator", person.username)
    person.refresh_from_db()
    assert person.operates_installation
    assert AuditEntry.objects.get().after["is_installation_operator"] is True
    call_command("installation_operator", person.username, "--remove")
    person.refresh_from_db()
    assert not person.operates_installation
    with pytest.raises(CommandError):
        call_command("installation_operator", a_user(Role.VIEWER).username)


def test_the_first_person_of_an_organisation_is_invited_from_the_machine(capsys: pytest.CaptureFixture[str]) -> None:
    grid = Organisation.objects.create(name="Grid North")
    call_command("invite", "Grid North")
    path = capsys.readouterr().out.strip().splitlines()[-1]
    form = FORM | {"username": "ann"}
    assert Client().post(path, form).status_code in (200, 302)
    ann = User.objects.get(username="ann")
    assert (ann.organisation, ann.role, ann.operates_installation) == (grid, Role.ADMINISTRATOR, False)
