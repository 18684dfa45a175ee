"""OpenID Connect: the requests to the identity provider, and the checks of what it answers.

The check of the ID token follows OpenID Connect Core 1.0, 3.1.3.7, with the signature, which django-allauth leaves out for tokens that it
has fetched itself.
"""

import base64
import http.client
import json
import time
import urllib.error
import urllib.request
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any
from urllib.parse import quote_plus, urlencode, urlsplit

import jwt
from django.conf import settings
from django.utils.crypto import constant_time_compare

from accounts.identity_claims import IdentityProvider, is_secure, merged

ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA")  # never `none`, never a shared key
REQUIRED_CLAIMS = ["iss", "sub", "aud", "exp", "iat"]
LEEWAY_S = 60  # difference of the clocks
TIMEOUT_S = 5.0  # of silence
TOTAL_S = 15.0  # of one answer
MAX_ANSWER_BYTES = 512 * 1024
CACHED_S = 10 * 60  # discovery document and keys
REFETCH_INTERVAL_S = 5  # an unknown key makes the keys be fetched again, no more often than this
MAX_SUBJECT_LENGTH = 191  # of the column
_ENDPOINTS = ("authorization_endpoint", "token_endpoint", "jwks_uri")


class ProviderUnavailable(Exception):
    """Raised where the provider does not answer, or answers with an error of its own."""


class WrongAnswer(Exception):
    """Raised for an answer that may not be trusted. The message says why, for the log; it holds no token."""


@dataclass(frozen=True)
class _Fetched:
    document: dict[str, Any]
    at_s: float  # monotonic


class _Documents:
    """The provider's documents, kept for some minutes in the process."""

    def __init__(self) -> None:
        self._kept: dict[str, _Fetched] = {}
        self._lock = Lock()

    def get(self, address: str, *, max_age_s: float = CACHED_S) -> dict[str, Any]:
        """Return a document that was fetched within max_age_s. While the provider is unavailable an older one is not used."""
        with self._lock:
            kept = self._kept.get(address)
        if kept is not None and time.monotonic() - kept.at_s < max_age_s:
            return kept.document
        document = _ask(address)
        with self._lock:
            self._kept[address] = _Fetched(document, time.monotonic())
        return document

    def clear(self) -> None:
        with self._lock:
            self._kept.clear()


documents = _Documents()


def identity_provider() -> IdentityProvider | None:
    """Return the provider that the settings name."""
    return settings.IDENTITY_PROVIDER


def authorization_address(
    provider: IdentityProvider, *, redirect: str, state: str, nonce: str, challenge: str, more: Mapping[str, str]
) -> str:
    """Return where the browser signs in. Raises ProviderUnavailable, WrongAnswer."""
    asked = {
        "response_type": "code", "client_id": provider.client_id, "redirect_uri": redirect, "scope": " ".join(provider.scopes),
        "state": state, "nonce": nonce, "code_challenge": challenge, "code_challenge_method": "S256",
    } | {**more}  # fmt: skip
    address = _discovered(provider)["authorization_endpoint"]
    return f"{address}{'&' if '?' in address else '?'}{urlencode(asked)}"


def claims_of_code(provider: IdentityProvider, *, code: str, redirect: str, verifier: str, nonce: str) -> dict[str, Any]:
    """Exchange the code and return the checked claims about the user. Raises ProviderUnavailable, WrongAnswer."""
    known = _discovered(provider)
    form = {"grant_type": "authorization_code", "code": code, "redirect_uri": redirect, "code_verifier": verifier}
    headers = {}
    if "client_secret_post" in (known.get("token_endpoint_auth_methods_supported") or ()):
        form |= {"client_id": provider.client_id, "client_secret": provider.client_secret}
    else:  # the standard's default; both parts are encoded as in a form: RFC 6749, 2.3.1
        pair = f"{quote_plus(provider.client_id)}:{quote_plus(provider.client_secret)}"
        headers["Authorization"] = f"Basic {base64.b64encode(pair.encode()).decode()}"
    answer = _ask(known["token_endpoint"], form=form, headers=headers)
    id_token = _checked_id_token(provider, known, answer.get("id_token"), nonce)
    userinfo = _userinfo(known, answer.get("access_token"))
    if userinfo and userinfo.get("sub") != id_token["sub"]:
        raise WrongAnswer("the subject of userinfo is not that of the ID token")
    return merged(id_token, userinfo)


def _checked_id_token(provider: IdentityProvider, known: Mapping[str, Any], token: Any, nonce: str) -> dict[str, Any]:
    if not isinstance(token, str):
        raise WrongAnswer("there is no ID token")
    try:
        header = jwt.get_unverified_header(token)
        algorithm = header.get("alg")
        if algorithm not in ALGORITHMS:
            raise WrongAnswer(f"the ID token is signed with {str(algorithm)[:20]!r}")
        claims: dict[str, Any] = jwt.decode(
            token, _key(known["jwks_uri"], header), algorithms=[algorithm], audience=provider.client_id, issuer=provider.issuer,
            leeway=LEEWAY_S, options={"require": REQUIRED_CLAIMS, "enforce_minimum_key_length": True},
        )  # fmt: skip
    except (jwt.PyJWTError, TypeError, ValueError) as error:
        raise WrongAnswer(f"the ID token is not valid: {error}") from error
    if not (isinstance(claims.get("nonce"), str) and constant_time_compare(claims["nonce"], nonce)):
        raise WrongAnswer("the nonce of the ID token is not that of this sign-in")
    has_several_audiences = isinstance(claims["aud"], list) and len(claims["aud"]) > 1
    if ("azp" in claims or has_several_audiences) and claims.get("azp") != provider.client_id:
        raise WrongAnswer("the ID token was made for another client")
    if not claims["sub"] or len(claims["sub"]) > MAX_SUBJECT_LENGTH:
        raise WrongAnswer("the subject is empty or too long")
    return claims


def _key(address: str, header: Mapping[str, Any]) -> Any:
    """Return the public key of a token's header. An unknown one makes the keys be fetched again: the provider may have changed them."""
    for max_age_s in (CACHED_S, REFETCH_INTERVAL_S):
        keys = documents.get(address, max_age_s=max_age_s).get("keys")
        fitting = [key for key in keys if _fits(key, header)] if isinstance(keys, list) else []
        if len(fitting) == 1:
            return jwt.PyJWK(fitting[0], algorithm=header["alg"]).key
    raise WrongAnswer("the ID token is signed with an unknown key")


def _fits(key: Any, header: Mapping[str, Any]) -> bool:
    """Whether a key of the set may have signed. A token without the key's id fits where the set has one such key only."""
    kinds = {"R": "RSA", "P": "RSA", "E": "EC"}
    return (
        isinstance(key, dict)
        and key.get("use", "sig") == "sig"
        and key.get("alg", header["alg"]) == header["alg"]
        and key.get("kty") == ("OKP" if header["alg"] == "EdDSA" else kinds[header["alg"][0]])
        and ("kid" not in header or key.get("kid") == header["kid"])
    )


def _userinfo(known: Mapping[str, Any], access_token: Any) -> dict[str, Any]:
    address = known.get("userinfo_endpoint")
    if not address or not isinstance(access_token, str):
        return {}
    return _ask(_secure(address), headers={"Authorization": f"Bearer {access_token}"})


def _discovered(provider: IdentityProvider) -> dict[str, Any]:
    known = documents.get(f"{provider.issuer.rstrip('/')}/.well-known/openid-configuration")
    if known.get("issuer") != provider.issuer:
        raise WrongAnswer(f"the discovery document is of the issuer {str(known.get('issuer'))[:200]!r}")
    for name in _ENDPOINTS:
        _secure(known.get(name))
    return known


def _secure(address: Any) -> str:
    """Return an address that leads over TLS, or to this machine. Raises WrongAnswer."""
    if isinstance(address, str) and is_secure(address):
        return address
    raise WrongAnswer("the discovery document names an address without https://")


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """A redirect could carry the client's secret elsewhere; none of these addresses needs one."""

    def redirect_request(self, *_args: Any, **_facts: Any) -> None:
        return None


def _ask(address: str, *, form: Mapping[str, str] | None = None, headers: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return the JSON object that an address answers. Raises ProviderUnavailable, and WrongAnswer for refusals and for anything else."""
    sent = {"Accept": "application/json", "User-Agent": "Spanwise", **(headers or {})}
    request = urllib.request.Request(address, data=urlencode(form).encode() if form else None, headers=sent)  # noqa: S310 - see _secure
    ends_at = time.monotonic() + TOTAL_S
    content = b""
    try:
        with urllib.request.build_opener(_NoRedirects).open(request, timeout=TIMEOUT_S) as answer:
            while block := answer.read1(65_536):
                content += block
                if len(content) > MAX_ANSWER_BYTES or time.monotonic() > ends_at:
                    raise ProviderUnavailable(f"{urlsplit(address).hostname} answers too much or too slowly")
    except urllib.error.HTTPError as error:
        error.close()
        kind = WrongAnswer if error.code < 500 and form else ProviderUnavailable
        raise kind(f"{urlsplit(address).hostname} answers {error.code}") from error
    except (OSError, http.client.HTTPException) as error:
        raise ProviderUnavailable(f"{urlsplit(address).hostname} does not answer: {type(error).__name__}") from error
    try:
        document = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise WrongAnswer(f"{urlsplit(address).hostname} answers no JSON") from error
    if not isinstance(document, dict):
        raise WrongAnswer(f"{urlsplit(address).hostname} answers no JSON object")
    return document
