"""The scripts that people and pipelines deploy with."""

import subprocess
from pathlib import Path

import yaml

from tests.deploy.conftest import DEPLOY, rendered

IMAGE = "registry.example.org/spanwise@sha256:" + "0" * 64


def test_a_roll_out_migrates_before_any_program_and_leaves_nothing_out() -> None:
    whole = rendered("production")
    done = subprocess.run([DEPLOY / "kubernetes" / "roll-out", "production", IMAGE, "--print"], capture_output=True, text=True, check=True)
    rolled = [document for document in yaml.safe_load_all(done.stdout) if document]
    kinds = [document["kind"] for document in rolled]
    assert len(rolled) == len(whole)
    assert kinds.index("Job") < kinds.index("Deployment")
    assert set(kinds[kinds.index("Deployment") :]) == {"Deployment"}
    images = {
        document["spec"]["template"]["spec"]["containers"][0]["image"] for document in rolled if document["kind"] in {"Deployment", "Job"}
    }
    assert images == {IMAGE}


def test_secrets_are_made_once_and_their_certificates_are_of_one_authority(tmp_path: Path) -> None:
    folder = tmp_path / "secrets"
    make = [DEPLOY / "make-secrets", "spanwise.example.org", folder]
    subprocess.run(make, check=True, capture_output=True)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    subprocess.run(make, check=True, capture_output=True)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    for server in ("postgresql", "redis"):
        verify = ["openssl", "verify", "-CAfile", folder / "ca.crt", "-verify_hostname", server, folder / f"{server}.crt"]
        subprocess.run(verify, check=True, capture_output=True)
    assert (folder / "database-password").read_text().strip() in (folder / "database-url").read_text()
    assert "sslmode=verify-full" in (folder / "database-url").read_text()
    assert (folder / "secret-key").stat().st_mode & 0o007 == 0
