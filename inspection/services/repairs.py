"""Repairs of issues: their previews, and their execution through curation, so that imports keep them and the history records them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from django.utils.translation import gettext as _
from django.utils.translation import ngettext

from inspection.models import AssetKind, DataIssue, DataIssueKind, DataIssueState
from inspection.services.curation import many_edits, save_asset
from inspection.services.data_issues import mark_repaired, reopen_issue
from inspection.services.facts import geojson
from inspection.services.history import undo
from inspection.services.repair_edits import (
    CannotRepair,
    RepairEdit,
    attach_towers,
    bridge_carries,
    join_to_network,
    joined_ends,
    leave_out,
    line_along_towers,
    towers_along_span,
    towers_at_vertices,
    with_voltages,
)
from workspace.models import AuditEntry, User


@dataclass(frozen=True)
class Offer:
    """An available repair. `words` is its button's text; `choices` are values for its parameter."""

    action: str
    words: str
    parameter: str = ""
    choices: tuple[tuple[Any, str], ...] = ()


@dataclass(frozen=True)
class Repaired:
    issue: DataIssue
    entries: list[int] = field(default_factory=list)  # of the history, oldest first: undo them in reverse
    said: str = ""


def offers_of(issue: DataIssue) -> list[Offer]:
    """Return the available repairs of an open issue, best first."""
    if issue.state != DataIssueState.OPEN:
        return []
    return _OFFERS[DataIssueKind(issue.kind)](issue.details)


def changes_of(*, issue: DataIssue, action: str, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return the assets as the repair would leave them, in order; nothing is saved. Raises CannotRepair."""
    if all(offer.action != action for offer in offers_of(issue)):
        raise CannotRepair(_("This repair does not fit the issue as it is now."))
    return _BUILDERS[action](issue, parameters)


def preview_of(*, issue: DataIssue, action: str, parameters: dict[str, Any]) -> dict[str, Any]:
    """Return a FeatureCollection of what the repair would draw: `role` is line, tower or asset."""
    features = [
        {
            "type": "Feature",
            "geometry": geojson(change.asset.geometry),
            "properties": {"role": change.asset.kind, "is_new": change.asset.pk is None},
        }
        for change in changes_of(issue=issue, action=action, parameters=parameters)
    ]
    return {"type": "FeatureCollection", "features": features}


def repair_issue(*, issue: DataIssue, action: str, parameters: dict[str, Any], actor: User) -> Repaired:
    """Apply the changes, each with a history entry, and mark the issue as repaired until the next search. Raises CannotRepair."""
    with many_edits():
        kept = DataIssue.objects.select_for_update(of=["self"]).get(pk=issue.pk)
        if kept.state != DataIssueState.OPEN:
            raise CannotRepair(_("Somebody has decided about this issue already."))
        changes = changes_of(issue=kept, action=action, parameters=parameters)
        last = AuditEntry.objects.order_by("-pk").values_list("pk", flat=True).first() or 0
        for change in changes:
            save_asset(asset=change.asset, actor=actor)
        subjects = {str(change.asset.pk) for change in changes}
        entries = AuditEntry.objects.filter(pk__gt=last, subject_type="asset", subject_id__in=subjects, actor=actor)
        numbers = list(entries.order_by("pk").values_list("pk", flat=True))
        kept = mark_repaired(issue=kept, actor=actor)
    return Repaired(kept, numbers, _said(changes))


def undo_repair(*, issue: DataIssue, entries: Sequence[int], actor: User) -> DataIssue:
    """Undo a repair, last change first, completely or not at all. Raises history.CannotUndo, CannotRepair."""
    with many_edits():
        rows = AuditEntry.objects.filter(pk__in=entries, subject_type="asset", organisation=actor.organisation)
        if len(rows) != len(set(entries)) or not rows:
            raise CannotRepair(_("These are no changes of a repair."))
        for entry in sorted(rows, key=lambda row: -row.pk):
            undo(entry=entry, actor=actor)
        return reopen_issue(issue=issue, actor=actor)


def _said(changes: Sequence[RepairEdit]) -> str:
    """Return the text of the toast: "9 towers placed, 1 line changed"."""
    parts = []
    for is_new in (True, False):
        for kind in AssetKind:
            number = sum(change.asset.kind == kind and change.is_new == is_new for change in changes)
            if number:
                parts.append(_done(kind, is_new, number) % {"count": f"{number:,}"})
    return ", ".join(parts) + "."


def _done(kind: AssetKind, is_new: bool, number: int) -> str:
    if is_new:
        if kind == AssetKind.LINE:
            return ngettext("%(count)s line drawn", "%(count)s lines drawn", number)
        return ngettext("%(count)s tower placed", "%(count)s towers placed", number)
    return {
        AssetKind.TOWER: ngettext("%(count)s tower changed", "%(count)s towers changed", number),
        AssetKind.LINE: ngettext("%(count)s line changed", "%(count)s lines changed", number),
        AssetKind.RAILWAY: ngettext("%(count)s railway changed", "%(count)s railways changed", number),
        AssetKind.BRIDGE: ngettext("%(count)s bridge changed", "%(count)s bridges changed", number),
    }[kind]


def _offers_of_long_span(details: dict[str, Any]) -> list[Offer]:
    count = details["missing_towers"]
    return [
        Offer("place_towers", ngettext("Place one tower", "Place %(count)s towers evenly", count) % {"count": count}, parameter="positions")
    ]


def _offers_of_missing_supports(details: dict[str, Any]) -> list[Offer]:
    count = details["missing_towers"]
    return [Offer("make_towers", ngettext("Make a tower of the vertex", "Make %(count)s towers of the vertices", count) % {"count": count})]


def _offers_of_lone_tower(details: dict[str, Any]) -> list[Offer]:
    many = details["towers"] > 1
    offers = []
    if details["towers"] == len(details["assets"]):  # of a long row the details list only the first towers
        offers.append(Offer("leave_out", _("Leave them out of the graph") if many else _("Leave it out of the graph")))
    if details["is_path"]:
        offers.insert(0, Offer("draw_line", _("Draw a line along the %(count)s towers") % {"count": details["towers"]}))
    if details["nearest_line_m"] is not None:
        offers.insert(0, Offer("attach", _("Join the nearest tower to the line") if many else _("Join it to the nearest line")))
    return offers


def _offers_of_dead_end(details: dict[str, Any]) -> list[Offer]:
    return [Offer("join_to_network", _("Lead it on to the network"))] if details["nearest"] is not None else []


def _offers_of_bridge(details: dict[str, Any]) -> list[Offer]:
    ways = (
        ("road", _("A road")),
        ("railway", _("A railway")),
        ("path", _("A path")),
        ("water", _("Water")),
        ("pipeline", _("A pipeline")),
    )
    return [Offer("carries", _("It carries"), parameter="way", choices=ways), Offer("leave_out", _("Leave it out of the graph"))]


def _offers_of_voltage(details: dict[str, Any]) -> list[Offer]:
    offered = details["offered_v"]
    volts = ", ".join(f"{value / 1_000:g} kV" for value in offered or ())
    words = _("Correct it to %(voltages)s") % {"voltages": volts} if offered else _("Correct the voltage")
    choices = ((offered, words),) if offered else ()
    return [Offer("set_voltages", words, parameter="voltages_v", choices=choices)]


_OFFERS: dict[DataIssueKind, Callable[[dict[str, Any]], list[Offer]]] = {
    DataIssueKind.LONG_SPAN: _offers_of_long_span,
    DataIssueKind.MISSING_SUPPORT: _offers_of_missing_supports,
    DataIssueKind.LINE_WITHOUT_TOWERS: lambda details: [
        *_offers_of_missing_supports(details),
        Offer("leave_out", _("Leave the line out of the graph")),
    ],
    DataIssueKind.TOWER_ON_NO_LINE: _offers_of_lone_tower,
    DataIssueKind.DEAD_END: _offers_of_dead_end,
    DataIssueKind.ENDS_APART: lambda details: [
        Offer("join", _("Join the ends") if details["is_at_end"] else _("Join the end to the line"))
    ],
    DataIssueKind.BRIDGE_WITHOUT_WAY: _offers_of_bridge,
    DataIssueKind.IMPOSSIBLE_VOLTAGE: _offers_of_voltage,
}
_BUILDERS: dict[str, Callable[[DataIssue, dict[str, Any]], list[RepairEdit]]] = {
    "place_towers": towers_along_span,
    "make_towers": towers_at_vertices,
    "attach": attach_towers,
    "draw_line": line_along_towers,
    "leave_out": leave_out,
    "join": joined_ends,
    "join_to_network": join_to_network,
    "carries": bridge_carries,
    "set_voltages": with_voltages,
}
