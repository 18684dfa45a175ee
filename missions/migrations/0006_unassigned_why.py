"""Why a target is not planned, as codes; the message in English stays beside them for the version before."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0005_colours")]

    operations = [
        migrations.AddField(
            model_name="inspectiontarget",
            name="unassigned_why",
            field=models.JSONField(blank=True, db_default=[], default=list, help_text="the reasons as codes; see planning/reasons.py"),
        ),
        migrations.AlterField(
            model_name="inspectiontarget",
            name="unassigned_message",
            field=models.CharField(blank=True, help_text="in English", max_length=500),
        ),
    ]
