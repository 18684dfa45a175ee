"""What the shipped Kubernetes objects promise, read off the rendered overlays."""

import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from scripts.container import container
from scripts.places import Places
from scripts.supervision.programs import web_programs
from tests.deploy.conftest import DEPLOY, rendered

Objects = tuple[dict[str, Any], ...]
DOCUMENTATION = DEPLOY.parent / "docs" / "deployment.md"
NEEDS_NO_DATABASE = {"proxy", "redis"}


def of_kind(objects: Objects, kind: str) -> dict[str, dict[str, Any]]:
    return {one["metadata"]["name"]: one for one in objects if one["kind"] == kind}


def pods(objects: Objects) -> dict[str, dict[str, Any]]:
    """Every pod's template by the name of what makes it."""
    return {
        name: one["spec"]["template"]["spec"]
        for kind in ("Deployment", "StatefulSet", "Job")
        for name, one in of_kind(objects, kind).items()
    }


def programs_of_one_machine() -> set[str]:
    """What ./run starts; its two web programs are one Deployment's replicas."""
    names = {program.name for program in web_programs(Places(Path("/nowhere")), Path("/nowhere"))}
    return {re.sub(r"-\d$", "", name) for name in names}


def test_every_program_of_one_machine_has_a_deployment(objects: Objects) -> None:
    assert set(of_kind(objects, "Deployment")) - {"redis"} == programs_of_one_machine()


def test_every_deployment_starts_a_program_that_the_image_knows(objects: Objects) -> None:
    for name, pod in pods(objects).items():
        if name in {"redis", "postgresql"}:
            continue
        assert pod["containers"][0]["args"] == [name]
        assert name in {*container.PROGRAMS, "proxy"}


def test_no_program_is_asked_for_the_database_to_prove_that_it_lives(objects: Objects) -> None:
    for name, one in of_kind(objects, "Deployment").items():
        probes = one["spec"]["template"]["spec"]["containers"][0]
        assert {"startupProbe", "livenessProbe", "readinessProbe"} <= set(probes), name
        if name not in NEEDS_NO_DATABASE:
            assert probes["livenessProbe"]["httpGet"]["path"] == "/healthz", name
            assert probes["readinessProbe"]["httpGet"]["path"] == "/readyz", name


def test_every_container_has_requests_limits_and_no_rights(objects: Objects) -> None:
    for name, pod in pods(objects).items():
        assert pod["automountServiceAccountToken"] is False, name
        assert pod["serviceAccountName"] == name
        assert pod["securityContext"]["runAsNonRoot"], name
        assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}, name
        for one in pod["containers"]:
            assert set(one["resources"]) == {"requests", "limits"}, name
            assert {"cpu", "memory"} == set(one["resources"]["limits"]) == set(one["resources"]["requests"]), name
            rights = one["securityContext"]
            assert rights["readOnlyRootFilesystem"], name
            assert not rights["allowPrivilegeEscalation"], name
            assert rights["capabilities"] == {"drop": ["ALL"]}, name


def test_no_role_is_given_to_anybody(objects: Objects) -> None:
    kinds = {one["kind"] for one in objects}
    assert not kinds & {"Role", "ClusterRole", "RoleBinding", "ClusterRoleBinding"}
    assert all(one["automountServiceAccountToken"] is False for one in of_kind(objects, "ServiceAccount").values())


def test_every_deployment_outlives_a_node(objects: Objects) -> None:
    for name, one in of_kind(objects, "Deployment").items():
        if name == "redis":
            continue
        pod = one["spec"]["template"]["spec"]
        assert pod["topologySpreadConstraints"][0]["topologyKey"] == "kubernetes.io/hostname", name
        seconds = {entry["tolerationSeconds"] for entry in pod["tolerations"] if entry["effect"] == "NoExecute"}
        assert len(seconds) == 1
        assert seconds.pop() <= 30, name
        budget = of_kind(objects, "PodDisruptionBudget")[name]
        assert budget["spec"]["selector"]["matchLabels"] == one["spec"]["selector"]["matchLabels"], name


def test_every_program_but_the_schedule_has_an_autoscaler() -> None:
    for overlay in ("production", "production-keda"):
        objects = rendered(overlay)
        scaled = {
            one["spec"]["scaleTargetRef"]["name"]
            for kind in ("HorizontalPodAutoscaler", "ScaledObject")
            for one in of_kind(objects, kind).values()
        }
        assert scaled == set(of_kind(objects, "Deployment")) - {"beat"}
        assert not set(of_kind(objects, "HorizontalPodAutoscaler")) & set(of_kind(objects, "ScaledObject")), overlay


def test_what_is_scaled_says_no_number_of_replicas_of_its_own(objects: Objects) -> None:
    for name in of_kind(objects, "HorizontalPodAutoscaler"):
        assert "replicas" not in of_kind(objects, "Deployment")[name]["spec"], name


def test_what_a_deployment_names_is_there(objects: Objects) -> None:
    """Settings and claims by their names, ports by theirs; the secrets are the site's."""
    settings, claims = set(of_kind(objects, "ConfigMap")), set(of_kind(objects, "PersistentVolumeClaim"))
    for name, pod in pods(objects).items():
        one = pod["containers"][0]
        assert {entry["configMapRef"]["name"] for entry in one.get("envFrom", [])} <= settings, name
        assert {volume["persistentVolumeClaim"]["claimName"] for volume in pod["volumes"] if "persistentVolumeClaim" in volume} <= claims
        volumes = {volume["name"] for volume in pod["volumes"]}
        if name != "postgresql":  # whose disk is its own claim
            assert {mount["name"] for mount in one["volumeMounts"]} <= volumes, name
        ports = {port["name"] for port in one.get("ports", [])}
        for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
            asked = one.get(probe, {}).get("httpGet", one.get(probe, {}).get("tcpSocket"))
            assert asked is None or asked["port"] in ports, (name, probe)


def test_services_lead_to_ports_of_pods_that_there_are(objects: Objects) -> None:
    templates = [one["spec"]["template"] for kind in ("Deployment", "StatefulSet") for one in of_kind(objects, kind).values()]
    for name, service in of_kind(objects, "Service").items():
        chosen = [one for one in templates if service["spec"]["selector"].items() <= one["metadata"]["labels"].items()]
        assert len(chosen) == 1, name
        ports = {port["name"] for port in chosen[0]["spec"]["containers"][0]["ports"]}
        assert {port["targetPort"] for port in service["spec"]["ports"]} <= ports, name


def documented_arrows() -> set[str]:
    """The first column of the table of arrows."""
    text = DOCUMENTATION.read_text()
    table = text.partition("<!-- arrows -->")[2].partition("<!-- end -->")[0]
    return set(re.findall(r"^\| `([a-z-]+)`", table, re.MULTILINE))


def test_every_allowed_arrow_is_in_the_documentation_and_the_other_way_round() -> None:
    arrows = {name for overlay in ("small", "production-keda") for name in of_kind(rendered(overlay), "NetworkPolicy")}
    assert arrows == documented_arrows()


def test_nothing_is_reached_that_no_arrow_allows(objects: Objects) -> None:
    closed = of_kind(objects, "NetworkPolicy")["default-deny"]["spec"]
    assert closed == {"podSelector": {}, "policyTypes": ["Ingress", "Egress"]}


def test_every_program_that_works_on_the_database_may_reach_it_and_no_other_may(objects: Objects) -> None:
    needs = {
        name
        for name, pod in pods(objects).items()
        if any(entry["name"] == "DATABASE_URL_FILE" for entry in pod["containers"][0].get("env", []))
    }
    for policy in ("programs-to-postgresql", "programs-to-redis"):
        selector = of_kind(objects, "NetworkPolicy")[policy]["spec"]["podSelector"]["matchExpressions"][0]
        assert set(selector["values"]) == needs


def test_names_that_programs_are_told_are_services(objects: Objects) -> None:
    (settings,) = [one["data"] for name, one in of_kind(objects, "ConfigMap").items() if name.startswith("settings")]
    for value in settings.values():
        for name in re.findall(r"([a-z-]+)\.spanwise\.svc\.cluster\.local", value):
            assert name in of_kind(objects, "Service")


@pytest.mark.parametrize("overlay", ["production", "production-keda"])
def test_programs_behind_the_proxy_are_certified_by_the_names_that_it_asks_for(overlay: str) -> None:
    objects = rendered(overlay)
    (settings,) = [one["data"] for name, one in of_kind(objects, "ConfigMap").items() if name.startswith("settings")]
    certificates = {one["spec"]["secretName"]: one["spec"] for one in of_kind(objects, "Certificate").values()}
    for name in ("web", "live"):
        secrets = [volume["secret"]["secretName"] for volume in pods(objects)[name]["volumes"] if volume["name"] == "inner"]
        (certificate,) = [certificates[secret] for secret in secrets]
        assert certificate["issuerRef"]["name"] == "internal"
        assert certificate["dnsNames"] == [settings[f"SPANWISE_PROXY_{name.upper()}"].rpartition(":")[0]]
        assert pods(objects)[name]["containers"][0]["startupProbe"]["httpGet"]["scheme"] == "HTTPS"
    proxy = pods(objects)["proxy"]["containers"][0]
    assert {"name": "SPANWISE_PROXY_TRUST", "value": "/run/trust/ca.crt"} in proxy["env"]


def test_settings_that_pods_are_given_are_described(objects: Objects) -> None:
    described = DOCUMENTATION.read_text() + (DEPLOY.parent / "docs" / "operations.md").read_text()
    (settings,) = [one["data"] for name, one in of_kind(objects, "ConfigMap").items() if name.startswith("settings")]
    assert [name for name in settings if f"`{name}`" not in described] == []


def test_objects_of_other_makers_fit_what_is_known_of_them(objects: Objects) -> None:
    """kubernetes-validate knows none of them: a small schema of our own for each kind."""
    schemas = yaml.safe_load((DEPLOY / "kubernetes" / "schemas" / "other-kinds.yaml").read_text())
    others = [
        one for one in objects if "." in one["apiVersion"].partition("/")[0] and not one["apiVersion"].partition("/")[0].endswith("k8s.io")
    ]
    assert others
    for one in others:
        jsonschema.validate(one, schemas[one["kind"]])


@pytest.mark.parametrize("wrong", [{"triggers": []}, {"scaleTargetRef": {}}, {"minReplicas": 1}])
def test_the_schemas_of_other_makers_refuse_what_is_misspelt(wrong: dict[str, Any]) -> None:
    schemas = yaml.safe_load((DEPLOY / "kubernetes" / "schemas" / "other-kinds.yaml").read_text())
    one = of_kind(rendered("production-keda"), "ScaledObject")["worker-data"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**one, "spec": {**one["spec"], **wrong}}, schemas["ScaledObject"])
