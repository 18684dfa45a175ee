from django.db import migrations, models


class Migration(migrations.Migration):

    dependencies = [
        ('telemetry', '0003_results_by_approval'),
    ]

    operations = [
        migrations.AddField(
            model_name='uavlink',
            name='limits',
            field=models.JSONField(blank=True, db_default={}, default=dict, help_text="what it would not fly, by its parameters' names [m]; see ground_station/limits.py"),
        ),
    ]
