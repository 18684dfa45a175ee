"""The admin: every page opens, curators' changes are recorded, and nothing comes from outside."""

import json
import re
from typing import Any

import pytest
from django.contrib import admin
from django.contrib.gis.geos import LineString, Point
from django.test import Client
from django.urls import reverse

import config.urls  # noqa: F401 - the models are registered when the addresses are read
from inspection.models import Asset, AssetKind, DataImport, ImportKind, NoFlyZone, ZoneSet
from inspection.network.infrastructure import NO_OSM_NODE
from inspection.selectors import ground_revision
from inspection.services import WrongGeometry, save_asset
from missions.models import InspectionTarget, Mission, Uav
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import bridge, line, railway, tower, zone
from workspace.models import ApiToken, AuditEntry, Role, User

pytestmark = pytest.mark.django_db

MODELS = sorted((model._meta.app_label, model._meta.model_name) for model in admin.site._registry)
CURATED_MODELS = {  # infrastructure, zones, terrain, and the imports and graphs made of them
    "asset", "assetset", "bridge", "dataissue", "dataimport", "graphsnapshot", "ground", "importproposal", "noflyzone", "powerline",
    "powertower", "railway", "terraintile", "upload", "zoneset", "zonesetversion", "zonesubscription",
}  # fmt: skip


@pytest.fixture
def curator() -> User:
    return a_user(Role.CURATOR)


@pytest.fixture
def client(curator: User) -> Client:
    return client_of(curator)


def change_address(row: Any) -> str:
    return reverse(f"admin:{row._meta.app_label}_{row._meta.model_name}_change", args=[row.pk])


def form_of(answer: Any) -> dict[str, Any]:
    """What a browser would send back unchanged."""
    form = answer.context["adminform"].form
    values = {name: form[name].value() for name in form.fields}
    return {name: "" if value is None or value is False else value for name, value in values.items()}


def point(lon: float, lat: float) -> str:
    return json.dumps({"type": "Point", "coordinates": [lon, lat]})


@pytest.mark.parametrize(("app", "model"), MODELS)
def test_every_list_opens_for_administrators_but_that_of_organisations_which_is_for_operators(app: str, model: str) -> None:
    address = reverse(f"admin:{app}_{model}_changelist")
    assert client_of(a_user(Role.ADMINISTRATOR)).get(address).status_code == (403 if model == "organisation" else 200)
    assert client_of(User.objects.create_superuser("root")).get(address).status_code == 200


@pytest.mark.parametrize(("app", "model"), MODELS)
def test_curators_open_infrastructure_and_zones_and_nothing_else(client: Client, app: str, model: str) -> None:
    is_curated = app == "inspection" and model in CURATED_MODELS
    assert client.get(reverse(f"admin:{app}_{model}_changelist")).status_code == (200 if is_curated else 403)
    if not is_curated:
        assert client.get(reverse(f"admin:{app}_{model}_add")).status_code == 403


def test_the_admins_first_page_lists_all_models_for_administrators_and_curated_ones_for_curators(client: Client) -> None:
    def listed(answer: Any) -> list[tuple[str, str]]:
        apps = answer.context["app_list"]
        return sorted((app["app_label"], entry["model"]._meta.model_name) for app in apps for entry in app["models"])

    assert listed(client_of(User.objects.create_superuser("root")).get("/admin/")) == MODELS
    others = [entry for entry in MODELS if entry[1] != "organisation"]
    assert listed(client_of(a_user(Role.ADMINISTRATOR)).get("/admin/")) == others
    assert listed(client.get("/admin/")) == sorted(("inspection", model) for model in CURATED_MODELS)


def test_curators_cannot_open_or_delete_a_row_of_the_fleet(client: Client, curator: User) -> None:
    uav = Uav.objects.create(name="Kite", location=Point(10.0, 56.0, srid=4326), organisation=curator.organisation)
    assert client.get(change_address(uav)).status_code == 403
    assert client.post(change_address(uav), {"name": "Tern"}).status_code == 403
    assert client.post(reverse("admin:missions_uav_delete", args=[uav.pk]), {"post": "yes"}).status_code == 403
    assert Uav.objects.get().name == "Kite"


def test_strangers_are_sent_to_the_programs_own_sign_in() -> None:
    answer = Client().get("/admin/", follow=True)
    assert [step for step, _ in answer.redirect_chain] == ["/admin/login/?next=/admin/", "/sign-in?next=/admin/"]


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR])
def test_other_roles_are_refused_and_not_sent_in_circles(role: Role) -> None:
    assert client_of(a_user(role)).get("/admin/", follow=True).status_code == 403


@pytest.mark.parametrize("make", [tower, line, railway, bridge, zone])
def test_a_page_with_a_map_asks_nobody_outside(client: Client, make: Any) -> None:
    page = client.get(change_address(make())).content.decode()
    assert "data-geometry" in page
    loaded = re.findall(r'<(?:script|link|img|iframe)[^>]*(?:src|href)="([^"]+)"', page)
    assert "/static/js/admin/geometry_map.js" in loaded
    assert all(address.startswith("/") for address in loaded)
    assert not re.search(r"<script(?![^>]*\bsrc=)[^>]*>\s*\S", page), "an inline script would need a hole in the content policy"


def test_a_change_is_kept_recorded_and_counted(client: Client, curator: User) -> None:
    asset = tower(ref="18")
    revision = ground_revision()
    form = form_of(client.get(change_address(asset)))
    answer = client.post(change_address(asset), form | {"ref": "19", "geometry": point(10.5, 56.5)})
    assert answer.status_code == 302, answer.context["adminform"].form.errors
    asset.refresh_from_db()
    assert (asset.ref, asset.is_edited, asset.geometry.coords, asset.centre.coords) == ("19", True, (10.5, 56.5), (10.5, 56.5))
    assert ground_revision() == revision + 1
    entry = AuditEntry.objects.get()
    assert (entry.actor, entry.action, entry.subject_type, entry.subject_id) == (curator, "changed", "asset", str(asset.pk))
    assert (entry.before["ref"], entry.after["ref"]) == ("18", "19")
    assert entry.after["geometry"] == {"type": "Point", "coordinates": [10.5, 56.5]}


def test_a_line_that_was_drawn_anew_keeps_the_nodes_that_did_not_move(curator: User) -> None:
    asset = line((10.0, 56.0), (10.1, 56.0), (10.2, 56.0), node_osm_ids=[1, 2, 3])
    asset.geometry = LineString((10.0, 56.0), (10.1, 56.1), (10.2, 56.0), srid=4326)
    asset.voltages_v = [20_000, 110_000]
    save_asset(asset=asset, actor=curator)
    asset.refresh_from_db()
    assert asset.node_osm_ids == [1, NO_OSM_NODE, 3]
    assert (asset.voltages_v, asset.max_voltage_v) == ([110_000, 20_000], 110_000)
    assert asset.length_m == pytest.approx(25_500, rel=0.01)  # two legs of 12.8 km, Pythagoras on 6.24 km by 11.13 km


def test_a_new_tower_is_drawn_by_hand(client: Client) -> None:
    address = reverse("admin:inspection_powertower_add")
    form = form_of(client.get(address)) | {"subtype": "tower", "tags": "{}", "geometry": point(10.0, 56.0)}
    answer = client.post(address, form)
    assert answer.status_code == 302, answer.context["adminform"].form.errors
    asset = Asset.objects.get()
    assert (asset.kind, asset.is_edited, asset.osm_id) == (AssetKind.TOWER, True, None)
    assert AuditEntry.objects.get().action == "created"


@pytest.mark.parametrize(
    ("geometry", "fault"),
    [
        ("", "This field is required."),
        ("{", "This is no JSON"),
        ('{"type": "Point", "coordinates": [NaN, 1]}', "NaN is no number"),
        (point(500, 95), "beyond"),
        ('{"type": "LineString", "coordinates": [[10, 56], [11, 56]]}', "drawn as Point"),
    ],
)
def test_a_wrong_geometry_is_shown_back_with_its_fault(client: Client, geometry: str, fault: str) -> None:
    asset = tower()
    answer = client.post(change_address(asset), form_of(client.get(change_address(asset))) | {"geometry": geometry})
    assert answer.status_code == 200
    assert fault in str(answer.context["adminform"].form.errors["geometry"])
    assert not AuditEntry.objects.exists()


@pytest.mark.parametrize(
    ("field", "text", "fault"),
    [
        ("tags", '{"a": NaN}', "NaN is no number"),
        ("tags", '{"a": 1e999}', "too large"),
        ("tags", '{"a": "\\u0000"}', "characters that are none"),
        ("tags", '{"a": "\\ud800"}', "characters that are none"),
        ("tags", "[" * 5_000, "nested"),
        ("tags", "9" * 5_000, "no JSON"),
        ("tags", "null", "An object is needed"),
        ("tags", "[]", "An object is needed"),
        ("height_m", "-5", "A height is above 0"),
        ("geometry", '{"type": ["Point"], "coordinates": [10, 56]}', "is not one of"),
    ],
)
def test_what_cannot_be_stored_is_shown_back_with_its_fault(client: Client, field: str, text: str, fault: str) -> None:
    asset = tower()
    answer = client.post(change_address(asset), form_of(client.get(change_address(asset))) | {field: text})
    assert answer.status_code == 200
    assert fault in str(answer.context["adminform"].form.errors[field])


@pytest.mark.django_db(transaction=True)
def test_a_list_filtered_by_what_no_column_holds_is_a_bad_request(client: Client) -> None:
    assert client.get("/admin/inspection/asset/?kind__exact=%00").status_code == 400


def test_the_filter_by_import_counts_the_assets_of_each(client: Client) -> None:
    source = DataImport.objects.create(kind=ImportKind.OSM, file_name="region.osm.pbf", sha256="0")
    tower(data_import=source)
    answer = client.get(reverse("admin:inspection_asset_changelist"), {"_facets": "True"})
    assert f"region.osm.pbf, {source.imported_at:%d %b %Y} (1)" in answer.content.decode()


def test_the_service_too_refuses_a_geometry_of_another_kind(curator: User) -> None:
    asset = tower()
    asset.kind = AssetKind.LINE
    with pytest.raises(WrongGeometry, match="A power line is drawn as LineString, not as Point"):
        save_asset(asset=asset, actor=curator)


def test_an_asset_that_was_drawn_here_and_is_removed_is_recorded(client: Client) -> None:
    asset = tower(ref="18", osm_type="", osm_id=None)
    revision = ground_revision()
    client.post(reverse("admin:inspection_asset_delete", args=[asset.pk]), {"post": "yes"})
    assert not Asset.objects.exists()
    entry = AuditEntry.objects.get()
    assert (entry.action, entry.before["ref"], entry.after) == ("deleted", "18", None)
    assert ground_revision() == revision + 1


def test_an_asset_that_a_mission_points_at_vanishes_and_keeps_its_place(client: Client, curator: User) -> None:
    asset = tower(ref="18")
    mission = Mission.objects.create(name="Ring", organisation=curator.organisation)
    target = InspectionTarget.objects.create(mission=mission, sequence=0, asset=asset, label="18")
    revision = ground_revision()
    client.post(reverse("admin:inspection_powertower_delete", args=[asset.pk]), {"post": "yes"})
    target.refresh_from_db()
    assert target.asset == asset
    assert target.asset.vanished_at is not None
    assert target.asset.is_edited, "else the next import would bring it back"
    entry = AuditEntry.objects.get()
    assert (entry.before["vanished"], entry.after["vanished"]) == (False, True)
    assert ground_revision() == revision + 1


def test_removing_several_zones_at_once_records_each(client: Client) -> None:
    zones = [zone(), zone()]
    form = {"action": "delete_selected", "_selected_action": [row.pk for row in zones], "post": "yes"}
    client.post(reverse("admin:inspection_noflyzone_changelist"), form)
    assert not NoFlyZone.objects.exists()
    assert AuditEntry.objects.filter(subject_type="zone", action="deleted").count() == 2


SQUARE = [[10.0, 56.0], [10.1, 56.0], [10.1, 56.1], [10.0, 56.1], [10.0, 56.0]]
BOWTIE = [[10.0, 56.0], [10.1, 56.1], [10.1, 56.0], [10.0, 56.1], [10.0, 56.0]]


def area(ring: list[list[float]]) -> str:
    return json.dumps({"type": "Polygon", "coordinates": [ring]})


def test_a_zone_is_drawn_by_hand(client: Client) -> None:
    address = reverse("admin:inspection_noflyzone_add")
    form = form_of(client.get(address)) | {"name": "Fair", "geometry": area(SQUARE), "upper_limit_m": "120", "upper_reference": "AGL"}
    answer = client.post(address, form)
    assert answer.status_code == 302, answer.context["adminform"].form.errors
    stored = NoFlyZone.objects.get()
    assert (stored.geometry.geom_type, stored.lower_limit_m, stored.upper_limit_m) == ("MultiPolygon", None, 120.0)
    assert stored.identifier
    assert AuditEntry.objects.get().after["name"] == "Fair"
    assert ground_revision() == 1


def test_a_zone_that_crosses_itself_is_refused_with_the_place(client: Client) -> None:
    stored = zone()
    answer = client.post(change_address(stored), form_of(client.get(change_address(stored))) | {"geometry": area(BOWTIE)})
    assert "self-intersection at 10.05, 56.05" in str(answer.context["adminform"].form.errors["geometry"])


def test_a_band_upside_down_is_refused(client: Client) -> None:
    stored = zone()
    band = {"lower_limit_m": "200", "lower_reference": "AGL", "upper_limit_m": "100", "upper_reference": "AGL"}
    answer = client.post(change_address(stored), form_of(client.get(change_address(stored))) | band)
    assert answer.status_code == 200
    assert answer.context["adminform"].form.errors


def test_a_zone_that_was_drawn_anew_is_no_longer_its_sources_circle(client: Client) -> None:
    circle = {"centre": [10.0, 56.0], "radius_m": 500.0}
    stored = zone(circle=circle)
    form = form_of(client.get(change_address(stored)))
    client.post(change_address(stored), form | {"name": "Fair"})
    stored.refresh_from_db()
    assert stored.circle == circle
    form = form_of(client.get(change_address(stored)))
    client.post(change_address(stored), form | {"geometry": area(SQUARE)})
    stored.refresh_from_db()
    assert stored.circle is None


def test_who_changes_an_imported_zone_hears_that_it_stays_so(client: Client) -> None:
    stored = zone(zone_set=ZoneSet.objects.create(name="Denmark"))
    answer = client.post(change_address(stored), form_of(client.get(change_address(stored))) | {"name": "Fair"}, follow=True)
    assert "imports of that source leave it alone from now on" in answer.content.decode()


def test_a_uavs_place_is_a_point_that_can_be_dragged() -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    address = reverse("admin:missions_uav_add")
    page = client.get(address)
    assert "data-is-point" in page.content.decode()
    answer = client.post(address, form_of(page) | {"name": "Kite", "location": point(10.0, 56.0)})
    assert answer.status_code == 302, answer.context["adminform"].form.errors
    assert Uav.objects.get().location.coords == (10.0, 56.0)


def test_tokens_are_revoked_and_never_made_here() -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    token = ApiToken.objects.create(user=a_user(), token_sha256="0" * 64, expires_at="2100-01-01T00:00Z")
    page = client.get(change_address(token)).content.decode()
    assert "0" * 64 not in page
    assert client.get(reverse("admin:workspace_apitoken_add")).status_code == 403
    client.post(reverse("admin:workspace_apitoken_changelist"), {"action": "revoke", "_selected_action": [token.pk]})
    token.refresh_from_db()
    assert token.revoked_at is not None


def test_what_the_program_writes_cannot_be_changed(client: Client, curator: User) -> None:
    administrator = client_of(a_user(Role.ADMINISTRATOR))
    entry = AuditEntry.objects.create(organisation=curator.organisation, actor=curator, action="x", subject_type="x", subject_id="1")
    assert administrator.post(change_address(entry), {"action": "y"}).status_code == 403
    assert administrator.post(reverse("admin:workspace_auditentry_delete", args=[entry.pk]), {"post": "yes"}).status_code == 403


def test_scripts_of_the_admin_find_the_texts_of_the_readers_language() -> None:
    page = client_of(a_user(Role.ADMINISTRATOR)).get("/admin/", headers={"Accept-Language": "de"}).content.decode()
    assert re.search(r'<meta name="catalogue" content="/static/js/locale/de[^"]*\.js">', page)
