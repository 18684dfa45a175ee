"""Data issues of generated and real data: found, kept over searches, repaired, and repaired still after the next import."""

from collections import Counter

import numpy as np
import pytest
from django.contrib.gis.geos import LineString, Point
from django.db import connection

from inspection.models import Asset, DataIssue, DataIssueSearch, DataIssueState
from inspection.quality.network import SupportNetwork
from inspection.quality.repair import search
from inspection.selectors.issue_search_data import issue_search_data
from inspection.services import find_issues, import_osm
from inspection.services.data_issues import SEARCH_LOCK, dismiss_issue, issues_are_current
from inspection.services.repair_edits import CannotRepair
from inspection.services.repairs import offers_of, preview_of, repair_issue, undo_repair
from inspection.tasks import find_issues as find_issues_task
from tests.accounts.users import a_user
from tests.cases import long
from tests.inspection.ground import bridge, line, tower
from workspace.models import AuditEntry, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def curator():
    return a_user(Role.CURATOR)


def counts(state=DataIssueState.OPEN):
    return Counter(DataIssue.objects.filter(state=state).values_list("kind", flat=True))


def repair(issue, curator, action=None, **parameters):
    return repair_issue(issue=issue, action=action or offers_of(issue)[0].action, parameters=parameters, actor=curator)


def state_of(issue):
    return DataIssue.objects.get(pk=issue.pk).state


def test_quillmoor_has_the_gaps_that_were_drawn(region_file):
    """What inspection/demo_region/quillmoor.py draws as faulty is found, each at its place."""
    import_osm(path=region_file("quillmoor.osm.pbf"))
    find_issues()
    assert counts() == {
        "dead_end": 17, "missing_support": 11, "tower_on_no_line": 3, "long_span": 1, "line_without_towers": 1, "ends_apart": 1,
        "bridge_without_way": 1, "impossible_voltage": 1,
    }  # fmt: skip
    found = {issue.kind: issue for issue in DataIssue.objects.select_related("asset")}
    span = found["long_span"]
    assert (span.asset.ref, span.details["span_m"], span.details["missing_towers"]) == ("12", pytest.approx(2_400, rel=0.001), 8)
    assert (found["line_without_towers"].asset.ref, found["line_without_towers"].details["missing_towers"]) == ("13", 22)
    assert (found["ends_apart"].asset.ref, found["ends_apart"].details["apart_m"]) == ("14", pytest.approx(4.0, abs=0.1))
    assert found["bridge_without_way"].asset.name == "Old Quay"
    assert (found["impossible_voltage"].asset.ref, found["impossible_voltage"].details["offered_v"]) == ("15", [110_000])
    rows = sorted(DataIssue.objects.filter(kind="tower_on_no_line").values_list("details__towers", flat=True))
    assert rows == [1, 3, 4]  # one at the edge of the box, whose line is cut off; the portals of a busbar; a row whose line is not mapped


@pytest.mark.long
def test_nepal_has_its_long_spans(shared_data):
    """README of the data: "a few spans are far longer than real spans (max 11.25 km), because towers there are not mapped yet".

    On the great circle, that is; on the ellipsoid it is 11.27 km.
    """
    import_osm(path=shared_data("osm/nepal-power-2025.osm.pbf"))
    find_issues()
    spans = sorted((issue.details["span_m"] for issue in DataIssue.objects.filter(kind="long_span")), reverse=True)
    assert spans[0] == pytest.approx(11_273, abs=1)
    assert len(spans) == 128
    assert min(spans) > 800
    longest = DataIssue.objects.get(kind="long_span", details__span_m=spans[0])
    assert longest.details["is_impossible"]
    found = counts()
    assert (found["tower_on_no_line"], found["line_without_towers"], found["ends_apart"], found["dead_end"]) == (54, 8, 8, 124)
    worst = list(DataIssue.objects.values_list("cut_off_m", flat=True)[:50])
    assert worst == sorted(worst, reverse=True)


@pytest.mark.parametrize(
    ("name", "without_support", "all_nodes", "excused_ends", "lines"),
    [("quillmoor.osm.pbf", 118, 576, 6, 12), pytest.param("columbus-ohio.osm.pbf", 156, 731, 17, 14, marks=pytest.mark.long)],
)
def test_a_region_has_its_untagged_vertices(name, without_support, all_nodes, excused_ends, lines, region_file):
    """README of the real data: 156 of the 731 nodes of its lines are no support, 21 %. Some are ends in substations."""
    import_osm(path=region_file(name))
    ground = issue_search_data()
    network = SupportNetwork(ground)
    bare = network.node_count - network.support_count
    assert (bare, bare + int(network.is_carried.sum())) == (without_support, all_nodes)
    issues = [issue for issue in search(ground) if issue.kind in {"missing_support", "line_without_towers"}]
    places = {place for issue in issues for place in map(tuple, [part.coords[0] for part in issue.geometry.geoms])}
    excused = {tuple(place) for place in network.node_position[network.support_count :].tolist()} - places
    assert (len(places), len(excused)) == (without_support - excused_ends, excused_ends)
    assert len(issues) == lines
    assert all(network.degree[np.flatnonzero((network.node_position == place).all(axis=1))].max() <= 1 for place in excused)


def test_liechtenstein_has_few_issues(shared_data):
    import_osm(path=shared_data("osm/liechtenstein-2021.osm.pbf"))
    find_issues()
    assert counts() == {"dead_end": 3, "bridge_without_way": 5, "missing_support": 1}


@pytest.mark.parametrize("name", ["quillmoor.osm.pbf", *long("nepal-power-2025.osm.pbf")])
def test_a_repair_is_kept_over_the_next_import(name, region_file, curator):
    path = region_file(name)
    import_osm(path=path)
    find_issues()
    issue = DataIssue.objects.filter(kind="long_span").order_by("-details__span_m").first()
    vertices = len(issue.asset.geometry.coords)
    repaired = repair(issue, curator)
    placed = issue.details["missing_towers"]
    assert len(repaired.entries) == placed + 1
    assert repaired.said == f"{placed} towers placed, 1 line changed."
    find_issues()
    assert state_of(issue) == DataIssueState.REPAIRED

    again = import_osm(path=path)
    assert again.counts["kept_edited"] == 1
    assert len(Asset.objects.get(pk=issue.asset_id).geometry.coords) == vertices + placed
    assert Asset.objects.filter(tags={"spanwise:placed": "by hand"}, vanished_at=None).count() == placed
    find_issues(force=True)
    assert state_of(issue) == DataIssueState.REPAIRED


MISSING_SUPPORTS = pytest.mark.parametrize(("name", "missing"), [("quillmoor.osm.pbf", 12), ("liechtenstein-2021.osm.pbf", 3)])


@MISSING_SUPPORTS
def test_a_repair_is_undone_whole(name, missing, region_file, curator):
    import_osm(path=region_file(name))
    find_issues()
    issue = DataIssue.objects.get(kind="missing_support", details__missing_towers=missing)
    before = issue.asset.geometry.coords
    repaired = repair(issue, curator)
    find_issues()
    assert state_of(issue) == DataIssueState.REPAIRED
    made = Asset.objects.filter(tags__has_key="spanwise:placed")
    assert made.count() == len(repaired.entries) == missing
    assert set(made.values_list("line_id", flat=True)) == {issue.asset_id}
    undo_repair(issue=issue, entries=repaired.entries, actor=curator)
    assert made.count() == 0
    assert Asset.objects.get(pk=issue.asset_id).geometry.coords == before
    find_issues()
    assert state_of(issue) == DataIssueState.OPEN


@MISSING_SUPPORTS
def test_a_tower_made_of_a_vertex_is_the_one_that_a_later_file_has(name, missing, region_file, curator):
    """It is known by the vertex's OSM node: no second one when OSM gets it too."""
    import_osm(path=region_file(name))
    find_issues()
    repair(DataIssue.objects.get(kind="missing_support", details__missing_towers=missing), curator)
    made = list(Asset.objects.filter(tags__has_key="spanwise:placed"))
    assert len(made) == missing
    nodes = set(made[0].line.node_osm_ids)
    assert {tower.osm_id for tower in made} <= nodes
    assert {tower.osm_type for tower in made} == {"n"}


def long_line(**facts):
    """Eleven towers 300 m apart, then a span of 2,400 m."""
    places = [(10.0, 56.0 + 0.0027 * step) for step in range(11)] + [(10.0, 56.0 + 0.0027 * 18)]
    for place in places:
        tower(place)
    return line(*places, voltages_v=[110_000], **facts)


def drawn_search():
    return find_issues(force=True)


def test_a_dismissed_issue_stays_dismissed_with_its_note(curator):
    long_line()
    drawn_search()
    issue = DataIssue.objects.get(kind="long_span")
    dismiss_issue(issue=issue, note="A lake: the span is real.", actor=curator)
    tower((10.5, 56.5))
    drawn_search()
    kept = DataIssue.objects.get(pk=issue.pk)
    assert (kept.state, kept.note, kept.decided_by) == (DataIssueState.DISMISSED, "A lake: the span is real.", curator)


def test_an_issue_that_is_gone_counts_as_repaired_and_opens_when_it_is_back():
    row = long_line()
    drawn_search()
    issue = DataIssue.objects.get(kind="long_span")
    Asset.objects.filter(pk=row.pk).update(is_flyable=False)
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED
    Asset.objects.filter(pk=row.pk).update(is_flyable=True)
    drawn_search()
    assert state_of(issue) == DataIssueState.OPEN
    assert DataIssue.objects.filter(kind="long_span").count() == 1


def test_towers_may_be_placed_where_they_were_seen(curator):
    row = long_line()
    drawn_search()
    issue = DataIssue.objects.get(kind="long_span")
    seen = [[10.001, 56.0 + 0.0027 * 16], [10.0005, 56.0 + 0.0027 * 13]]
    repair(issue, curator, positions=seen)
    course = Asset.objects.get(pk=row.pk).geometry.coords
    assert list(course[11:13]) == [tuple(seen[1]), tuple(seen[0])]
    assert [tuple(map(tuple, [row.geometry.coords])) for row in Asset.objects.filter(tags__has_key="spanwise:placed").order_by("pk")] == [
        (tuple(seen[1]),), (tuple(seen[0]),),
    ]  # fmt: skip


@pytest.mark.parametrize("positions", [[], [[10.0]], [["a", "b"]], [[10.0, float("nan")]], [[200.0, 56.0]], "x", [[11.0, 56.04]]])
def test_places_that_are_none_are_refused(curator, positions):
    long_line()
    drawn_search()
    before = AuditEntry.objects.count()
    with pytest.raises(CannotRepair):
        repair(DataIssue.objects.get(kind="long_span"), curator, positions=positions)
    assert (AuditEntry.objects.count(), state_of(DataIssue.objects.get(kind="long_span"))) == (before, DataIssueState.OPEN)


def test_a_line_that_changed_meanwhile_is_not_repaired_blindly(curator):
    row = long_line()
    drawn_search()
    Asset.objects.filter(pk=row.pk).update(geometry=LineString((10.0, 56.0), (10.0, 56.01), srid=4326))
    with pytest.raises(CannotRepair, match="has changed since"):
        repair(DataIssue.objects.get(kind="long_span"), curator)


def test_of_two_curators_the_second_is_told(curator):
    long_line()
    drawn_search()
    issue = DataIssue.objects.get(kind="long_span")
    repair(issue, curator)
    with pytest.raises(CannotRepair, match="Somebody has decided"):
        repair_issue(issue=issue, action="place_towers", parameters={}, actor=a_user(Role.CURATOR))


def test_ends_that_miss_each_other_are_joined(curator):
    """The end without a tower moves; the other one, which has a tower, stays."""
    one = line((10.0, 56.0), (10.0, 56.01), (10.0, 56.02))
    other = line((10.00003, 56.02), (10.01, 56.02))
    tower((10.00003, 56.02))
    drawn_search()
    issue = DataIssue.objects.get(kind="ends_apart")
    repair(issue, curator)
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED
    ends = {Asset.objects.get(pk=one.pk).geometry.coords[-1], Asset.objects.get(pk=other.pk).geometry.coords[0]}
    assert len(ends) == 1 or Asset.objects.get(pk=other.pk).geometry.coords[0] == (10.0, 56.02)
    assert SupportNetwork(issue_search_data()).component.max() == 0


def test_an_end_beside_a_span_gets_a_vertex_there(curator):
    through = line((10.0, 56.0), (10.0, 56.01))
    branch = line((10.00004, 56.004), (10.01, 56.004))
    drawn_search()
    issue = DataIssue.objects.get(kind="ends_apart")
    repaired = repair(issue, curator)
    assert repaired.said == "2 lines changed."
    assert len(Asset.objects.get(pk=through.pk).geometry.coords) == 3
    assert Asset.objects.get(pk=branch.pk).geometry.coords[0] == Asset.objects.get(pk=through.pk).geometry.coords[1]
    assert SupportNetwork(issue_search_data()).component.max() == 0


def test_a_dead_end_is_led_on_to_the_network(curator):
    one, other = line((10.0, 56.0), (10.0, 56.01)), line((10.0, 56.02), (10.0, 56.03))
    drawn_search()
    issue = DataIssue.objects.filter(kind="dead_end", details__nearest_m__lt=1_200, asset=one.pk).first()
    repair(issue, curator)
    assert Asset.objects.get(pk=one.pk).geometry.coords[-1] == other.geometry.coords[0]
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED


def test_a_lone_tower_joins_the_line_beside_it(curator):
    row = line((10.0, 56.0), (10.0, 56.003), (10.0, 56.006))
    for place in row.geometry.coords:
        tower(place)
    tower((10.0002, 56.0045))
    drawn_search()
    issue = DataIssue.objects.get(kind="tower_on_no_line")
    repair(issue, curator)
    assert Asset.objects.get(pk=row.pk).geometry.coords[2] == (10.0002, 56.0045)
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED


def test_a_line_is_drawn_along_a_row_of_towers_and_taken_back(curator):
    places = [(10.0, 56.0 + 0.0027 * step) for step in (2, 0, 3, 1)]
    for place in places:
        tower(place, voltages_v=[132_000])
    drawn_search()
    issue = DataIssue.objects.get(kind="tower_on_no_line")
    repaired = repair(issue, curator, "draw_line")
    assert repaired.said == "1 line drawn."
    row = Asset.objects.get(kind="line")
    assert sorted(places) in (list(row.geometry.coords), list(reversed(row.geometry.coords)))
    assert (row.max_voltage_v, row.supports.count()) == (132_000, 4)
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED
    undo_repair(issue=issue, entries=repaired.entries, actor=curator)
    assert not Asset.objects.filter(kind="line").exists()


def test_what_is_left_out_is_no_issue_any_more(curator):
    lone = tower((10.0, 56.0))
    drawn_search()
    issue = DataIssue.objects.get(kind="tower_on_no_line")
    repair(issue, curator, "leave_out")
    assert not Asset.objects.get(pk=lone.pk).is_flyable
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED


def test_a_voltage_is_corrected_as_offered_or_as_typed(curator):
    offered = line((10.0, 56.0), (10.0, 56.001), voltages_v=[110], tags={"voltage": "110"})
    typed = line((11.0, 56.0), (11.0, 56.001), voltages_v=[220], tags={"voltage": "220"})
    drawn_search()
    repair(DataIssue.objects.get(kind="impossible_voltage", asset=offered), curator)
    repair(DataIssue.objects.get(kind="impossible_voltage", asset=typed), curator, voltages_v=[132_000])
    assert list(Asset.objects.filter(pk__in=[offered.pk, typed.pk]).order_by("pk").values_list("max_voltage_v", flat=True)) == [
        110_000, 132_000,
    ]  # fmt: skip
    drawn_search()
    assert counts(DataIssueState.REPAIRED)["impossible_voltage"] == 2


@pytest.mark.parametrize("volts", [[], [0], [True], ["110000"], [1_200_001], list(range(1_000, 8_000, 1_000)), None])
def test_voltages_that_cannot_be_are_refused(curator, volts):
    line((10.0, 56.0), (10.0, 56.001), voltages_v=[110])
    drawn_search()
    with pytest.raises(CannotRepair):
        repair(DataIssue.objects.get(kind="impossible_voltage"), curator, voltages_v=volts)


def test_a_bridge_is_told_what_it_carries(curator):
    row = bridge(tags={"man_made": "bridge"})
    drawn_search()
    issue = DataIssue.objects.get(kind="bridge_without_way")
    with pytest.raises(CannotRepair):
        repair(issue, curator, "carries", way="cows")
    repair(issue, curator, "carries", way="railway")
    assert Asset.objects.get(pk=row.pk).carries == "a railway"
    drawn_search()
    assert state_of(issue) == DataIssueState.REPAIRED


def test_a_preview_shows_what_would_be_drawn_and_stores_nothing():
    long_line()
    drawn_search()
    before = list(Asset.objects.order_by("pk").values())
    preview = preview_of(issue=DataIssue.objects.get(kind="long_span"), action="place_towers", parameters={})
    roles = Counter((feature["properties"]["role"], feature["properties"]["is_new"]) for feature in preview["features"])
    assert roles == {("line", False): 1, ("tower", True): 7}
    assert list(Asset.objects.order_by("pk").values()) == before


def test_the_search_runs_once_for_each_ground(curator):
    assert find_issues() is None  # no ground yet
    long_line()
    drawn_search()
    assert issues_are_current()
    assert find_issues() is None
    repair(DataIssue.objects.get(kind="long_span"), curator)
    assert not issues_are_current()
    find_issues_task()
    assert issues_are_current()
    assert DataIssueSearch.objects.get().found == DataIssue.objects.filter(state=DataIssueState.OPEN).count()


@pytest.mark.django_db(transaction=True)
def test_one_search_runs_at_a_time():
    long_line()
    other = connection.copy()
    try:
        with other.cursor() as cursor:
            cursor.execute("SELECT pg_advisory_lock(%s)", [SEARCH_LOCK])
        assert find_issues(force=True) is None
        assert not DataIssue.objects.exists()
    finally:
        other.close()


def test_an_issue_goes_with_an_asset_that_is_deleted():
    lone = tower((10.0, 56.0))
    drawn_search()
    lone.delete()
    assert not DataIssue.objects.exists()


def test_a_support_moved_by_a_hand_keeps_its_key():
    lone = tower((10.0, 56.0), osm_id=77)
    drawn_search()
    Asset.objects.filter(pk=lone.pk).update(is_edited=True, geometry=Point(10.0001, 56.0, srid=4326))
    drawn_search()
    assert list(DataIssue.objects.values_list("key", "state")) == [("tower_on_no_line n77", "open")]
