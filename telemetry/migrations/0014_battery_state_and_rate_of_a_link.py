"""The battery as the vehicle itself has it, and how much its link carries."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("telemetry", "0013_room_for_what_changes_each_second")]
    operations = [
        migrations.AddField(
            "uavlink",
            "battery_state",
            models.CharField(
                max_length=20, default="", db_default="", blank=True, help_text="as the vehicle itself has it: ok, low, critical, …"
            ),
        ),
        migrations.AddField(
            "uavlink", "received_bytes_s", models.FloatField(null=True, blank=True, help_text="bytes a second of its frames, of late")
        ),
        migrations.AddField("uavlink", "received_messages_s", models.FloatField(null=True, blank=True)),
        migrations.AlterField(
            "alert",
            "close_reason",
            models.CharField(
                max_length=30, blank=True, db_default="", default="", help_text="cleared, landed, mission-ended, by-person"
            ),
        ),
    ]
