"""Addresses of one nginx and of the programs behind it: sockets on one machine, names in containers."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path

from scripts.places import CannotStart

ALIVE = "/proxy-alive"  # nginx itself responds
TLS_1_2_CIPHERS = (
    "ECDHE-ECDSA-AES128-GCM-SHA256:ECDHE-RSA-AES128-GCM-SHA256:ECDHE-ECDSA-AES256-GCM-SHA384:ECDHE-RSA-AES256-GCM-SHA384:"
    "ECDHE-ECDSA-CHACHA20-POLY1305:ECDHE-RSA-CHACHA20-POLY1305"
)
FOR_PROGRAMS = "~^/(api/v[0-9]+|ws)/"  # not redirected from http to https: an earlier leak of secrets would go unnoticed


def error_json(status: int, code: str, message: str) -> str:
    """Return nginx's own error in the shape of workspace.api.errors.error_body."""
    problem = {"type": f"urn:problem-type:spanwise:{code}", "title": HTTPStatus(status).phrase, "status": status, "detail": message}
    return json.dumps({"error": {"code": code, "message": message, "details": None}, **problem})


REFUSAL = error_json(
    403,
    "https_required",
    "Programs are answered over https alone. What was sent here could be read on its way: a token that was in it is to be revoked.",
)
KEPT = 1_024  # idle connections to web: as many as may be busy under high load
BACKLOG = 4_096  # connections waiting to be accepted; the default limit of Linux (net.core.somaxconn)


@dataclass(frozen=True)
class Site:
    """The programs behind one nginx.

    `web`, `live` and `uav_link` are addresses as nginx writes them (unix:/path.sock, host:port). With a `resolver` (its address) each is
    one name, resolved every two seconds to any number of programs. Without a certificate and with `is_behind_https` a proxy in front
    terminates TLS, and reports it in a header.
    """

    folder: Path
    static: Path
    web: tuple[str, ...]
    live: tuple[str, ...]
    listens_at: str
    is_behind_https: bool = False
    certificate: Path | None = None
    key: Path | None = None
    listens_at_tls: str = ""
    resolver: str = ""
    uav_link: tuple[str, ...] = ()  # the programs for UAVs; by default web
    trust: Path | None = None  # the internal authority: with it the programs are reached only by TLS, each by its own name

    @property
    def for_uavs(self) -> tuple[str, ...]:
        return self.uav_link or self.web

    @property
    def is_https(self) -> bool:
        return self.is_behind_https or self.certificate is not None


def quoted(path: object) -> str:
    """Return a path quoted for nginx; spaces are allowed, a dollar sign would be a variable."""
    text = str(path)
    if set(text) & set('"\\$\n'):
        raise CannotStart(f"nginx cannot be given the path {text!r}: it holds a quotation mark, a backslash or a dollar sign")
    return f'"{text}"'


def upstreams(site: Site) -> str:
    """Return the upstream groups with keep-alive connections; resolved names have no groups."""
    if site.resolver:
        return f"    resolver {site.resolver} valid=2s;\n    resolver_timeout 2s;"

    def servers(addresses: Iterable[str], *, mark: str = "") -> str:
        return "\n".join(f"        server {quoted(address)} max_fails=0{mark};" for address in addresses)

    instead = servers(site.web, mark=" backup") if site.uav_link else ""  # web serves UAVs while their program starts

    return f"""    upstream web {{
        least_conn;
{servers(site.web)}
        keepalive {KEPT};
    }}
    upstream live {{
{servers(site.live)}
    }}
    upstream uav_link {{
{servers(site.for_uavs)}
{instead}
        keepalive {KEPT};
    }}"""


def certificates(site: Site) -> str:
    """Return variables with the certificate's paths: nginx reads such files at each handshake, so a new one needs no reload."""
    if site.certificate is None:
        return ""
    return f"""    map $ssl_server_name $served_certificate {{ default {quoted(site.certificate)}; }}
    map $ssl_server_name $served_key {{ default {quoted(site.key)}; }}
"""


def upstream_scheme(site: Site, addresses: tuple[str, ...]) -> tuple[str, str]:
    """Return the scheme of the programs at these addresses, and nginx's TLS directives."""
    if site.trust is None:
        return "http", ""
    name = addresses[0].rpartition(":")[0]
    return (
        "https",
        f"""
            proxy_ssl_verify on;
            proxy_ssl_trusted_certificate {quoted(site.trust)};
            proxy_ssl_name {name};
            proxy_ssl_server_name on;
            proxy_ssl_protocols TLSv1.3;""",
    )


def entrances(site: Site) -> str:
    """Return the listen directives; with a certificate the plain port redirects to the TLS port."""
    plain = f"listen {site.listens_at} backlog={BACKLOG};"
    names = (
        f"        set $web {site.web[0]};\n        set $live {site.live[0]};\n        set $uav_link {site.for_uavs[0]};\n"
        if site.resolver
        else ""
    )
    if site.certificate is None:
        # The proxy that terminates TLS reports the client's scheme; a request without the header comes from inside.
        led = refused_or_led() if site.is_behind_https else ""
        return f"        {plain}\n{led}{names}"
    return f"""        listen {site.listens_at_tls} ssl http2 backlog={BACKLOG};
        ssl_certificate $served_certificate;
        ssl_certificate_key $served_key;
        ssl_protocols TLSv1.2 TLSv1.3;
        ssl_ciphers {TLS_1_2_CIPHERS};
        ssl_prefer_server_ciphers off;
        ssl_session_cache shared:tls:10m;
        ssl_session_timeout 1d;
        ssl_session_tickets off;
{names}"""


def came_over_http() -> str:
    """Return a variable: the treatment of a request whose client came without TLS, as reported by the proxy in front."""
    return f"""    map $uri $without_tls {{ "{FOR_PROGRAMS}" refused; default led; }}
    map $http_x_forwarded_proto $over_http {{ "http" $without_tls; default ""; }}
"""


def refused_or_led() -> str:
    """Return the rules: pages are redirected to https, requests of programs are refused."""
    return f"""        if ($over_http = led) {{ return 308 https://$host$request_uri; }}
        if ($over_http = refused) {{ rewrite ^ /.over-http last; }}
        location = /.over-http {{ internal; default_type application/json; return 403 '{REFUSAL}'; }}
"""


def plain_server(site: Site) -> str:
    """Return the server for the port without TLS: redirects, and a response for health checks of the proxy."""
    if site.certificate is None:
        return ""
    return f"""
    server {{
        listen {site.listens_at} backlog={BACKLOG};
        location = {ALIVE} {{ access_log off; return 204; }}
        location {FOR_PROGRAMS.replace("~", "~ ")} {{ default_type application/json; return 403 '{REFUSAL}'; }}
        location / {{ return 308 https://$host$request_uri; }}
    }}"""
