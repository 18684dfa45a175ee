"""Which kind of vehicle a UAV's autopilot says that it steers."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("telemetry", "0014_battery_state_and_rate_of_a_link")]

    operations = [
        migrations.AddField(
            model_name="uavlink",
            name="vehicle_type",
            field=models.PositiveSmallIntegerField(blank=True, help_text="MAV_TYPE of its heartbeat", null=True),
        ),
    ]
