"""Which kind of vehicle a UAV's autopilot says that it steers."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("telemetry", "0013_room_for_what_changes_each_second")]

    operations = [
        migrations.AddField(
            model_name="uavlink",
            name="vehicle_type",
            field=models.PositiveSmallIntegerField(blank=True, help_text="MAV_TYPE of its heartbeat", null=True),
        ),
    ]
