"""What jobs say as reasons. The text in English stays beside them for the version before; jobs that ended with a fixed one get its code."""

import json

from django.db import migrations, models
from django.db.models import F, JSONField, Value
from django.db.models.functions import JSONObject

MESSAGES = {
    "Cancelled": "job_cancelled",
    "Planned": "planned",
    "Stopped; the best plan until then is kept": "planning_stopped",
    "Worked out": "worked_out",
    "Read": "file_read",
    "Refused": "file_refused",
    "Applied": "file_applied",
    "Held back: look at the difference.": "file_held_back",
    "The ground has changed since: look at the difference again.": "ground_has_changed",
    "The subscription is no longer there.": "subscription_gone",
    "A new file is proposed.": "new_file_proposed",
    "Nothing new.": "nothing_new",
    "Rehearsed": "rehearsed",
    "Demo missions made": "demo_made",
}
ERRORS = {
    "Not done within the time limit; it is not tried again.": "job_time_limit",
    "There is no network yet: import infrastructure first, or wait until it has been linked.": "no_network",
    "The no-fly zones are being changed just now. Plan again in a moment.": "zones_changing",
    "The mission was changed while its plan was being made. Plan it again.": "mission_changed",
    "Only drafts and planned missions can be planned.": "mission_frozen",
    "A mission needs at least one UAV and one target.": "nothing_to_plan",
    "The planner failed; the error is in the log.": "planner_failed",
    "Reading the file takes more processor time than a file of its size may need.": "too_much_processor_time",
    "The demo region was removed.": "demo_region_removed",
    "The demo missions were not flown in time.": "demo_not_flown_in_time",
    "The demo missions could not be made; the error is in the log.": "demo_failed",
    "The mission was changed while it was being rehearsed. Rehearse it again.": "changed_while_rehearsed",
    "Zones, terrain, towers or wires about the routes were changed while the mission was being rehearsed. Rehearse it again.": (
        "ground_changed_while_rehearsed"
    ),
    "The rehearsal failed inside Spanwise; the error is in the log.": "rehearsal_failed",
}


def give_codes(apps, schema_editor):
    jobs = apps.get_model("workspace", "Job").objects.filter(message_why__isnull=True)
    for sentence, code in (MESSAGES | ERRORS).items():
        reasons = [{"code": code, "params": {}}]
        jobs.filter(message=sentence).update(message_why=JSONObject(text=F("message"), reasons=Value(reasons, JSONField())))
        schema_editor.execute(
            "UPDATE workspace_job SET error = error || jsonb_build_object('why', %s::jsonb) WHERE error->>'message' = %s",
            [json.dumps(reasons), sentence],
        )


class Migration(migrations.Migration):
    dependencies = [("workspace", "0001_squashed_0010_service_accounts")]

    operations = [
        migrations.AddField(
            model_name="job",
            name="message_why",
            field=models.JSONField(blank=True, help_text="the same as reasons; see reason_texts.py", null=True),
        ),
        migrations.RunPython(give_codes, migrations.RunPython.noop, elidable=True),
    ]
