from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0022_autopilots_own_return")]

    operations = [
        migrations.AddField(
            model_name="missionuav",
            name="fleet_figures",
            field=models.JSONField(
                blank=True, db_default={}, default=dict, help_text="of the own figures: what the UAV had for them when they were said"
            ),
        ),
    ]
