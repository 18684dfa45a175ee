"""Keeps with each target when its UAV reached it and how long it stayed."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0033_planned_starts")]

    operations = [
        migrations.AddField(
            "inspectiontarget",
            "reached_at",
            models.DateTimeField(blank=True, help_text="by the log; empty: not known, or it was not reached", null=True),
        ),
        migrations.AddField(
            "inspectiontarget",
            "held_s",
            models.FloatField(blank=True, help_text="the longest that its UAV can have stayed; empty: not known", null=True),
        ),
        migrations.AddField(
            "inspectiontarget",
            "visit_stored_at",
            models.DateTimeField(blank=True, help_text="when reached_at and held_s were stored or changed", null=True),
        ),
    ]
