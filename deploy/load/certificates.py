"""A throw-away authority and a certificate of it for this machine's own names, by openssl as deploy/make-secrets makes them."""

import subprocess
from pathlib import Path

NAMES = "DNS:localhost,IP:127.0.0.1"
DAYS = "30"


def _openssl(*arguments: str, words: bytes = b"") -> None:
    subprocess.run(["openssl", *arguments], input=words, check=True, capture_output=True)


def _key(path: Path) -> None:
    path.touch(mode=0o600)
    _openssl("ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out", str(path))


def make_authority(folder: Path) -> Path:
    """The authority's certificate, ca.crt, which clients are told to trust; made once."""
    certificate, key = folder / "ca.crt", folder / "ca.key"
    if not certificate.exists():
        folder.mkdir(parents=True, exist_ok=True)
        _key(key)
        rights = ["-addext", "basicConstraints=critical,CA:TRUE", "-addext", "keyUsage=critical,keyCertSign,cRLSign"]
        _openssl("req", "-x509", "-new", "-key", str(key), "-days", DAYS, "-subj", "/CN=Load test", "-out", str(certificate), *rights)
    return certificate


def make_certificate(folder: Path, names: str = NAMES) -> tuple[Path, Path]:
    """A new certificate of the authority in this folder, and its key, put in place of those that may be there: tls.crt and tls.key."""
    certificate, key, request, rights = (folder / name for name in ("tls.crt", "tls.key", "tls.csr", "tls.extensions"))
    drafts = certificate.with_suffix(".crt.new"), key.with_suffix(".key.new")
    _key(drafts[1])
    _openssl("req", "-new", "-key", str(drafts[1]), "-subj", "/CN=localhost", "-out", str(request))
    rights.write_text(f"subjectAltName={names}\nextendedKeyUsage=serverAuth\nbasicConstraints=CA:FALSE\n")
    signing = ["-CA", str(folder / "ca.crt"), "-CAkey", str(folder / "ca.key"), "-CAcreateserial", "-days", DAYS]
    _openssl("x509", "-req", "-in", str(request), *signing, "-extfile", str(rights), "-out", str(drafts[0]))
    drafts[1].replace(key)
    drafts[0].replace(certificate)
    return certificate, key
