"""Why offers are outdated or impossible, and why targets were left out, as reasons. The texts in English stay for the version before."""

from django.db import migrations, models
from django.db.models import F, JSONField, Value
from django.db.models.functions import JSONObject

OFFERS = {
    "It was asked for again.": "asked_for_again",
    "Something else has happened since.": "something_else_happened",
    "It was not worked out in time.": "not_worked_out_in_time",
    "The mission does not fly any more.": "mission_not_flying",
    "It was worked out too long ago.": "worked_out_too_long_ago",
    "Nothing would change: the UAVs fly on as they do.": "nothing_would_change",
    "No other UAV of the mission is in the air.": "nobody_else_in_air",
}


def give_codes(apps, schema_editor):
    offers = apps.get_model("missions", "ReplanOffer").objects.filter(outcome_why__isnull=True)
    for sentence, code in OFFERS.items():
        reasons = Value([{"code": code, "params": {}}], JSONField())
        offers.filter(outcome=sentence).update(outcome_why=JSONObject(text=F("outcome"), reasons=reasons))


class Migration(migrations.Migration):
    dependencies = [("missions", "0007_outcome_why")]

    operations = [
        migrations.AddField(
            model_name="inspectiontarget",
            name="state_why",
            field=models.JSONField(
                blank=True, help_text="the same as reasons, if it was no person; see workspace/reason_texts.py", null=True
            ),
        ),
        migrations.AddField(
            model_name="replanoffer",
            name="outcome_why",
            field=models.JSONField(blank=True, help_text="the same as reasons; see workspace/reason_texts.py", null=True),
        ),
        migrations.AlterField(
            model_name="replanoffer",
            name="outcome",
            field=models.CharField(blank=True, help_text="why it is outdated or impossible, in English", max_length=500),
        ),
        migrations.RunPython(give_codes, migrations.RunPython.noop, elidable=True),
    ]
