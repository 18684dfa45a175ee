"""Jobs that ended with a fixed sentence get its code. Not in one transaction: rows are locked one statement at a time."""

from django.db import migrations

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

# Ended jobs alone: the workers of the version before write to the others.
_MESSAGES = """
UPDATE workspace_job job SET message_why = jsonb_build_object(
    'text', job.message, 'reasons', jsonb_build_array(jsonb_build_object('code', known.code, 'params', '{}'::jsonb)))
FROM unnest(%s::text[], %s::text[]) AS known(stored, code)
WHERE job.message_why IS NULL AND job.finished_at IS NOT NULL AND job.message = known.stored
"""
_ERRORS = """
UPDATE workspace_job job SET error = job.error || jsonb_build_object(
    'why', jsonb_build_array(jsonb_build_object('code', known.code, 'params', '{}'::jsonb)))
FROM unnest(%s::text[], %s::text[]) AS known(stored, code)
WHERE job.finished_at IS NOT NULL AND job.error->>'message' = known.stored AND NOT job.error ? 'why'
"""


def give_codes(apps, schema_editor):
    codes = MESSAGES | ERRORS
    for statement in (_MESSAGES, _ERRORS):
        schema_editor.execute(statement, [list(codes), list(codes.values())])


class Migration(migrations.Migration):
    atomic = False
    dependencies = [("workspace", "0002_message_why")]
    operations = [migrations.RunPython(give_codes, migrations.RunPython.noop, elidable=True)]
