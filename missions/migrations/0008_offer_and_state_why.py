"""Why offers are outdated or impossible, and why targets were left out, as reasons. The texts in English stay for the version before."""

from django.db import migrations, models


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
    ]
