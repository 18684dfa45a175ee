from django.db import migrations, models


class Migration(migrations.Migration):

    dependencies = [
        ('missions', '0016_commands_and_approvals'),
    ]

    operations = [
        migrations.AddField(
            model_name='uavcommand',
            name='axis',
            field=models.CharField(choices=[('flight', 'Flight'), ('mission', 'Mission'), ('speed', 'Speed')], default='flight', help_text='what it sets: one open command of a UAV each', max_length=10),
            preserve_default=False,
        ),
        migrations.AddConstraint(
            model_name='uavcommand',
            constraint=models.UniqueConstraint(condition=models.Q(('state__in', ['queued', 'sent', 'acknowledged'])), fields=('uav', 'axis'), name='uav_command_one_open_of_an_axis'),
        ),
    ]
