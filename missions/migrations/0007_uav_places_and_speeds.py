from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [
        ("missions", "0006_fleet"),
    ]

    operations = [
        migrations.AddField(
            model_name="uav",
            name="located_at",
            field=models.DateTimeField(blank=True, help_text="when the location was set or reported", null=True),
        ),
        migrations.AlterField(
            model_name="uav",
            name="cruise_speed_mps",
            field=models.FloatField(blank=True, help_text="empty = its type's, else the usual speed", null=True),
        ),
        migrations.AlterField(
            model_name="uav",
            name="max_range_m",
            field=models.FloatField(blank=True, help_text="metres on one battery; empty = its type's, else not limited", null=True),
        ),
    ]
