import django.db.models.deletion
from django.db import migrations, models


class Migration(migrations.Migration):

    dependencies = [
        ("missions", "0017_command_axes"),
        ("telemetry", "0002_boots_of_a_link"),
    ]

    operations = [
        migrations.AddField(
            model_name="inspectionresult",
            name="approval",
            field=models.ForeignKey(
                help_text="that it was flown by", null=True, on_delete=django.db.models.deletion.SET_NULL,
                related_name="results", to="missions.approval",
            ),
        ),
        migrations.AddField(
            model_name="inspectionresult",
            name="place",
            field=models.PositiveIntegerField(default=0, help_text="the target's place in the mission as it was approved, from 0"),
            preserve_default=False,
        ),
        migrations.AlterField(
            model_name="inspectionresult",
            name="target",
            field=models.ForeignKey(
                help_text="empty: the mission is another one by now", null=True, on_delete=django.db.models.deletion.SET_NULL,
                related_name="results", to="missions.inspectiontarget",
            ),
        ),
    ]
