"""What belongs to one organisation is not there for another, for every operation that the OpenAPI document has (findings: S3)."""

import json
import re
from collections.abc import Iterator, Sequence
from datetime import timedelta
from typing import Any

import pytest
from allauth.mfa.models import Authenticator
from django.apps import apps
from django.contrib.gis.geos import Point
from django.contrib.sessions.models import Session
from django.core import serializers
from django.db.models import Model
from django.test import Client
from django.utils import timezone
from drf_spectacular.generators import SchemaGenerator

from accounts.services import make_service_account
from missions.models import (
    Base,
    Campaign,
    CommandKind,
    CredentialKind,
    Mission,
    MissionUav,
    OfferState,
    ReplanOffer,
    SavedSelection,
    UavCredential,
    UavType,
)
from planning.campaigns.crew_days import Crews
from planning.campaigns.rules import CampaignRules, rules_to_json
from results.models import Evidence, Finding, MediaUpload, Medium
from results.services.findings import create_finding
from simulation.models import Rehearsal
from simulation.vehicle_models import SimulatedVehicle, Simulation
from telemetry.models import Alert, AlertLevel, FlightLog
from tests.accounts.users import a_user, client_of
from tests.cases import long
from tests.missions.commands.outbox import a_uav, give
from tests.missions.worlds import UAV_AT
from tests.workspace.sessions.test_roles import SAFE, stand_in
from workspace.jobs.services import create_job
from workspace.models import ApiToken, BrowserSession, Invitation, Organisation, Role, User

pytestmark = pytest.mark.django_db

# The ground is everybody's, and so are vehicles that belong to nobody yet. The others name no row of their own.
SHARED = {
    "asset_id", "issue_id", "entry_id", "proposal_id", "import_id", "upload_id", "set_id", "subscription_id", "zone_id", "region_id",
    "vehicle_id of unknown-vehicles",
}  # fmt: skip
PLACES_WITHIN = {"uav", "kind", "zoom", "column", "row", "first_byte", "ending", "edge"}
APPS = ("mfa", "workspace", "missions", "telemetry", "results", "simulation")
REFUSED = {403, 404, 409}  # 409: it was not deleted, so that nothing is brought back
RULES = rules_to_json(CampaignRules(Crews(UAV_AT)))
OWN_DOINGS = {"workspace.signinentry", "workspace.idempotencykey", "workspace.browsersession"}  # of the stranger


def rows_of(home: Organisation) -> dict[str, Model]:
    """One of everything that an address can name."""
    keeper = a_user(Role.ADMINISTRATOR, home)
    at = Point(*UAV_AT, srid=4326)
    soon = timezone.now() + timedelta(hours=1)
    uav = a_uav("Tern", home)
    mission = Mission.objects.create(name="Bexley", organisation=home)
    MissionUav.objects.create(mission=mission, uav=uav, sequence=0, start=at, max_range_m=20_000.0, cruise_speed_mps=12.0)
    job = create_job(organisation=home, created_by=keeper, task="missions.tasks.solve_plan", parameters={})
    rehearsal_job = create_job(organisation=home, created_by=keeper, task="simulation.tasks.rehearse", parameters={})
    simulation = Simulation.objects.create(organisation=home, mission=mission, lifetime_ends_at=soon)
    return {
        "mission_id": mission,
        "uav_id": uav,
        "base_id": Base.objects.create(organisation=home, name="Yard", location=at),
        "type_id": UavType.objects.create(organisation=home, name="Quad"),
        "command_id": give(uav, CommandKind.HOLD, keeper),
        "credential_id": UavCredential.objects.create(uav=uav, kind=CredentialKind.LINK_TOKEN, token_sha256=f"{home.pk:064}"),
        "log_id": FlightLog.objects.create(organisation=home, uav=uav, path="tern.tlog", started_at=timezone.now()),
        "campaign_id": Campaign.objects.create(organisation=home, name="North", request={"targets": []}, rules=RULES, target_count=0),
        "selection_id": SavedSelection.objects.create(organisation=home, name="South", targets=[]),
        "alert_id": Alert.objects.create(organisation=home, uav=uav, level=AlertLevel.WARNING, code="link-late", opened_at=timezone.now()),
        "offer_id": ReplanOffer.objects.create(mission=mission, code="asked-for", state=OfferState.OPEN),
        "job_id": job,
        "rehearsal_id": Rehearsal.objects.create(
            organisation=home, mission=mission, job=rehearsal_job, mission_revision=1, ground_revision=1, content_sha256="0" * 64
        ),
        "simulation_id": simulation,
        "vehicle_id of simulated-vehicles": SimulatedVehicle.objects.create(
            simulation=simulation, sequence=0, uav=uav, name="Tern", system_id=7, airframe="iris", position=at, conditions={}
        ),
        "medium_id": Medium.objects.create(organisation=home, sha256=f"{home.pk:064}", kind="photo", media_type="image/jpeg", size_bytes=1),
        "finding_id": a_finding(keeper),
        "evidence_id": Evidence.objects.create(
            finding=a_finding(keeper),
            medium=Medium.objects.create(organisation=home, sha256=f"{home.pk:063}1", kind="photo", media_type="image/jpeg", size_bytes=1),
        ),
        "media_upload_id": MediaUpload.objects.create(organisation=home, file_name="tern.jpg", size_bytes=1),
        "user_id": keeper,
        "account_id": make_service_account(actor=keeper, name="erp", role=Role.OPERATOR),
        "invitation_id": Invitation.objects.create(organisation=home, role=Role.VIEWER, token_sha256=f"{home.pk:064}", expires_at=soon),
        "session_id": BrowserSession.objects.create(
            session=session_of(keeper), user=keeper, began_at=timezone.now(), acted_at=timezone.now(), present_at=timezone.now()
        ),
        "passkey_id": Authenticator.objects.create(
            user=keeper, type=Authenticator.Type.WEBAUTHN, data={"name": "Laptop", "credential": {}}
        ),
        "token_id": ApiToken.objects.create(user=keeper, token_sha256=f"{home.pk:064}", expires_at=soon),
    }


def a_finding(user: User) -> Finding:
    return create_finding(actor=user, category="tower-corrosion", severity=2)


def session_of(user: User) -> Session:
    client_of(user)
    return Session.objects.latest("expire_date")


def named(path: str) -> Iterator[str]:
    """The names of an address' parameters; one that means different things is told apart by where it stands."""
    for name in re.findall(r"\{(\w+)\}", path):
        yield f"{name} of {path.split('/')[3]}" if name == "vehicle_id" else name


def operations() -> list[tuple[str, str, dict[str, Any]]]:
    """(method, path, kinds of its parameters) of what names a row."""
    paths = SchemaGenerator().get_schema(public=True)["paths"]
    return [
        (method, path, {parameter["name"]: parameter["schema"] for parameter in operation.get("parameters", [])})
        for path, methods in paths.items()
        for method, operation in methods.items()
        if "{" in path and not path.startswith("/api/v1/uav-link")
    ]


def everything(elsewhere: Organisation) -> str:
    """All rows that are not the stranger's own doing, as text."""
    models = [model for app in APPS for model in apps.get_app_config(app).get_models() if model._meta.label_lower not in OWN_DOINGS]
    rows = [json.loads(serializers.serialize("json", model._default_manager.order_by("pk"))) for model in models]
    return json.dumps([row for of_model in rows for row in of_model if row["fields"].get("organisation") != elsewhere.pk])


def test_what_each_address_names_is_in_the_table() -> None:
    names = {name for _, path, _ in operations() for name in named(path)}
    assert names == set(rows_of(Organisation.objects.get(pk=1))) | SHARED | PLACES_WITHIN


@pytest.mark.parametrize("role", [Role.OPERATOR, *long(Role.VIEWER, Role.CURATOR, Role.ADMINISTRATOR)])
def test_rows_of_another_organisation_are_answered_like_rows_that_are_nowhere(role: Role) -> None:
    home, elsewhere = Organisation.objects.create(name="Home"), Organisation.objects.create(name="Elsewhere")
    rows = rows_of(home)
    client = client_of(a_user(role, elsewhere))
    before = everything(elsewhere)
    asked = 0
    for method, path, kinds in operations():
        names = list(named(path))
        if not set(names) & set(rows):
            continue
        nowhere = [stand_in(kinds[name.split(" of ")[0]]) for name in names]
        there = [rows[name].pk if name in rows else value for name, value in zip(names, nowhere, strict=True)]
        answered, expected = (answer(client, method, path, values) for values in (there, nowhere))
        assert answered[0] in REFUSED, (method, path, answered)
        assert answered == expected, (method, path)
        asked += 1
    assert asked > 60
    assert everything(elsewhere) == before


def answer(client: Client, method: str, path: str, values: Sequence[Any]) -> tuple[int, str]:
    """Status and code of the error, of an address with these for its parameters."""
    for value in values:
        path = re.sub(r"\{\w+\}", str(value), path, count=1)
    body = {} if method in SAFE else {"data": "{}", "content_type": "application/json", "headers": {"If-Match": "*"}}
    response = getattr(client, method)(path, **body)
    is_json = response.headers.get("Content-Type", "").startswith("application/json")
    return response.status_code, response.json()["error"]["code"] if is_json and response.status_code >= 400 else ""


def test_the_same_rows_are_there_for_their_own() -> None:
    home = Organisation.objects.create(name="Home")
    rows = rows_of(home)
    client = client_of(a_user(Role.ADMINISTRATOR, home))
    for name, address in {
        "mission_id": "missions/{}", "uav_id": "uavs/{}", "base_id": "bases/{}", "type_id": "uav-types/{}", "command_id": "commands/{}",
        "selection_id": "selections/{}", "alert_id": "alerts/{}", "offer_id": "replan-offers/{}", "job_id": "jobs/{}",
        "simulation_id": "simulations/{}", "user_id": "users/{}", "medium_id": "media/{}",
        "finding_id": "findings/{}", "media_upload_id": "media-uploads/{}",
    }.items():  # fmt: skip
        assert client.get(f"/api/v1/{address.format(rows[name].pk)}").status_code == 200, name
