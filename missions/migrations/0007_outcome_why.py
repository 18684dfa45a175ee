"""What became of commands as reasons. The text in English stays beside them for the version before."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0006_unassigned_why")]

    operations = [
        migrations.AddField(
            model_name="uavcommand",
            name="outcome_why",
            field=models.JSONField(blank=True, help_text="the same as reasons; see workspace/reason_texts.py", null=True),
        ),
        migrations.AlterField(
            model_name="uavcommand",
            name="outcome",
            field=models.CharField(blank=True, help_text="why it failed or expired, in English", max_length=500),
        ),
        migrations.AlterField(
            model_name="inspectiontarget",
            name="unassigned_why",
            field=models.JSONField(blank=True, db_default=[], default=list, help_text="the reasons as codes; see operation/reasons.py"),
        ),
    ]
