from django.db import migrations, models


class Migration(migrations.Migration):

    dependencies = [
        ('simulation', '0003_ground_of_rehearsals'),
    ]

    operations = [
        migrations.AddField(
            model_name='simulatedvehicle',
            name='end_wanted_at',
            field=models.DateTimeField(blank=True, help_text='since when it alone is to be gone', null=True),
        ),
    ]
