"""What jobs say as reasons. The text in English stays beside them for the version before."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("workspace", "0001_squashed_0010_service_accounts")]

    operations = [
        migrations.AddField(
            model_name="job",
            name="message_why",
            field=models.JSONField(blank=True, help_text="the same as reasons; see reason_texts.py", null=True),
        ),
    ]
