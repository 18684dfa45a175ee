"""The tables as they were after 0010_service_accounts: one migration instead of 10.

An installation that has applied all of them counts this one as applied. An older one is first updated
to the last version that has them.
"""

import django.contrib.auth.validators
import django.contrib.postgres.fields
import django.db.models.deletion
import django.db.models.functions.datetime
import django.utils.timezone
import uuid
import workspace.models
from django.conf import settings
from django.db import migrations, models


def make_default_organisation(apps, schema_editor):
    """Make the organisation of users that are put into no other one."""
    apps.get_model("workspace", "Organisation").objects.get_or_create(name="Default")


class Migration(migrations.Migration):

    replaces = [('workspace', '0001_initial'), ('workspace', '0002_default_organisation'), ('workspace', '0003_roles_and_idempotency'), ('workspace', '0004_people'), ('workspace', '0005_sessions_and_presence'), ('workspace', '0006_job_best'), ('workspace', '0007_second_factors_and_sessions'), ('workspace', '0008_installation_operators'), ('workspace', '0009_token_scopes'), ('workspace', '0010_service_accounts')]

    initial = True

    dependencies = [
        ('sessions', '0001_initial'),
    ]

    operations = [
        migrations.CreateModel(
            name='Organisation',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('name', models.CharField(max_length=200, unique=True)),
                ('requires_second_factor', models.BooleanField(db_default=False, default=False, help_text='of everybody, from the next sign-in on')),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
            ],
            options={
                'ordering': ['name'],
            },
        ),
        migrations.CreateModel(
            name='User',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('password', models.CharField(max_length=128, verbose_name='password')),
                ('last_login', models.DateTimeField(blank=True, null=True, verbose_name='last login')),
                ('username', models.CharField(error_messages={'unique': 'A user with that username already exists.'}, help_text='Required. 150 characters or fewer. Letters, digits and @/./+/-/_ only.', max_length=150, unique=True, validators=[django.contrib.auth.validators.UnicodeUsernameValidator()], verbose_name='username')),
                ('first_name', models.CharField(blank=True, max_length=150, verbose_name='first name')),
                ('last_name', models.CharField(blank=True, max_length=150, verbose_name='last name')),
                ('email', models.EmailField(blank=True, max_length=254, verbose_name='email address')),
                ('is_active', models.BooleanField(default=True, help_text='Designates whether this user should be treated as active. Unselect this instead of deleting accounts.', verbose_name='active')),
                ('date_joined', models.DateTimeField(default=django.utils.timezone.now, verbose_name='date joined')),
                ('role', models.CharField(choices=[('viewer', 'Viewer'), ('operator', 'Operator'), ('curator', 'Curator'), ('administrator', 'Administrator')], default='viewer', max_length=20)),
                ('is_installation_operator', models.BooleanField(db_default=False, default=False, editable=False, help_text='as administrator: of all organisations, in the admin')),
                ('is_service', models.BooleanField(db_default=False, default=False, editable=False, help_text='of a program: nobody signs in with it')),
                ('theme', models.CharField(choices=[('system', 'As the system'), ('light', 'Light'), ('dark', 'Dark')], default='system', max_length=10)),
                ('units', models.CharField(choices=[('metric', 'Metres, kilometres, metres per second'), ('imperial', 'Feet, miles, miles per hour')], default='metric', help_text='what is shown; what is stored is metric', max_length=10)),
                ('time_zone', models.CharField(blank=True, help_text="IANA name; empty: the browser's", max_length=64)),
                ('language', models.CharField(blank=True, choices=[('', 'As the browser'), ('en', 'English'), ('de', 'Deutsch')], default='', max_length=5)),
                ('single_keys', models.BooleanField(default=True, help_text='shortcuts of one key on the pages')),
                ('last_seen_at', models.DateTimeField(blank=True, editable=False, help_text='to the minute', null=True)),
                ('session_generation', models.PositiveIntegerField(default=0, editable=False, help_text='a session of an earlier one has ended')),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.PROTECT, related_name='users', to='workspace.organisation')),
            ],
            options={
                'constraints': [models.CheckConstraint(condition=models.Q(('role__in', ['viewer', 'operator', 'curator', 'administrator'])), name='user_role_known'), models.CheckConstraint(condition=models.Q(('is_service', False), models.Q(('is_installation_operator', False), ('password__startswith', '!')), _connector='OR'), name='service_without_password')],
            },
            managers=[
                ('objects', workspace.models.UserManager()),
            ],
        ),
        migrations.CreateModel(
            name='ApiToken',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('name', models.CharField(default='api', max_length=100)),
                ('token_sha256', models.CharField(editable=False, max_length=64, unique=True)),
                ('scopes', django.contrib.postgres.fields.ArrayField(base_field=models.CharField(choices=[('read', 'Read'), ('plan', 'Plan'), ('fly', 'Fly'), ('curate', 'Curate'), ('administer', 'Administer')], max_length=20), blank=True, help_text='empty: all that the role has', null=True, size=None)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('expires_at', models.DateTimeField()),
                ('revoked_at', models.DateTimeField(blank=True, null=True)),
                ('last_used_at', models.DateTimeField(blank=True, help_text='to the minute', null=True)),
                ('user', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='api_tokens', to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'ordering': ['-created_at'],
            },
        ),
        migrations.CreateModel(
            name='BrowserSession',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('user_agent', models.CharField(blank=True, max_length=200)),
                ('began_at', models.DateTimeField()),
                ('acted_at', models.DateTimeField(help_text='when a page was opened or something was sent, to the minute')),
                ('present_at', models.DateTimeField(help_text='when an open page was last heard of, to the minute')),
                ('session', models.OneToOneField(db_column='session_key', db_constraint=False, on_delete=django.db.models.deletion.CASCADE, related_name='in_use', to='sessions.session')),
                ('user', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='browser_sessions', to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'ordering': ['-present_at', '-pk'],
            },
        ),
        migrations.CreateModel(
            name='SecondFactor',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('sealed_seed', models.CharField(editable=False, max_length=200)),
                ('last_step', models.BigIntegerField(help_text='the 30 s, counted from 1970, of the last code that was taken; none is taken twice')),
                ('wrong_tries', models.PositiveSmallIntegerField(default=0)),
                ('wrong_since', models.DateTimeField(blank=True, help_text='the first of the wrong tries', null=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('user', models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, related_name='second_factor', to=settings.AUTH_USER_MODEL)),
            ],
        ),
        migrations.CreateModel(
            name='RecoveryCode',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('code_sha256', models.CharField(editable=False, max_length=64)),
                ('used_at', models.DateTimeField(blank=True, null=True)),
                ('second_factor', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='recovery_codes', to='workspace.secondfactor')),
            ],
            options={
                'constraints': [models.UniqueConstraint(fields=('second_factor', 'code_sha256'), name='recovery_code_unique')],
            },
        ),
        migrations.CreateModel(
            name='SignInEntry',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('outcome', models.CharField(choices=[('signed-in', 'Signed in'), ('wrong', 'Wrong name or password'), ('wrong-code', 'Wrong code'), ('held-back', 'Too many tries'), ('signed-out', 'Signed out')], max_length=12)),
                ('address', models.CharField(blank=True, help_text='IP address', max_length=45)),
                ('user_agent', models.CharField(blank=True, max_length=200)),
                ('recorded_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('user', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name='sign_ins', to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'verbose_name_plural': 'sign-in entries',
                'ordering': ['-recorded_at', '-pk'],
                'indexes': [models.Index(fields=['-recorded_at', '-id'], name='sign_in_newest_idx'), models.Index(fields=['user', '-recorded_at'], name='sign_in_of_user_idx')],
                'constraints': [models.CheckConstraint(condition=models.Q(('outcome__in', ['signed-in', 'wrong', 'wrong-code', 'held-back', 'signed-out'])), name='sign_in_outcome_known')],
            },
        ),
        migrations.CreateModel(
            name='IdempotencyKey',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('key', models.CharField(max_length=200)),
                ('request_sha256', models.CharField(help_text='of method, path and body', max_length=64)),
                ('status', models.PositiveSmallIntegerField(help_text='empty only inside the transaction that makes the answer', null=True)),
                ('headers', models.JSONField(default=dict)),
                ('body', models.JSONField(null=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('user', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='idempotency_keys', to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'ordering': ['-created_at'],
                'indexes': [models.Index(fields=['created_at'], name='idempotency_age_idx')],
                'constraints': [models.UniqueConstraint(fields=('user', 'key'), name='idempotency_key_unique')],
            },
        ),
        migrations.CreateModel(
            name='Job',
            fields=[
                ('id', models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ('task', models.CharField(help_text='dotted name of the Celery task that does it', max_length=100)),
                ('state', models.CharField(choices=[('queued', 'Queued'), ('running', 'Running'), ('done', 'Done'), ('failed', 'Failed'), ('cancelled', 'Cancelled')], default='queued', max_length=20)),
                ('parameters', models.JSONField(default=dict)),
                ('progress', models.FloatField(default=0.0, help_text='0 to 1')),
                ('message', models.CharField(blank=True, max_length=300)),
                ('best', models.JSONField(blank=True, help_text='the best found so far, while it runs', null=True)),
                ('result', models.JSONField(blank=True, null=True)),
                ('error', models.JSONField(blank=True, null=True)),
                ('attempts', models.PositiveSmallIntegerField(default=0)),
                ('lease_expires_at', models.DateTimeField(blank=True, null=True)),
                ('cancel_requested_at', models.DateTimeField(blank=True, null=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('started_at', models.DateTimeField(blank=True, null=True)),
                ('finished_at', models.DateTimeField(blank=True, null=True)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='jobs', to=settings.AUTH_USER_MODEL)),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.CASCADE, related_name='jobs', to='workspace.organisation')),
            ],
            options={
                'ordering': ['-created_at'],
                'indexes': [models.Index(fields=['state', 'lease_expires_at'], name='job_open_idx'), models.Index(condition=models.Q(('state__in', ['queued', 'running'])), fields=['created_by'], name='job_open_of_user_idx')],
                'constraints': [models.CheckConstraint(condition=models.Q(('state__in', ['queued', 'running', 'done', 'failed', 'cancelled'])), name='job_state_known'), models.CheckConstraint(condition=models.Q(('progress__gte', 0), ('progress__lte', 1)), name='job_progress_share')],
            },
        ),
        migrations.CreateModel(
            name='Invitation',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('email', models.EmailField(blank=True, help_text='where the link was sent; empty: handed over by other means', max_length=254)),
                ('role', models.CharField(choices=[('viewer', 'Viewer'), ('operator', 'Operator'), ('curator', 'Curator'), ('administrator', 'Administrator')], default='viewer', max_length=20)),
                ('token_sha256', models.CharField(editable=False, max_length=64, unique=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('expires_at', models.DateTimeField()),
                ('revoked_at', models.DateTimeField(blank=True, null=True)),
                ('accepted_at', models.DateTimeField(blank=True, null=True)),
                ('accepted_by', models.OneToOneField(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='invitation', to=settings.AUTH_USER_MODEL)),
                ('invited_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='invitations_sent', to=settings.AUTH_USER_MODEL)),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.CASCADE, related_name='invitations', to='workspace.organisation')),
            ],
            options={
                'ordering': ['-created_at'],
                'constraints': [models.CheckConstraint(condition=models.Q(('role__in', ['viewer', 'operator', 'curator', 'administrator'])), name='invitation_role_known')],
            },
        ),
        migrations.CreateModel(
            name='AuditEntry',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('action', models.CharField(max_length=50)),
                ('subject_type', models.CharField(max_length=50)),
                ('subject_id', models.CharField(max_length=50)),
                ('before', models.JSONField(blank=True, null=True)),
                ('after', models.JSONField(blank=True, null=True)),
                ('recorded_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('actor', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='audit_entries', to=settings.AUTH_USER_MODEL)),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.CASCADE, related_name='audit_entries', to='workspace.organisation')),
            ],
            options={
                'verbose_name_plural': 'audit entries',
                'ordering': ['-recorded_at', '-pk'],
                'indexes': [models.Index(fields=['subject_type', 'subject_id', '-recorded_at'], name='audit_subject_idx')],
            },
        ),
        migrations.RunPython(make_default_organisation, migrations.RunPython.noop),
    ]
