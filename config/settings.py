"""Settings from the environment (twelve-factor); every variable is described in docs/operations.md."""

import contextlib
import os
import secrets
from pathlib import Path
from typing import Any

import dj_database_url

from config import sign_in_settings
from config.environment import entries, flag, languages, log_settings, mail_settings, mebibytes, media_storage, number, secret
from config.openapi_settings import openapi_settings
from config.private_servers import broker_url, private_database_url, private_redis_url, state_directory
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.zones.schedule import ZoneRules
from mavlink.timeouts import CommandRules as VehicleCommandRules
from mavlink.timeouts import TransferRules
from missions.command_rules import CommandLifetimes
from operation.address_limits import operators_per_address, sockets_per_address, trusted_proxies
from planning.rules import FlightRules, RoutingRules, SeparationRules
from planning.views.keep_out import ClearanceRules
from results.media_metadata.photo_process import ReadingLimits

BASE_DIR = Path(__file__).resolve().parent.parent
STATE_DIR = state_directory()


def _secret_key() -> str:
    """Return SPANWISE_SECRET_KEY, else a key made once and stored in the state folder, readable by its owner only."""
    if key := secret("SPANWISE_SECRET_KEY"):
        return key
    path = STATE_DIR / "secret_key"
    if not path.exists():
        STATE_DIR.mkdir(parents=True, exist_ok=True)
        draft = STATE_DIR / f"secret_key.{os.getpid()}"
        draft.touch(mode=0o600)
        draft.write_text(secrets.token_urlsafe(64))
        with contextlib.suppress(FileExistsError):
            os.link(draft, path)  # the first of several processes wins
        draft.unlink()
    return path.read_text()


SECRET_KEY = _secret_key()
SECRET_KEY_FALLBACKS = secret("SPANWISE_OLD_SECRET_KEYS").split()  # sessions and links signed with these stay valid
DEBUG = flag("SPANWISE_DEBUG", default=False)
ALLOWED_HOSTS = entries("SPANWISE_ALLOWED_HOSTS", "127.0.0.1,localhost,[::1]")
CSRF_TRUSTED_ORIGINS = entries("SPANWISE_TRUSTED_ORIGINS", "")
TRUSTED_PROXIES = trusted_proxies()
PUBLIC_ADDRESS = os.environ.get("SPANWISE_PUBLIC_ADDRESS", "").rstrip("/")  # https://host: base of links in mails

# Plain HTTP is for one machine: SPANWISE_HTTPS=1 enables what a public host needs.
HTTPS = flag("SPANWISE_HTTPS", default=False)
SECURE_SSL_REDIRECT = HTTPS
SESSION_COOKIE_SECURE = HTTPS
CSRF_COOKIE_SECURE = HTTPS
COOKIE_PREFIX = "__Host-" if HTTPS else ""  # browsers accept such a cookie only from this host, over TLS
SESSION_COOKIE_NAME = f"{COOKIE_PREFIX}sessionid"
CSRF_COOKIE_NAME = f"{COOKIE_PREFIX}csrftoken"
SECURE_HSTS_SECONDS = 31_536_000 if HTTPS else 0
SECURE_HSTS_INCLUDE_SUBDOMAINS = HTTPS
SECURE_HSTS_PRELOAD = HTTPS
SECURE_PROXY_SSL_HEADER = ("HTTP_X_FORWARDED_PROTO", "https") if HTTPS else None
SECURE_REFERRER_POLICY = "strict-origin-when-cross-origin"  # public tile servers, OSM's among them, require an origin
SESSION_ENGINE = "workspace.sessions.session_store"
SESSION_COOKIE_AGE = int(number("SPANWISE_SESSION_DAYS", 14) * 86_400)  # from the login, whatever the activity
SESSION_IDLE_S = number("SPANWISE_SESSION_IDLE_MINUTES", 120) * 60  # without any open page
SESSION_WATCHING_S = number("SPANWISE_SESSION_WATCHING_HOURS", 12) * 3_600  # of an open page that the user does not use
SESSION_COOKIE_HTTPONLY = True
PASSWORD_HASHERS = ["accounts.password_words.Argon2id", "django.contrib.auth.hashers.PBKDF2PasswordHasher"]  # new, old
MESSAGE_STORAGE = "django.contrib.messages.storage.session.SessionStorage"  # the admin's messages need no cookie
SESSION_COOKIE_SAMESITE = "Lax"
X_FRAME_OPTIONS = "DENY"
# Debian's GDAL is older than 3.9. It reads files from elsewhere only in a process with limits (inspection/importers/gdal_process.py).
SILENCED_SYSTEM_CHECKS = ["gis.W001"]

INSTALLED_APPS = [
    "config.admin_apps.SpanwiseAdminConfig",
    "django.contrib.auth",
    "django.contrib.contenttypes",
    "django.contrib.sessions",
    "django.contrib.messages",
    "django.contrib.staticfiles",
    "django.forms",
    "django.contrib.gis",
    "django.contrib.postgres",
    "rest_framework",
    "drf_spectacular",
    *sign_in_settings.APPS,
    "workspace",
    "accounts",
    "inspection",
    "missions",
    "telemetry",
    "results",
    "simulation",
]

MIDDLEWARE = [
    "config.instrumentation.request_instrumentation.ObservedRequests",
    "django.middleware.security.SecurityMiddleware",
    "django.contrib.sessions.middleware.SessionMiddleware",
    "django.middleware.common.CommonMiddleware",
    "django.middleware.csrf.CsrfViewMiddleware",
    "django.contrib.auth.middleware.AuthenticationMiddleware",
    sign_in_settings.MIDDLEWARE,
    "workspace.sessions.preferences.PreferencesMiddleware",
    "workspace.api.query_parameters.KnownQueryParameters",
    "django.contrib.messages.middleware.MessageMiddleware",
    "django.middleware.clickjacking.XFrameOptionsMiddleware",
]

ROOT_URLCONF = "config.urls"
WSGI_APPLICATION = "config.wsgi.application"
ASGI_APPLICATION = "config.asgi.application"
APPEND_SLASH = False

TEMPLATES = [
    {
        "BACKEND": "django.template.backends.django.DjangoTemplates",
        "DIRS": [BASE_DIR / "templates"],
        "APP_DIRS": True,
        "OPTIONS": {
            "context_processors": [
                "django.template.context_processors.request",
                "django.contrib.auth.context_processors.auth",
                "django.contrib.messages.context_processors.messages",
            ],
        },
    },
]

FORM_RENDERER = "django.forms.renderers.TemplatesSetting"  # widgets' templates are found like any other

_database = dj_database_url.parse(
    secret("DATABASE_URL") or private_database_url(STATE_DIR),
    engine="django.contrib.gis.db.backends.postgis",
    conn_max_age=60,
    conn_health_checks=True,
)
# Only workspace/prepared_statements.py prepares statements: Django sends its own as text. The name is shown in pg_stat_activity.
_named = {"application_name": os.environ.get("SPANWISE_PROGRAM", "spanwise")}
_database["OPTIONS"] = _named | _database.get("OPTIONS", {}) | {"prepare_threshold": 0}
DATABASES = {"default": _database}
DEFAULT_AUTO_FIELD = "django.db.models.BigAutoField"

REDIS_URL = secret("REDIS_URL") or private_redis_url(STATE_DIR)
CACHES = {
    "default": {
        "BACKEND": "django.core.cache.backends.redis.RedisCache",
        "LOCATION": REDIS_URL,
        "KEY_PREFIX": "spanwise",
        "OPTIONS": {"socket_connect_timeout": 1, "socket_timeout": 1},  # the cache's content is dispensable
    },
}

# Notifications between programs and open pages. A page without them polls the row, so Redis may be unavailable, or come back empty.
CHANNEL_LAYERS = {
    "default": {
        "BACKEND": "channels_redis.pubsub.RedisPubSubChannelLayer",
        "CONFIG": {
            "hosts": [{"address": REDIS_URL, "socket_connect_timeout": 1, "socket_timeout": None, "health_check_interval": 10}],
            "prefix": "spanwise-live",
        },
    },
}

AUTH_USER_MODEL = "workspace.User"
AUTHENTICATION_BACKENDS = ["workspace.api.authentication.RoleBackend"]
CURATED_APPS = ["inspection"]  # what curators may change in the admin; administrators may change everything
_DJANGOS_VALIDATORS = ("UserAttributeSimilarity", "MinimumLength", "CommonPassword", "NumericPassword")
AUTH_PASSWORD_VALIDATORS = [
    *({"NAME": f"django.contrib.auth.password_validation.{name}Validator"} for name in _DJANGOS_VALIDATORS),
    {"NAME": "accounts.password_words.ContextWordsValidator"},
]
PASSWORD_WORDS = entries("SPANWISE_PASSWORD_WORDS", "")  # forbidden in passwords, beside those of the trade
REQUIRES_SECOND_FACTOR = flag("SPANWISE_REQUIRE_SECOND_FACTOR", default=False)  # for all users, whatever their organisation requires
globals().update(sign_in_settings.sign_in_settings())
IDENTITY_PROVIDER = sign_in_settings.identity_provider()  # of single sign-on
LOCAL_SIGN_IN = sign_in_settings.local_sign_in(IDENTITY_PROVIDER)  # by passwords and passkeys
PASSWORD_RESET_TIMEOUT = 3_600  # seconds that the link of a mail works
SIGN_IN_LOG_DAYS = int(number("SPANWISE_SIGN_IN_LOG_DAYS", 180))

globals().update(mail_settings(secret("SPANWISE_EMAIL_URL", "console://")))
DEFAULT_FROM_EMAIL = os.environ.get("SPANWISE_EMAIL_FROM", "Spanwise <spanwise@localhost>")

LANGUAGE_CODE = "en-gb"
LOCALE_PATHS = [BASE_DIR / "locale"]
LANGUAGES = languages(LOCALE_PATHS[0])
TIME_ZONE = "UTC"
USE_I18N = True
USE_TZ = True

STATIC_URL = "/static/"
STATIC_ROOT = Path(os.environ.get("SPANWISE_STATIC_DIR") or STATE_DIR / "static")
STORAGES = {
    "default": {"BACKEND": "django.core.files.storage.FileSystemStorage"},
    "media": media_storage(STATE_DIR / "media"),
    "staticfiles": {"BACKEND": "config.static_files.StaticFiles"},
}
STATICFILES_DIRS = [BASE_DIR / "static", ("lib", BASE_DIR / "node_modules" / ".spanwise")]

# Limits of one request of a user. Files are uploaded in parts to a folder that web and worker-data share.
UPLOAD_DIR = Path(os.environ.get("SPANWISE_UPLOAD_DIR") or STATE_DIR / "uploads")
DATA_UPLOAD_MAX_MEMORY_SIZE = 2 * 1024 * 1024
MAX_UPLOAD_BYTES = {
    "osm": mebibytes("SPANWISE_MAX_OSM_MIB", 512),
    "terrain": mebibytes("SPANWISE_MAX_TERRAIN_MIB", 512),
    "assets": mebibytes("SPANWISE_MAX_ASSETS_MIB", 128),
    "zones": mebibytes("SPANWISE_MAX_ZONES_MIB", 16),
}

UPLOADS_BYTES = mebibytes("SPANWISE_UPLOADS_MIB", 4096)  # of one organisation: announced files that are stored

# Photos and videos: bytes of all that an organisation has, of one file, and the limits of reading one.
MEDIA_BYTES = mebibytes("SPANWISE_MEDIA_MIB", 200 * 1024)
MAX_MEDIUM_BYTES = mebibytes("SPANWISE_MAX_MEDIUM_MIB", 4096)
READING_LIMITS = ReadingLimits(
    memory_bytes=mebibytes("SPANWISE_READING_MIB", 768), max_pixels=int(number("SPANWISE_MAX_MEGAPIXELS", 250) * 1_000_000)
)

REST_FRAMEWORK: dict[str, Any] = {
    "DEFAULT_AUTHENTICATION_CLASSES": [
        "workspace.api.authentication.BearerTokenAuthentication",
        "rest_framework.authentication.SessionAuthentication",
    ],
    "DEFAULT_PERMISSION_CLASSES": ["workspace.api.permissions.RolePermission"],
    "DEFAULT_RENDERER_CLASSES": ["rest_framework.renderers.JSONRenderer"],
    "DEFAULT_PARSER_CLASSES": ["workspace.api.parsers.StrictJSONParser"],
    "DEFAULT_CONTENT_NEGOTIATION_CLASS": "workspace.api.renderers.ProblemNegotiation",
    "DEFAULT_THROTTLE_CLASSES": ["workspace.api.throttling.ScopedRate"],
    "DEFAULT_METADATA_CLASS": None,
    "URL_FORMAT_OVERRIDE": None,
    "DEFAULT_SCHEMA_CLASS": "workspace.api.schema.SpanwiseSchema",
    "DEFAULT_THROTTLE_RATES": {
        "plans": os.environ.get("SPANWISE_PLAN_RATE", "40/second"),
        "view-plans": os.environ.get("SPANWISE_VIEW_PLAN_RATE", "20/minute"),
        "coverage": os.environ.get("SPANWISE_COVERAGE_RATE", "120/minute"),
        "uav-link": os.environ.get("SPANWISE_UAV_LINK_RATE", "20/second"),
        "tiles": os.environ.get("SPANWISE_TILE_RATE", "3000/minute"),
        "scene": os.environ.get("SPANWISE_SCENE_RATE", "60/minute"),
        "media-uploads": os.environ.get("SPANWISE_MEDIA_UPLOAD_RATE", "3000/minute"),
        "media-files": os.environ.get("SPANWISE_MEDIA_FILE_RATE", "3000/minute"),
        "exports": os.environ.get("SPANWISE_EXPORT_RATE", "30/minute"),
    },
    "EXCEPTION_HANDLER": "workspace.api.errors.error_response",
    "UNAUTHENTICATED_USER": "django.contrib.auth.models.AnonymousUser",
}

SPECTACULAR_SETTINGS = openapi_settings()

# Open websockets over all `live` programs; 0: no limit. Those of an address count for all operators behind it.
SOCKETS_PER_USER = int(os.environ.get("SPANWISE_SOCKETS_PER_USER", "32"))
SOCKETS_PER_ADDRESS = sockets_per_address(operators_per_address())

# Celery: rows in PostgreSQL are authoritative, Redis is a hint (findings: late acknowledgement and a fast sweep, or work is lost).
CELERY_BROKER_URL = broker_url(REDIS_URL)
CELERY_TASK_IGNORE_RESULT = True
CELERY_TASK_ACKS_LATE = True
CELERY_TASK_REJECT_ON_WORKER_LOST = True
CELERY_WORKER_PREFETCH_MULTIPLIER = 1
CELERY_TASK_SERIALIZER = "json"
CELERY_ACCEPT_CONTENT = ["json"]
CELERY_TASK_TIME_LIMIT = 900
CELERY_TASK_SOFT_TIME_LIMIT = 870
CELERY_BROKER_CONNECTION_RETRY_ON_STARTUP = True
CELERY_WORKER_SOFT_SHUTDOWN_TIMEOUT = 5  # unfinished work then returns to the queue: config/worker_shutdown.py
CELERY_BROKER_TRANSPORT_OPTIONS = {
    "visibility_timeout": 1_000,  # longer than the longest task
    "unacked_restore_interval": 2,
    "unacked_restore_throttle": 1,
    "socket_timeout": 10,
    "socket_connect_timeout": 2,
    "health_check_interval": 5,
    # A request that sends a job does not wait for an unavailable queue (kombu's own wait would be 6 s): the sweep sends the job later.
    "max_retries": 1,
    "interval_start": 0.0,
    "interval_step": 0.1,
    "interval_max": 0.1,
}
CELERY_TASK_DEFAULT_QUEUE = "data"
CELERY_TASK_ROUTES = {
    "missions.tasks.expire_commands": {"queue": "flight"},
    "missions.tasks.start_in_planned_order": {"queue": "flight"},
    "telemetry.tasks.settle_command_alerts": {"queue": "flight"},
    "missions.tasks.look_after_offers": {"queue": "data"},
    "missions.tasks.*": {"queue": "planning"},
    "missions.proof_tasks.*": {"queue": "proofs"},
    "simulation.tasks.make_demo_missions": {"queue": "planning"},
    "simulation.tasks.*": {"queue": "simulation"},
}
CELERY_BEAT_SCHEDULE = {
    "rebuild a graph that is out of date": {"task": "inspection.tasks.refresh_graph", "schedule": 5.0, "options": {"expires": 5}},
    "search changed map data for issues": {"task": "inspection.tasks.find_gaps", "schedule": 10.0, "options": {"expires": 10}},
    "queue jobs again that were lost": {"task": "workspace.tasks.requeue_lost_jobs", "schedule": 3.0, "options": {"expires": 3}},
    "settle proposals whose worker was lost": {"task": "inspection.tasks.settle_proposals", "schedule": 15.0, "options": {"expires": 15}},
    "look after offers of another plan": {"task": "missions.tasks.look_after_offers", "schedule": 2.0, "options": {"expires": 2}},
    "start UAVs in planned order": {"task": "missions.tasks.start_in_planned_order", "schedule": 2.0, "options": {"expires": 2}},
    "alert about failed hand-overs and returns": {
        "task": "telemetry.tasks.settle_command_alerts",
        "schedule": 2.0,
        "options": {"expires": 2},
    },
    "end commands to UAVs whose time is over": {"task": "missions.tasks.expire_commands", "schedule": 5.0, "options": {"expires": 5}},
    "fetch zone sets whose time has come": {
        "task": "inspection.tasks.fetch_due_subscriptions",
        "schedule": 60.0,
        "options": {"expires": 60},
    },
    "read media that wait": {"task": "results.tasks.read_media", "schedule": 3.0, "options": {"expires": 3}},
    "forget old uploads of media": {"task": "results.tasks.forget_old_media_uploads", "schedule": 3_600.0},
    "forget old uploads": {"task": "inspection.tasks.forget_old_uploads", "schedule": 3_600.0},
    "forget old sign-ins": {"task": "accounts.tasks.forget_old_sign_ins", "schedule": 3_600.0},
    "forget ended sessions": {"task": "workspace.tasks.forget_ended_sessions", "schedule": 3_600.0},
    "seal second factors with the key of today": {"task": "accounts.tasks.seal_second_factors", "schedule": 3_600.0},
    "store when targets were reached that no watch has looked at": {"task": "telemetry.tasks.store_visits", "schedule": 3_600.0},
    "forget old telemetry": {"task": "telemetry.tasks.forget_old_telemetry", "schedule": 3_600.0},
    "forget old idempotency keys": {"task": "workspace.tasks.forget_old_idempotency_keys", "schedule": 3_600.0},
}
CELERY_BEAT_SCHEDULER = "config.instrumentation.task_instrumentation:WatchedScheduler"
CELERY_BEAT_SCHEDULE_FILENAME = str(STATE_DIR / "celerybeat-schedule")

# Domain rules, each with a unit in its name.
GRAPH_RULES = LinkingRules(
    bridge_to_tower_m=number("SPANWISE_BRIDGE_TO_TOWER_M", LinkingRules.bridge_to_tower_m),
    bridge_to_bridge_m=number("SPANWISE_BRIDGE_TO_BRIDGE_M", LinkingRules.bridge_to_bridge_m),
    railway_to_tower_m=number("SPANWISE_RAILWAY_TO_TOWER_M", LinkingRules.railway_to_tower_m),
    crossing_m=number("SPANWISE_CROSSING_M", LinkingRules.crossing_m),
    railway_spacing_m=number("SPANWISE_RAILWAY_SPACING_M", LinkingRules.railway_spacing_m),
    off_network_factor=number("SPANWISE_OFF_NETWORK_FACTOR", LinkingRules.off_network_factor),
    detour_m=number("SPANWISE_DETOUR_M", LinkingRules.detour_m),
    zone_clearance_m=number("SPANWISE_ZONE_CLEARANCE_M", LinkingRules.zone_clearance_m),
)
ROUTING_RULES = RoutingRules(
    access_leg_m=number("SPANWISE_ACCESS_LEG_M", RoutingRules.access_leg_m),
    small_plan_targets=int(number("SPANWISE_SMALL_PLAN_TARGETS", RoutingRules.small_plan_targets)),
    large_plan_search_s=number("SPANWISE_LARGE_PLAN_SEARCH_S", RoutingRules.large_plan_search_s),
)
PLAN_CONTEXT_DIR = Path(os.environ["SPANWISE_PLAN_CONTEXT_DIR"]) if os.environ.get("SPANWISE_PLAN_CONTEXT_DIR") else None  # of failed plans
FLIGHT_RULES = FlightRules(
    clearance_m=number("SPANWISE_CLEARANCE_M", FlightRules.clearance_m),
    transit_agl_m=number("SPANWISE_TRANSIT_AGL_M", FlightRules.transit_agl_m),
    max_agl_m=number("SPANWISE_MAX_AGL_M", FlightRules.max_agl_m),
    cruise_speed_mps=number("SPANWISE_CRUISE_SPEED_MPS", FlightRules.cruise_speed_mps),
    longest_flight_s=number("SPANWISE_MAX_FLIGHT_S", FlightRules.longest_flight_s),
    turnaround_s=number("SPANWISE_TURNAROUND_S", FlightRules.turnaround_s),
)
ZONE_RULES = ZoneRules(
    time_margin_s=number("SPANWISE_ZONE_TIME_MARGIN_S", ZoneRules.time_margin_s),
    height_margin_m=number("SPANWISE_ZONE_HEIGHT_MARGIN_M", ZoneRules.height_margin_m),
)
FLOWN_HEIGHTS = FlownHeights(
    transit_agl_m=FLIGHT_RULES.transit_agl_m,
    clearance_m=FLIGHT_RULES.clearance_m,
    tolerance_m=FLIGHT_RULES.terrain_tolerance_m,
    margin_m=ZONE_RULES.height_margin_m,
    max_agl_m=FLIGHT_RULES.max_agl_m,
)
CLEARANCE_RULES = ClearanceRules(
    floor_m=number("SPANWISE_WIRE_CLEARANCE_M", ClearanceRules.floor_m),
    position_sd_m=number("SPANWISE_POSITION_SD_M", ClearanceRules.position_sd_m),
    map_error_m=number("SPANWISE_MAP_ERROR_M", ClearanceRules.map_error_m),
)
SEPARATION_RULES = SeparationRules(
    lateral_m=number("SPANWISE_SEPARATION_LATERAL_M", SeparationRules.lateral_m),
    vertical_m=number("SPANWISE_SEPARATION_VERTICAL_M", SeparationRules.vertical_m),
    time_s=number("SPANWISE_SEPARATION_TIME_S", SeparationRules.time_s),
)
COMMAND_RULES = CommandLifetimes(
    motion_s=number("SPANWISE_MOTION_COMMAND_S", CommandLifetimes.motion_s),
    stop_s=number("SPANWISE_STOP_COMMAND_S", CommandLifetimes.stop_s),
    upload_s=number("SPANWISE_UPLOAD_COMMAND_S", CommandLifetimes.upload_s),
    speed_s=number("SPANWISE_SPEED_COMMAND_S", CommandLifetimes.speed_s),
    read_back_s=number("SPANWISE_READ_BACK_S", CommandLifetimes.read_back_s),
)
# The MAVLink gateway: where it listens (HOST:PORT, comma-separated, empty for none), and its limits.
GATEWAY_UDP = os.environ.get("SPANWISE_GATEWAY_UDP", "127.0.0.1:14550")
GATEWAY_TCP = os.environ.get("SPANWISE_GATEWAY_TCP", "127.0.0.1:5760")
GATEWAY_PUBLIC_HOST = os.environ.get("SPANWISE_GATEWAY_PUBLIC_HOST", "")  # under which UAVs reach it; empty: the site's host
GATEWAY_NAME = os.environ.get("SPANWISE_GATEWAY_NAME", "")
GATEWAY_MAX_COMMANDS = int(number("SPANWISE_GATEWAY_MAX_COMMANDS", 200))  # concurrent, above which speeds wait
LINK_BUDGET_BYTES_S = number("SPANWISE_LINK_BUDGET_BYTES_S", 0.0)  # of telemetry by MAVLink of each UAV; 0: no limit
GATEWAY_ALONE_S = number("SPANWISE_GATEWAY_ALONE_S", 30.0)  # without its database, after which UAVs get no heartbeats
GATEWAY_MAX_RECORDS = int(number("SPANWISE_GATEWAY_MAX_RECORDS", 100_000))  # kept in memory while the database is unavailable
FLIGHT_LOG_DIR = Path(os.environ.get("SPANWISE_LOG_DIR") or STATE_DIR / "flight-logs")
MAX_FLIGHT_LOG_MIB = number("SPANWISE_MAX_FLIGHT_LOG_MIB", 256)
# The estimator, which computes where UAVs are between their reports.
ESTIMATOR_NAME = os.environ.get("SPANWISE_ESTIMATOR_NAME", "")
ESTIMATOR_MAX_UAVS = int(number("SPANWISE_ESTIMATOR_MAX_UAVS", 1_000))  # that one estimator holds at once
TAKE_OFF_DISTANCE_M = number("SPANWISE_TAKE_OFF_DISTANCE_M", 100.0)  # at most from the planned take-off, or nothing is uploaded
# Largest difference of reported and planned heights: never more than the margins that plans keep above and below zones.
TAKE_OFF_HEIGHT_M = min(number("SPANWISE_TAKE_OFF_HEIGHT_M", ZONE_RULES.height_margin_m), ZONE_RULES.height_margin_m)
RESUME_DISTANCE_M = number("SPANWISE_RESUME_DISTANCE_M", 30.0)  # at most from the leg that a UAV in the air would continue
TRANSFER_RULES = TransferRules(
    timeout_s=number("SPANWISE_TRANSFER_TIMEOUT_S", TransferRules.timeout_s),
    item_timeout_s=number("SPANWISE_TRANSFER_ITEM_TIMEOUT_S", TransferRules.item_timeout_s),
    retries=int(number("SPANWISE_TRANSFER_RETRIES", TransferRules.retries)),
    attempts=int(number("SPANWISE_TRANSFER_ATTEMPTS", TransferRules.attempts)),
)
VEHICLE_COMMAND_RULES = VehicleCommandRules(
    timeout_s=number("SPANWISE_VEHICLE_COMMAND_TIMEOUT_S", VehicleCommandRules.timeout_s),
    retries=int(number("SPANWISE_VEHICLE_COMMAND_RETRIES", VehicleCommandRules.retries)),
)
TELEMETRY_DAYS = number("SPANWISE_TELEMETRY_DAYS", 365)  # that records are stored; 0: forever
MAX_SYSTEM_IDS = int(number("SPANWISE_MAX_SYSTEM_IDS", 100))  # of MAVLink's 254, for one of several organisations
DATA_WORKERS = int(number("SPANWISE_DATA_WORKERS", 2))  # processes; imports of one organisation leave one of them free
READ_PROCESSOR_S, READ_PROCESSOR_S_PER_MIB = 60.0, 3.0  # limit for reading a file, by its size
MAX_OPEN_PLANS = int(number("SPANWISE_MAX_OPEN_PLANS", 4))  # large plans of one user, waiting and running
MAX_OPEN_REHEARSALS = int(number("SPANWISE_MAX_OPEN_REHEARSALS", 4))  # of one user, waiting and running
# Simulated UAVs in real time: how many, where pool UAVs listen, and where those of missions connect.
SIMULATOR_NAME = os.environ.get("SPANWISE_SIMULATOR_NAME", "")
SIMULATOR_MAX_UAVS = int(number("SPANWISE_SIMULATOR_MAX_UAVS", 60))  # of one simulator; each counts times its speed factor
SIMULATOR_GATEWAY = os.environ.get("SPANWISE_SIMULATOR_GATEWAY", "")  # HOST:PORT; empty: the first of SPANWISE_GATEWAY_UDP
SIMULATOR_HOST = os.environ.get("SPANWISE_SIMULATOR_HOST", "127.0.0.1")
SIMULATOR_PORTS = os.environ.get("SPANWISE_SIMULATOR_PORTS", "14600-14799")
MAX_SIMULATED_UAVS = int(number("SPANWISE_MAX_SIMULATED_UAVS", 20))  # of one organisation at once
MAX_SIMULATION_H = number("SPANWISE_MAX_SIMULATION_H", 8.0)
MAX_WAIT_S = number("SPANWISE_MAX_WAIT_S", 20.0)  # that a request may wait for a large plan (Prefer: wait)
GRAPH_CACHE_DIR = STATE_DIR / "graphs"

# Source of the visible area's OpenStreetMap data for curators; empty for none.
OVERPASS_ADDRESS = os.environ.get("SPANWISE_OVERPASS_ADDRESS", "https://overpass-api.de/api/interpreter")
OVERPASS_MAX_KM2 = number("SPANWISE_OVERPASS_MAX_KM2", 5_000.0)

# Raster tiles under the map: addresses only; without them the page shows a plain background.
BASE_MAP_TILES = os.environ.get("SPANWISE_BASE_MAP_TILES", "https://tile.openstreetmap.org/{z}/{x}/{y}.png")
BASE_MAP_ATTRIBUTION = os.environ.get("SPANWISE_BASE_MAP_ATTRIBUTION", "© OpenStreetMap contributors")
SATELLITE_TILES = os.environ.get("SPANWISE_SATELLITE_TILES", "")
SATELLITE_ATTRIBUTION = os.environ.get("SPANWISE_SATELLITE_ATTRIBUTION", "")

# Hosts (host:port) that may be fetched from although they are not on the public internet, such as an own Overpass server.
OUTGOING_ALLOWED_HOSTS = entries("SPANWISE_OUTGOING_ALLOWED_HOSTS", "")

LOG_REQUESTS = flag("SPANWISE_LOG_REQUESTS", default=False)  # one line each, for installations whose proxy logs none
LOGGING = log_settings(os.environ)
