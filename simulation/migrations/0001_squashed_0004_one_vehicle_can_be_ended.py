"""The tables as they were after 0004_one_vehicle_can_be_ended: one migration instead of 4.

An installation that has applied all of them counts this one as applied. An older one is first updated
to the last version that has them.
"""

import django.contrib.gis.db.models.fields
import django.db.models.deletion
import django.db.models.functions.datetime
import uuid
from django.conf import settings
from django.db import migrations, models


class Migration(migrations.Migration):

    replaces = [('simulation', '0001_rehearsals'), ('simulation', '0002_simulations_in_real_time'), ('simulation', '0003_ground_of_rehearsals'), ('simulation', '0004_one_vehicle_can_be_ended')]

    initial = True

    dependencies = [
        ('missions', '0001_squashed_0034_visits_of_targets'),
        ('workspace', '0001_squashed_0010_service_accounts'),
        ('workspace', '__first__'),
    ]

    operations = [
        migrations.CreateModel(
            name='RehearsalRule',
            fields=[
                ('organisation', models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, primary_key=True, related_name='rehearsal_rule', serialize=False, to='workspace.organisation')),
                ('requires_green', models.BooleanField(default=False, help_text='approval needs a rehearsal of the present plan without a fail')),
                ('updated_at', models.DateTimeField(auto_now=True)),
            ],
        ),
        migrations.CreateModel(
            name='SimulatedAirframe',
            fields=[
                ('uav_type', models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, primary_key=True, related_name='simulated_airframe', serialize=False, to='missions.uavtype')),
                ('airframe', models.CharField(help_text='a code of simulation/flight/airframe.py', max_length=40)),
                ('updated_at', models.DateTimeField(auto_now=True)),
            ],
        ),
        migrations.CreateModel(
            name='Rehearsal',
            fields=[
                ('id', models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ('content_sha256', models.CharField(editable=False, help_text='of the routes, what flies them and when', max_length=64)),
                ('mission_revision', models.PositiveIntegerField(help_text='of the mission when it was asked for')),
                ('ground_revision', models.PositiveBigIntegerField(help_text='zones, assets and terrain that it is held against')),
                ('ground_sha256', models.CharField(blank=True, db_default='', default='', editable=False, help_text='of zones, heights and what stands about the routes', max_length=64)),
                ('uavs', models.JSONField(default=list, help_text='by place in the mission: airframe, why, battery; see services/fleet.py')),
                ('seed', models.PositiveIntegerField(default=7, help_text='of gusts and turbulence: the same seed, the same flight')),
                ('level', models.CharField(blank=True, choices=[('pass', 'Pass'), ('warnings', 'Pass with warnings'), ('fail', 'Fail')], help_text='of all runs; empty until they are done', max_length=10)),
                ('limits', models.JSONField(default=dict, help_text='that it is held against, each with its source')),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='rehearsals', to=settings.AUTH_USER_MODEL)),
                ('job', models.OneToOneField(help_text='its state, lease and progress', on_delete=django.db.models.deletion.CASCADE, related_name='rehearsal', to='workspace.job')),
                ('mission', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='rehearsals', to='missions.mission')),
                ('organisation', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='rehearsals', to='workspace.organisation')),
            ],
            options={
                'ordering': ['-created_at', '-pk'],
                'indexes': [models.Index(fields=['mission', '-created_at'], name='rehearsal_newest_idx')],
                'constraints': [models.CheckConstraint(condition=models.Q(('level', ''), ('level__in', ['pass', 'warnings', 'fail']), _connector='OR'), name='rehearsal_level_known')],
            },
        ),
        migrations.CreateModel(
            name='RehearsalRun',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('sequence', models.PositiveSmallIntegerField()),
                ('conditions', models.JSONField(help_text='wind, gusts, battery; see rehearsing/weather_scenario.py')),
                ('level', models.CharField(blank=True, choices=[('pass', 'Pass'), ('warnings', 'Pass with warnings'), ('fail', 'Fail')], help_text='empty until it has been flown', max_length=10)),
                ('verdict', models.JSONField(blank=True, help_text='see assessment/stored.py', null=True)),
                ('took_s', models.FloatField(blank=True, help_text="of the worker's time", null=True)),
                ('finished_at', models.DateTimeField(blank=True, null=True)),
                ('rehearsal', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='runs', to='simulation.rehearsal')),
            ],
            options={
                'ordering': ['sequence'],
                'constraints': [models.UniqueConstraint(fields=('rehearsal', 'sequence'), name='rehearsal_run_sequence'), models.CheckConstraint(condition=models.Q(('level', ''), ('level__in', ['pass', 'warnings', 'fail']), _connector='OR'), name='rehearsal_run_level_known')],
            },
        ),
        migrations.CreateModel(
            name='RehearsalTrack',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('uav', models.PositiveSmallIntegerField(help_text='its place in the mission')),
                ('flights', models.JSONField(help_text='columns of each flight; see assessment/stored.py')),
                ('run', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='tracks', to='simulation.rehearsalrun')),
            ],
            options={
                'ordering': ['uav'],
                'constraints': [models.UniqueConstraint(fields=('run', 'uav'), name='rehearsal_track_uav')],
            },
        ),
        migrations.CreateModel(
            name='Simulation',
            fields=[
                ('id', models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ('speed', models.FloatField(default=1.0, help_text='simulated seconds a second')),
                ('seed', models.PositiveIntegerField(default=7)),
                ('state', models.CharField(choices=[('wanted', 'Waits for a simulator'), ('flying', 'In simulation'), ('ended', 'Ended'), ('failed', 'Failed')], default='wanted', max_length=10)),
                ('reason', models.CharField(blank=True, help_text='why it has ended or failed; see simulation/serializers/simulations.py', max_length=40)),
                ('lifetime_ends_at', models.DateTimeField()),
                ('end_wanted_at', models.DateTimeField(blank=True, null=True)),
                ('ended_at', models.DateTimeField(blank=True, null=True)),
                ('holder', models.CharField(blank=True, help_text='the simulator that flies it, and its run', max_length=120)),
                ('lease_expires_at', models.DateTimeField(blank=True, null=True)),
                ('restarts', models.PositiveIntegerField(default=0, help_text='how often a simulator was lost')),
                ('pace', models.JSONField(default=dict, help_text='how the clock was kept: steps, late ones, what has slipped')),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='simulations', to=settings.AUTH_USER_MODEL)),
                ('mission', models.ForeignKey(blank=True, help_text='empty: of the pool', null=True, on_delete=django.db.models.deletion.CASCADE, related_name='simulations', to='missions.mission')),
                ('organisation', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='simulations', to='workspace.organisation')),
            ],
            options={
                'ordering': ['-created_at', '-pk'],
                'indexes': [models.Index(fields=['organisation', '-created_at'], name='simulation_newest_idx'), models.Index(condition=models.Q(('state__in', ('wanted', 'flying'))), fields=['state'], name='simulation_present_idx')],
                'constraints': [models.CheckConstraint(condition=models.Q(('state__in', ['wanted', 'flying', 'ended', 'failed'])), name='simulation_state_known'), models.CheckConstraint(condition=models.Q(('speed__gt', 0)), name='simulation_speed_positive')],
            },
        ),
        migrations.CreateModel(
            name='SimulatedVehicle',
            fields=[
                ('id', models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ('sequence', models.PositiveSmallIntegerField(help_text="of a mission's: the UAV's place in it")),
                ('name', models.CharField(max_length=100)),
                ('system_id', models.PositiveSmallIntegerField()),
                ('flavour', models.CharField(choices=[('px4', 'PX4'), ('ardupilot', 'ArduPilot')], default='px4', max_length=10)),
                ('airframe', models.CharField(help_text='a code of simulation/flight/airframe.py', max_length=40)),
                ('battery_wh', models.FloatField(blank=True, help_text="empty = the airframe's own", null=True)),
                ('position', django.contrib.gis.db.models.fields.PointField(help_text='where it stands at first', srid=4326)),
                ('ground_amsl_m', models.FloatField(blank=True, help_text='of the ground there; empty = of the terrain, or 0', null=True)),
                ('heading_deg', models.FloatField(default=0.0)),
                ('conditions', models.JSONField(help_text='the air that it flies in, and its battery at first; see rehearsing/weather_scenario.py')),
                ('port', models.PositiveIntegerField(blank=True, help_text='UDP, at which it listens; empty: it talks to the gateway', null=True)),
                ('state', models.CharField(choices=[('wanted', 'Waits for a simulator'), ('flying', 'In simulation'), ('ended', 'Ended'), ('failed', 'Failed')], default='wanted', max_length=10)),
                ('reason', models.CharField(blank=True, max_length=40)),
                ('end_wanted_at', models.DateTimeField(blank=True, help_text='since when it alone is to be gone', null=True)),
                ('restarts', models.PositiveIntegerField(default=0, help_text='how often it was put on the ground anew')),
                ('told', models.JSONField(default=dict, help_text='how it does, as its simulator said last')),
                ('told_at', models.DateTimeField(blank=True, null=True)),
                ('uav', models.ForeignKey(blank=True, help_text='that it stands in for', null=True, on_delete=django.db.models.deletion.CASCADE, related_name='simulated_vehicles', to='missions.uav')),
                ('simulation', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='vehicles', to='simulation.simulation')),
            ],
            options={
                'ordering': ['sequence'],
                'constraints': [models.UniqueConstraint(fields=('simulation', 'sequence'), name='simulated_vehicle_sequence'), models.UniqueConstraint(fields=('simulation', 'system_id'), name='simulated_vehicle_system_id'), models.UniqueConstraint(condition=models.Q(('state__in', ('wanted', 'flying'))), fields=('uav',), name='simulated_vehicle_one_a_uav'), models.UniqueConstraint(condition=models.Q(('state__in', ('wanted', 'flying'))), fields=('port',), name='simulated_vehicle_one_a_port'), models.CheckConstraint(condition=models.Q(('state__in', ['wanted', 'flying', 'ended', 'failed'])), name='simulated_vehicle_state_known'), models.CheckConstraint(condition=models.Q(('flavour__in', ['px4', 'ardupilot'])), name='simulated_vehicle_flavour_known')],
            },
        ),
        migrations.CreateModel(
            name='SimulationChange',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('speed', models.FloatField(blank=True, null=True)),
                ('conditions', models.JSONField(blank=True, null=True)),
                ('faults', models.JSONField(blank=True, help_text='as simulation/flight/faults.py has them', null=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('done_at', models.DateTimeField(blank=True, null=True)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('simulation', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='changes', to='simulation.simulation')),
                ('vehicle', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name='changes', to='simulation.simulatedvehicle')),
            ],
            options={
                'ordering': ['pk'],
                'indexes': [models.Index(condition=models.Q(('done_at', None)), fields=['simulation'], name='simulation_change_open_idx')],
            },
        ),
    ]
