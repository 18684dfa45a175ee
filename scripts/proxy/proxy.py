"""The reverse proxy (nginx): its configuration for one installation, independent of the machine's own."""

import json
import os
import resource
from pathlib import Path

from operation.address_limits import COSTLY
from operation.json_lines import is_asked_for
from scripts.places import PROGRAMS_WITH_METRICS, WEB_PROGRAMS, CannotStart, Places, health_socket
from scripts.proxy import page_headers, proxy_limits
from scripts.proxy.proxy_site import (
    ALIVE,
    Site,
    came_over_http,
    certificates,
    entrances,
    error_json,
    plain_server,
    quoted,
    upstream_scheme,
    upstreams,
)

MAX_FILES = 65_536
FILES_BESIDE = 256  # nginx's open files besides connections
CONNECT_S = 1  # to a program on the same machine; its backlog is long
BASE_MAP_TILES = "https://tile.openstreetmap.org/{z}/{x}/{y}.png"  # as in config/settings.py
MAX_BODY = "8m"  # above the application's own limit, so that the application responds

# A machine's mime.types may be missing or old, and browsers run only modules that are sent as JavaScript.
MEDIA_TYPES = {
    "text/html": "html",
    "text/css": "css",
    "text/plain": "txt",
    "text/javascript": "js mjs",
    "application/json": "json map",
    "application/geo+json": "geojson",
    "application/wasm": "wasm",
    "application/x-protobuf": "pbf",
    "image/svg+xml": "svg",
    "image/png": "png",
    "image/jpeg": "jpg jpeg",
    "image/webp": "webp",
    "image/x-icon": "ico",
    "font/woff": "woff",
    "font/woff2": "woff2",
    "font/ttf": "ttf",
}
COMPRESSED = (
    "text/css text/plain text/javascript application/json application/geo+json application/wasm image/svg+xml "
    "application/vnd.mapbox-vector-tile application/vnd.oai.openapi application/graphml+xml"
)


def _failures(name: str, media_type: str, headers: str, *, unavailable: str, too_large: str) -> str:
    """Return nginx's own responses: for an unavailable application, and for a body that is too large to pass on."""
    return f"""
        location @{name}_unavailable {{
            internal;
            default_type {media_type};
            add_header Retry-After 5 always;
{headers}
            return 503 '{unavailable}';
        }}
        location @{name}_too_large {{
            internal;
            default_type {media_type};
{headers}
            return 413 '{too_large}';
        }}"""


def _too_many(headers: str) -> str:
    """Return nginx's response to an address that exceeds its limits."""
    return f"""
        location @api_too_many {{
            internal;
            default_type application/json;
            add_header Retry-After {proxy_limits.RETRY_AFTER_S} always;
{headers}
            return 429 '{proxy_limits.TOO_MANY}';
        }}"""


def _proxied(
    location: str,
    name: str,
    headers: str,
    scheme: str,
    *,
    to: tuple[str, str],
    faults: str = "warn",
    again: str = "error",
    limits: str = "",
) -> str:
    return f"""
        location {location} {{
            error_log stderr {faults};
            proxy_pass {to[0]};{to[1]}
            proxy_http_version 1.1;
            proxy_set_header Connection "";
            proxy_set_header Host $http_host;
            proxy_set_header X-Forwarded-For $visitor;
            proxy_set_header X-Forwarded-Proto {scheme};
            proxy_connect_timeout {CONNECT_S}s;
            proxy_read_timeout 120s;
            proxy_next_upstream {again};
            proxy_buffers 16 32k;
            proxy_buffer_size 32k;
            proxy_hide_header X-Content-Type-Options;
            proxy_hide_header Referrer-Policy;
            proxy_hide_header Strict-Transport-Security;
            error_page 502 504 = @{name}_unavailable;
            error_page 413 = @{name}_too_large;{limits}
{headers}
        }}"""


def _websockets(scheme: str, *, to: tuple[str, str]) -> str:
    """Return the location of /ws/. A socket may be silent for three times the keepalive interval of its program."""
    return f"""
        location /ws/ {{
            proxy_pass {to[0]};{to[1]}
            proxy_http_version 1.1;
            proxy_set_header Upgrade $http_upgrade;
            proxy_set_header Connection $connection_upgrade;
            proxy_set_header Host $http_host;
            proxy_set_header X-Forwarded-For $visitor;
            proxy_set_header X-Forwarded-Proto {scheme};
            proxy_connect_timeout 5s;
            proxy_read_timeout 60s;
            proxy_send_timeout 30s;
            proxy_next_upstream error timeout http_503;
            proxy_buffering off;
            error_page 502 504 = @api_unavailable;{proxy_limits.of_sockets()}
        }}"""


def _has_metrics(sockets: Path) -> str:
    """Return a server for metrics on a port of its own: /web-1/metrics and so on; only where SPANWISE_METRICS_PORT is set."""
    port = os.environ.get("SPANWISE_METRICS_PORT", "")
    if not port:
        return ""
    if not port.isdigit():
        raise CannotStart(f"SPANWISE_METRICS_PORT is no port: {port!r}")
    asked = {name: quoted(f"http://unix:{health_socket(sockets, name)}:/") for name in PROGRAMS_WITH_METRICS}
    locations = "\n".join(f"        location /{name}/ {{ proxy_pass {address}; }}" for name, address in asked.items())
    return f"""
    server {{
        listen 127.0.0.1:{port};
        access_log off;
{locations}
        location / {{ return 404; }}
    }}"""


def _line() -> str:
    """Return the log format of a request: for users, or as JSON for programs."""
    if not is_asked_for():
        return """'$time_iso8601 $remote_addr "$told_request" $status $body_bytes_sent $request_time $told_id'"""
    reported = {"time": "$time_iso8601", "level": "INFO", "logger": "requests", "message": "$told_request", "program": "proxy"}
    reported |= {"request": "$told_id", "address": "$remote_addr"}
    numbers = '"status": $status, "bytes": $body_bytes_sent, "seconds": $request_time'
    return f"escape=json '{json.dumps(reported)[:-1]}, {numbers}}}'"


def _file_limit() -> int:
    """Return how many files nginx may have open: a client connection is one, and its upstream connection another."""
    return min(MAX_FILES, resource.getrlimit(resource.RLIMIT_NOFILE)[1])


def is_https_asked_for() -> bool:
    return os.environ.get("SPANWISE_HTTPS", "0").lower() in {"1", "true", "yes", "on"}


def configuration(places: Places, sockets: Path, port: int) -> str:
    """Return nginx.conf for `./run`."""
    return site_configuration(
        Site(
            folder=places.process("proxy"),
            static=places.static,
            web=tuple(f"unix:{sockets / name}.sock" for name in WEB_PROGRAMS),
            live=(f"unix:{sockets / 'live.sock'}",),
            uav_link=(f"unix:{sockets / 'uav-link.sock'}",),
            listens_at=f"127.0.0.1:{port}",
            is_behind_https=is_https_asked_for(),
        ),
        beside=_has_metrics(sockets),
    )


def site_configuration(site: Site, *, beside: str = "") -> str:
    """Return nginx.conf; `beside` holds further servers."""
    folder = site.folder
    tiles = (os.environ.get("SPANWISE_BASE_MAP_TILES", BASE_MAP_TILES), os.environ.get("SPANWISE_SATELLITE_TILES", ""))
    headers = page_headers.headers(tiles, is_https=site.is_https)
    is_behind_https = site.is_behind_https and site.certificate is None
    scheme = "$http_x_forwarded_proto" if is_behind_https else "$scheme"
    mark = "$" if site.resolver else ""
    web, live, uav_link = (
        (f"{upstream_scheme_of}://{mark}{name}", tls)
        for name, (upstream_scheme_of, tls) in {
            "web": upstream_scheme(site, site.web),
            "live": upstream_scheme(site, site.live),
            "uav_link": upstream_scheme(site, site.for_uavs),
        }.items()
    )
    # The application uses the last address: behind a TLS proxy the one that this proxy appends would be the same for all clients.
    visitor = 'map $http_x_forwarded_for $visitor { "" $remote_addr; default $http_x_forwarded_for; }'
    if not is_behind_https:
        visitor = "map $remote_addr $visitor { default $remote_addr; }"
    media_types = "\n".join(f"        {kind} {endings};" for kind, endings in MEDIA_TYPES.items())
    temporary = "\n".join(f"    {kind}_temp_path {quoted(folder / kind)};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
    failures_for_programs = _failures(
        "api",
        "application/json",
        headers,
        unavailable=error_json(503, "unavailable", "Spanwise is not answering; try again."),
        too_large=error_json(413, "too_large", "The body is too large."),
    )
    failures_as_sentences = _failures(
        "page",
        "text/plain",
        headers,
        unavailable="Spanwise is starting or has been stopped. Please try again in a moment.",
        too_large="This is more than Spanwise takes in one request.",
    )
    again = "error" if site.web[0].startswith("unix:") else "error timeout"  # a machine that is down refuses no connection
    # A planning request changes nothing: if its program dies, another one gets it.
    plans = _proxied("= /api/v1/plans", "api", headers, scheme, to=web, again=f"{again} non_idempotent")
    costly = "".join(
        _proxied(kind.location, "api", headers, scheme, to=web, again=again, limits=proxy_limits.of_requests(kind)) for kind in COSTLY
    )
    api = _proxied("~ ^/(api/|healthz|readyz)", "api", headers, scheme, to=web, again=again)
    of_uavs = _proxied("^~ /api/v1/uav-link/", "api", headers, scheme, to=uav_link, again=again)
    links = _proxied(
        "~ ^/(new-password|invitation|email-address|single-sign-on)/", "page", headers, scheme, to=web, faults="emerg", again=again
    )
    pages = _proxied("/", "page", headers, scheme, to=web, again=again)
    return f"""{"user root;" if os.geteuid() == 0 else ""}
daemon off;
pid {quoted(folder / "nginx.pid")};
error_log stderr warn;
worker_processes 1;
worker_rlimit_nofile {_file_limit()};
events {{
    worker_connections {_file_limit() - FILES_BESIDE};
}}
http {{
    types {{
{media_types}
    }}
    default_type application/octet-stream;
    charset utf-8;
    charset_types text/css text/plain text/javascript image/svg+xml;
{temporary}
    # A link to a new password, and an invitation, let their holder in, and another link verifies an address: no log has them, nor faults
    # of the application at them. Nor has it what stands behind a question mark.
    map $request $told_request {{
        "~^(?<told>[A-Z]+ /(new-password|invitation|email-address)/)" "$told...";
        "~^(?<asked>[^? ]+ [^? ]+)\\?" "$asked?...";
        default $request;
    }}
    # Bundles lie beside their Brotli form (config/page_bundles.py). Browsers accept it over https, and on the machine itself.
    map "$http_accept_encoding $uri" $bundle_in_brotli {{ "~\\bbr\\b.* /static/bundles/.+\\.(js|css)$" 1; default ""; }}
    map $upstream_http_x_request_id $told_id {{ "" "-"; default $upstream_http_x_request_id; }}
    {visitor}
{proxy_limits.zones()}
    log_format line {_line()};
    access_log /dev/stdout line buffer=32k flush=1s;
    server_tokens off;
    sendfile on;
    tcp_nopush on;
    client_max_body_size {MAX_BODY};
    client_body_buffer_size 256k;
    client_header_timeout 15s;
    client_body_timeout 15s;
    send_timeout 30s;
    reset_timedout_connection on;
    gzip on;
    gzip_proxied any;
    gzip_vary on;
    gzip_min_length 512;
    gzip_comp_level 2;
    gzip_types {COMPRESSED};
{upstreams(site)}
{certificates(site)}{came_over_http() if is_behind_https else ""}    map $http_upgrade $connection_upgrade {{
        "" close;
        default upgrade;
    }}
    server {{
{entrances(site)}        location = {ALIVE} {{ access_log off; return 204; }}
        location /static/ {{
            alias {quoted(f"{site.static}/")};
            add_header Cache-Control no-cache;
{headers}
        }}
        # A name that changes with the content: browsers keep such a file for a year and do not ask again.
        location ~ "^/static/(?<hashed>.+\\.[0-9a-f]{{12}}\\.[a-z0-9]+|bundles/.+)$" {{
            if ($bundle_in_brotli) {{ rewrite ^/static/(.+)\\.(js|css)$ /.brotli/$1.br.$2 last; }}
            alias "{quoted(site.static)[1:-1]}/$hashed";
            add_header Cache-Control "public, max-age=31536000, immutable";
{headers}
        }}
        location /.brotli/ {{
            internal;
            gzip off;
            alias {quoted(f"{site.static}/")};
            add_header Content-Encoding br;
            add_header Vary Accept-Encoding;
            add_header Cache-Control "public, max-age=31536000, immutable";
{headers}
        }}{pages}{plans}{of_uavs}{costly}{api}{links}{_websockets(scheme, to=live)}
{failures_as_sentences}
{failures_for_programs}{_too_many(headers)}
    }}{plain_server(site)}{beside}
}}
"""
