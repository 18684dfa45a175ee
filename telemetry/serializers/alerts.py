"""Alerts in the API."""

from typing import Any

from django.utils.translation import gettext as _

from missions.serializers.known_fields import KnownFieldsSerializer
from telemetry.alerting.advice import ADVICE, OWN_ACT
from telemetry.alerting.detection import ACTS, KINDS, LAND, RETURN, acts_of
from telemetry.models import Alert, AlertLevel, AlertNote
from telemetry.selectors.alert_words import alert_words
from telemetry.selectors.alerts import WORST
from telemetry.services.alerts.alerts import ACKNOWLEDGED, STILL_OPEN, UNKNOWN
from workspace.api import strict_serializers as serializers
from workspace.models import User

NO_FIGURES = (ACTS, ADVICE, OWN_ACT, WORST)  # keys of an alert's details that have their own fields
MAX_ACKNOWLEDGED = 500  # alerts in one request


class AlertActSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=KINDS, help_text="a command, or take-over: a pilot on site flies it")
    uav = serializers.IntegerField(help_text="whom it is for")


class AlertOwnActSerializer(serializers.Serializer):
    """The UAV already returns or lands, by its failsafe, a pilot or a command."""

    kind = serializers.ChoiceField(choices=[RETURN, LAND])
    since = serializers.DateTimeField(allow_null=True, help_text="by its reports; null: before it was watched")
    is_commanded = serializers.BooleanField(help_text="a command from here leads to it; else its failsafe or a pilot")


class AlertWorstSerializer(serializers.Serializer):
    message = serializers.CharField(help_text="in the reader's language")
    level = serializers.ChoiceField(choices=AlertLevel.choices)
    at = serializers.DateTimeField()


class UnansweredAlertsSerializer(serializers.Serializer):
    """Unacknowledged alerts: open ones, and critical ones that have ended."""

    critical = serializers.IntegerField()
    warning = serializers.IntegerField()
    advisory = serializers.IntegerField()


class AlertSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    uav = serializers.IntegerField(allow_null=True)
    is_simulated = serializers.BooleanField(help_text="of a UAV that is no real aircraft")
    mission = serializers.UUIDField(allow_null=True)
    level = serializers.ChoiceField(choices=AlertLevel.choices)
    code = serializers.CharField(help_text="the cause; see docs/alerts.md")
    subject = serializers.CharField(allow_blank=True, help_text="which of a kind: a zone, another UAV")
    message = serializers.CharField(help_text="in the reader's language")
    details = serializers.JSONField(help_text="figures of the cause")
    acts = AlertActSerializer(many=True, help_text="what it would be answered with, the best first")
    advice = serializers.CharField(
        allow_blank=True, help_text="in the reader's language: what an act costs or why it is not offered, what a silent UAV does by itself"
    )
    own_act = AlertOwnActSerializer(allow_null=True, help_text="what the UAV does about it by itself; null: nothing, or not known")
    worst = AlertWorstSerializer(allow_null=True, help_text="the worst that it has said; null: of an alert that is said once")
    opened_at = serializers.DateTimeField()
    closed_at = serializers.DateTimeField(allow_null=True)
    close_reason = serializers.CharField(allow_blank=True, help_text="cleared, landed, mission-ended or by-person")
    acknowledged_at = serializers.DateTimeField(allow_null=True)
    acknowledged_by = serializers.CharField(allow_null=True)
    revision = serializers.IntegerField(help_text="counts the changes")
    notes = serializers.IntegerField(help_text="how many there are")


class AlertPageSerializer(serializers.Serializer):
    results = AlertSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class AlertNoteSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    author = serializers.CharField(allow_null=True)
    text = serializers.CharField()
    written_at = serializers.DateTimeField()


class AlertStepSerializer(serializers.Serializer):
    at = serializers.DateTimeField()
    what = serializers.ChoiceField(choices=["opened", "rose", "acknowledged", "closed"])
    level = serializers.ChoiceField(choices=AlertLevel.choices, required=False, help_text="from then on")
    by = serializers.CharField(required=False)
    reason = serializers.CharField(required=False)


class AlertDetailSerializer(AlertSerializer):
    written = AlertNoteSerializer(many=True, help_text="the notes, the first first")
    course = AlertStepSerializer(many=True, help_text="what became of it")


class AcknowledgementInputSerializer(KnownFieldsSerializer):
    note = serializers.CharField(required=False, allow_blank=True, max_length=1_000, default="")
    seen_level = serializers.ChoiceField(
        choices=AlertLevel.choices, required=False, help_text="that was seen: an alert that has risen above it since is not acknowledged"
    )


class EndedAlertsInputSerializer(KnownFieldsSerializer):
    alerts = serializers.ListField(
        child=serializers.IntegerField(min_value=1), min_length=1, max_length=MAX_ACKNOWLEDGED, help_text="ids of those that were seen"
    )


class EndedAlertOutcomeSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    outcome = serializers.ChoiceField(
        choices=[ACKNOWLEDGED, STILL_OPEN, UNKNOWN], help_text="still-open: left as it is, to be acknowledged singly"
    )


class EndedAlertsSerializer(serializers.Serializer):
    results = EndedAlertOutcomeSerializer(many=True)


class ClosingInputSerializer(KnownFieldsSerializer):
    reason = serializers.CharField(max_length=1_000, help_text="what became of the UAV; kept as a note")


class AlertNoteInputSerializer(KnownFieldsSerializer):
    text = serializers.CharField(max_length=1_000)


class AlertLimitsSerializer(serializers.Serializer):
    """Alert limits by name; each name ends with its unit."""

    stated = serializers.DictField(child=serializers.FloatField(), help_text="here")
    in_force = serializers.DictField(child=serializers.FloatField(), help_text="these, else those below; a mission's come before a type's")
    usual = serializers.DictField(child=serializers.FloatField())
    bounds = serializers.DictField(child=serializers.ListField(child=serializers.FloatField()), help_text="least and most")


def alert_json(alert: Alert, *, note_count: int) -> dict[str, Any]:
    return {
        "id": alert.pk,
        "uav": alert.uav_id,
        "is_simulated": alert.uav is not None and alert.uav.is_simulated,
        "mission": alert.mission_id,
        "level": alert.level,
        "code": alert.code,
        "subject": alert.subject,
        "message": alert_words(alert.message, alert.values),
        "details": {name: value for name, value in alert.details.items() if name not in NO_FIGURES},
        "acts": acts_of(alert.code, alert.uav_id, alert.details),
        "advice": _advice_words(alert.details.get(ADVICE)),
        "own_act": alert.details.get(OWN_ACT),
        "worst": _worst_json(alert.details.get(WORST)),
        "opened_at": alert.opened_at,
        "closed_at": alert.closed_at,
        "close_reason": alert.close_reason,
        "acknowledged_at": alert.acknowledged_at,
        "acknowledged_by": _name(alert.acknowledged_by),
        "revision": alert.revision,
        "notes": note_count,
    }


def _advice_words(advice: dict[str, Any] | None) -> str:
    if advice is None:
        return ""
    return alert_words(advice["message"], advice["values"]) if advice["values"] else _(advice["message"])


def _worst_json(worst: dict[str, Any] | None) -> dict[str, Any] | None:
    if worst is None:
        return None
    return {"message": alert_words(worst["message"], worst["values"]), "level": worst["level"], "at": worst["at"]}


def note_json(note: AlertNote) -> dict[str, Any]:
    return {"id": note.pk, "author": _name(note.author), "text": note.text, "written_at": note.written_at}


def _name(user: User | None) -> str | None:
    return user.display_name if user else None
