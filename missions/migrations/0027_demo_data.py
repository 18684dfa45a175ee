from django.db import migrations, models


class Migration(migrations.Migration):

    dependencies = [
        ('missions', '0026_what_is_missing_of_a_refused_target'),
    ]

    operations = [
        migrations.AddField(
            model_name='mission',
            name='is_demo',
            field=models.BooleanField(db_default=False, default=False, help_text='made with the demo data, and goes with them'),
        ),
        migrations.AddField(
            model_name='uav',
            name='is_demo',
            field=models.BooleanField(db_default=False, default=False, help_text='made with the demo data, and goes with them'),
        ),
    ]
