"""Data issues as GeoJSON features."""

import json
from typing import Any

from django.utils.formats import number_format
from django.utils.translation import gettext as _
from django.utils.translation import ngettext

from inspection.models import Asset, AssetKind, DataIssueKind, DataIssueState
from inspection.selectors import asset_detail, asset_label
from inspection.selectors.data_issues import DataIssueSummary, DrawnIssue
from inspection.serializers.features import collection_serializer, feature_serializer
from inspection.services.repairs import Offer, Repaired
from workspace.admin_pages.author_names import AUTHOR_HELP, author_name
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared
from workspace.models import User

Details = dict[str, Any]


def figure(value: float, digits: int = 0) -> str:
    return number_format(round(value, digits), decimal_pos=digits, use_l10n=True, force_grouping=True)


def kilometres(metres: float) -> str:
    """Return "11.3 km" or "0.32 km", for spans, which users compare. The space does not break."""
    return f"{figure(metres / 1_000, 2 if metres < 1_000 else 1)}\N{NO-BREAK SPACE}km"


def length(metres: float) -> str:
    """Return "2.6 m", "698 m" or "34.2 km"."""
    if metres < 999.5:
        return f"{figure(metres, 1 if metres < 20 else 0)}\N{NO-BREAK SPACE}m"
    return kilometres(metres)


def title(kind: str, details: Details) -> str:
    """Return a short title; the asset's own name is shown beside it."""
    match kind:
        case "long_span":
            return _("Span of %(length)s") % {"length": kilometres(details["span_m"])}
        case "missing_support":
            return _counted(
                ngettext("%(count)s tower missing", "%(count)s towers missing", details["missing_towers"]), details["missing_towers"]
            )
        case "line_without_towers":
            return _("Line without towers")
        case "tower_on_no_line":
            return _counted(ngettext("Tower on no line", "%(count)s towers on no line", details["towers"]), details["towers"])
        case "dead_end":
            return _("Line ends in nothing")
        case "ends_apart":
            return _("Lines %(length)s apart") % {"length": length(details["apart_m"])}
        case "bridge_without_way":
            return _("Bridge without a way")
        case _other:
            return _voltage_title(details)


def _voltage_title(details: Details) -> str:
    match details["fault"]:
        case "unusual":
            return _("Unusual voltage")
        case "unread":
            return _("Voltage not readable")
        case "too_many":
            return _("%(count)s voltages") % {"count": len(details["voltages_v"])}
        case _other:
            return _("Impossible voltage")


def sentence(kind: str, details: Details) -> str:
    """Return what is wrong and its consequence."""
    return _SENTENCES[kind](details)


def _long_span(details: Details) -> str:
    said = [
        _("Span of %(length)s; the usual one here is %(usual)s.")
        % {"length": kilometres(details["span_m"]), "usual": kilometres(details["usual_span_m"])}
    ]
    missing = max(1, details["missing_towers"])
    said.append(_counted(ngettext("About one tower is missing.", "About %(count)s towers are missing.", missing), missing))
    if details["is_impossible"]:
        said.append(_("No span in the world is so long."))
    return " ".join(said)


def _missing_support(details: Details) -> str:
    return _("%(count)s of %(all)s vertices have no tower; %(length)s of the line cannot be picked tower by tower.") % {
        "count": details["missing_towers"],
        "all": details["vertices"],
        "length": length(details["without_tower_m"]),
    }


def _line_without_towers(details: Details) -> str:
    return _("None of the line's %(count)s vertices has a tower: %(length)s cannot be picked tower by tower.") % {
        "count": details["vertices"],
        "length": length(details["line_m"]),
    }


def _tower_on_no_line(details: Details) -> str:
    near = details["nearest_line_m"]
    values = {"count": figure(details["towers"]), "length": length(details["row_m"]) if details["towers"] > 1 else ""}
    if near is not None:
        values["near"] = length(near)
    if details["towers"] > 1:
        if near is None:
            return _("%(count)s towers in a row of %(length)s carry no line: it may not be mapped.") % values
        return _("%(count)s towers in a row of %(length)s carry no line; the nearest one is %(near)s away.") % values
    if near is None:
        return _("No line passes the tower, and none is within 500 m.")
    return _("No line passes the tower; the nearest one is %(near)s away.") % values


def _dead_end(details: Details) -> str:
    if details["has_tower"]:
        said = _("The line ends at a tower, and nothing is within 150 m that it could lead to.")
    else:
        said = _("The line ends at a vertex without a tower, and nothing is within 150 m that it could lead to.")
    near = details["nearest_m"]
    return said if near is None else f"{said} {_('Another part of the network is %(length)s away.') % {'length': length(near)}}"


def _ends_apart(details: Details) -> str:
    values = {"length": length(details["apart_m"])}
    if details["is_at_end"]:
        return _("The line ends %(length)s from the other line's end and does not join it.") % values
    return _("The line ends %(length)s from another line and does not join it.") % values


def _bridge_without_way(details: Details) -> str:
    return _("Nothing says what the bridge carries: no road, railway, path or water is mapped on it.")


def _impossible_voltage(details: Details) -> str:
    values = {
        "volts": ", ".join(f"{figure(value)} V" for value in details["voltages_v"]),
        "count": len(details["voltages_v"]),
        "tagged": details.get("tagged", ""),
    }
    match details["fault"]:
        case "too_low":
            return _("%(volts)s: too low for a line on towers. The unit was probably left out.") % values
        case "too_high":
            return _("%(volts)s: no line in the world has more than 1,200 kV.") % values
        case "too_many":
            return _("%(count)s voltages on one line: %(volts)s.") % values
        case "unread":
            return _("The voltage “%(tagged)s” cannot be read.") % values
        case _other:
            return _("%(volts)s: no network is known to use it. It may be right all the same.") % values


def _counted(words: str, count: int) -> str:
    return words % {"count": figure(count)}


_SENTENCES = {
    "long_span": _long_span,
    "missing_support": _missing_support,
    "line_without_towers": _line_without_towers,
    "tower_on_no_line": _tower_on_no_line,
    "dead_end": _dead_end,
    "ends_apart": _ends_apart,
    "bridge_without_way": _bridge_without_way,
    "impossible_voltage": _impossible_voltage,
}


MAX_NOTE_LENGTH = 500


class DataIssueAssetSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    kind = serializers.ChoiceField(choices=AssetKind.choices)
    label: Declared = serializers.CharField()
    detail = serializers.CharField()


class OfferSerializer(serializers.Serializer):
    action = serializers.CharField(help_text="what /repair takes")
    words = serializers.CharField()
    parameter = serializers.CharField(help_text="of /repair, may be empty: positions, way, voltages_v")
    choices = serializers.ListField(child=serializers.JSONField(), help_text="values for the parameter, each with its words")
    preview = serializers.JSONField(allow_null=True, help_text="FeatureCollection of what it would draw; null in lists")
    refused = serializers.CharField(help_text="why it cannot be done now; mostly empty")


class DataIssuePropertiesSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=DataIssueKind.choices)
    state = serializers.ChoiceField(choices=DataIssueState.choices)
    title = serializers.CharField()
    sentence = serializers.CharField()
    asset = DataIssueAssetSerializer(allow_null=True)
    other_asset = DataIssueAssetSerializer(allow_null=True)
    position = serializers.ListField(child=serializers.FloatField(), help_text="lon, lat")
    details = serializers.DictField(help_text="figures with units in their names")
    cut_off_m = serializers.FloatField(help_text="length of network that depends on it")
    repairs = OfferSerializer(many=True)
    note = serializers.CharField()
    decided_by = serializers.CharField(allow_null=True, help_text=AUTHOR_HELP)
    decided_at = serializers.DateTimeField(allow_null=True)
    found_at = serializers.DateTimeField()


DataIssueFeatureSerializer = feature_serializer("DataIssueFeature", DataIssuePropertiesSerializer)
DataIssueCollectionSerializer = collection_serializer("DataIssueCollection", DataIssueFeatureSerializer)


class DataIssueSummarySerializer(serializers.Serializer):
    kinds = serializers.DictField(child=serializers.DictField(child=serializers.IntegerField()), help_text="number by kind, then state")
    is_current = serializers.BooleanField(help_text="false while the ground has changed and is not yet searched again")
    searched_at = serializers.DateTimeField(allow_null=True, help_text="null before the first search")


class RepairSerializer(serializers.Serializer):
    action = serializers.CharField(max_length=40)
    positions = serializers.JSONField(required=False, help_text="place_towers: [[lon, lat], …]; without it evenly")
    way = serializers.CharField(max_length=20, required=False, help_text="carries: road, railway, path, water or pipeline")
    voltages_v = serializers.JSONField(required=False, help_text="set_voltages: [110000]; without it as offered")


class UndoRepairSerializer(serializers.Serializer):
    entries = serializers.ListField(child=serializers.IntegerField(min_value=1), min_length=1, max_length=5_000)


class DismissSerializer(serializers.Serializer):
    note = serializers.CharField(max_length=MAX_NOTE_LENGTH, allow_blank=True, default="")


class RepairedSerializer(serializers.Serializer):
    issue = DataIssueFeatureSerializer(allow_null=True)
    entries = serializers.ListField(child=serializers.IntegerField(), help_text="of the history, oldest first")
    said = serializers.CharField(help_text="what was done, in words")
    is_current = serializers.BooleanField(help_text="whether the ground has been searched again already")


def issue_feature(issue: DrawnIssue, repairs: list[dict[str, Any]], reader: User) -> dict[str, Any]:
    """Return the feature. `issue` has `geometry_json` from inspection.selectors.data_issues."""
    properties = {
        "kind": issue.kind,
        "state": issue.state,
        "title": title(issue.kind, issue.details),
        "sentence": sentence(issue.kind, issue.details),
        "asset": _asset_json(issue.asset),
        "other_asset": _asset_json(issue.other_asset),
        "position": list(issue.position.coords),
        "details": issue.details,
        "cut_off_m": issue.cut_off_m,
        "repairs": repairs,
        "note": issue.note,
        "decided_by": author_name(issue.decided_by, reader),
        "decided_at": issue.decided_at,
        "found_at": issue.found_at,
    }
    return {"type": "Feature", "id": issue.pk, "geometry": json.loads(issue.geometry_json), "properties": properties}


def offer_json(offer: Offer, preview: dict[str, Any] | None = None, refused: str = "") -> dict[str, Any]:
    choices = [{"value": value, "words": words} for value, words in offer.choices]
    return {
        "action": offer.action, "words": offer.words, "parameter": offer.parameter, "choices": choices, "preview": preview,
        "refused": refused,
    }  # fmt: skip


def summary_json(summary: DataIssueSummary, *, is_current: bool) -> dict[str, Any]:
    return {"kinds": summary.counts, "is_current": is_current, "searched_at": summary.searched_at}


def repaired_json(repaired: Repaired, feature: dict[str, Any] | None, *, is_current: bool) -> dict[str, Any]:
    return {"issue": feature, "entries": repaired.entries, "said": repaired.said, "is_current": is_current}


def _asset_json(asset: Asset | None) -> dict[str, Any] | None:
    return {"id": asset.pk, "kind": asset.kind, "label": asset_label(asset), "detail": asset_detail(asset)} if asset else None
