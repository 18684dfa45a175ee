"""Reasons: every code has a sentence in every language, and what is stored with one is read in the reader's language."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from django.utils.translation import override

from mavlink.commands.actions import Order
from mavlink.vehicle_class import VehicleClass, refusal_of
from mavlink.vehicle_plan import MissionType
from missions.models import CommandKind
from operation.reasons import SENTENCES, Reason, english, reason_from_json, register_sentences, text_reason
from simulation.flight.airframe import OwnAction
from simulation.serializers.words import reason_of
from workspace.reason_texts import column_text, reason_text, reasons_of_column, text_and_column

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("workspace", "inspection", "planning", "mavlink", "missions", "telemetry", "results", "simulation")
ALIKE = {"text", "kind_VTOL", "order_start", "command_pause"}  # a code whose German is its English
AWAY = Reason("stands_elsewhere", {"metres": 120, "allowed": 100})


def _of_all_params(code: str) -> Reason:
    sentence = SENTENCES[code]
    names = set(re.findall(r"%\((\w+)\)s", sentence if isinstance(sentence, str) else sentence[1]))
    params: dict[str, Any] = {name: 1.5 if name.endswith(("_m", "_km", "_wh")) else name for name in names}
    return Reason(code, params | ({} if isinstance(sentence, str) else {"count": 2}))


@pytest.mark.parametrize("code", SENTENCES)
def test_every_reason_comes_back_from_json_and_no_text_is_english_in_german(code: str) -> None:
    reason = _of_all_params(code)
    assert reason_from_json(reason.to_json()) == reason
    with override("de"):
        assert reason_text(reason) != str(reason) or code in ALIKE


def _codes_raised(path: Path) -> Iterator[str]:
    for call in ast.walk(ast.parse(path.read_text())):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in ("Reason", "_cannot") and call.args:
            code = call.args[1 if call.func.id == "_cannot" else 0]
            for part in (code.body, code.orelse) if isinstance(code, ast.IfExp) else (code,):
                if isinstance(part, ast.Constant):
                    yield part.value


@pytest.mark.parametrize("package", PACKAGES)
def test_every_code_of_the_source_has_a_sentence(package: str) -> None:
    raised = {code for path in (ROOT / package).rglob("*.py") for code in _codes_raised(path)}
    assert raised - set(SENTENCES) == set()


def test_the_codes_that_are_put_together_have_sentences() -> None:
    codes = {f"order_{order}" for order in Order} | {f"list_{kind.name.lower()}" for kind in MissionType}
    codes |= {f"command_{kind}" for kind in CommandKind}
    codes |= {refusal_of(kind).params["kind"].code for kind in VehicleClass}
    codes |= {f"{one}_{origin}" for one in ("item", "items") for origin in ("new", "before", "neither", "not_approved")}
    acts = [action for action in OwnAction if action is not OwnAction.NONE]
    codes |= {f"{what}_{action}" for what in ("battery_low", "battery_critical", "gps_lost") for action in acts}
    codes |= {f"{what}_{where}" for what in ("stands", "home") for where in ("elsewhere", "above", "below")}
    assert codes - set(SENTENCES) == set()


def test_a_code_has_one_sentence() -> None:
    with pytest.raises(ValueError, match="no_effect"):
        register_sentences({"no_effect": "Something else."})


def test_what_a_vehicle_says_itself_stays_as_it_is() -> None:
    order, step = Reason("order_take-off"), Reason("step_leave_ground")
    why = [Reason("order_not_done", {"order": order, "step": step}), Reason("no_effect"), text_reason("Compass not healthy")]
    assert english(why) == "Could not take-off, at leave the ground. The vehicle agreed, and nothing happened. Compass not healthy"
    text, column = text_and_column(why, 500)
    with override("de"):
        assert column_text(column, text) == (
            "„Abheben“ ging nicht, beim Schritt „vom Boden abheben“. Das Fahrzeug hat zugestimmt, und nichts ist geschehen."
            " Compass not healthy"
        )


def test_a_text_without_reasons_stays_as_it_is() -> None:
    text, column = text_and_column("PreArm: Need 3D Fix. Check it.", 500)
    with override("de"):
        assert (column, column_text(column, text)) == (None, "PreArm: Need 3D Fix. Check it.")
    assert text_and_column((), 500) == ("", None)


def test_reasons_count_no_more_once_the_version_before_has_written_another_text() -> None:
    text, column = text_and_column([AWAY], 500)
    assert reasons_of_column(column, text) == [AWAY.to_json()]
    assert reasons_of_column(column, "The vehicle did not do it.") == []


def test_a_code_of_a_newer_version_is_read_as_it_was_stored() -> None:
    column = {"text": "As it was stored.", "reasons": [AWAY.to_json(), {"code": "of_a_newer_version", "params": {}}]}
    with override("de"):
        assert column_text(column, "As it was stored.") == "As it was stored."


def test_a_figure_that_is_none_is_stored_as_text_and_others_are_written_as_the_reader_writes_them() -> None:
    kept = Reason("parameter_kept", {"parameter": "RTL_ALT", "value": 60.5})
    assert (str(kept), str(Reason("parameter_kept", {"parameter": "RTL_ALT", "value": 3_000.0}))) == (
        "RTL_ALT stays 60.5.",
        "RTL_ALT stays 3000.",
    )
    assert Reason("parameter_kept", {"value": float("nan")}).to_json()["params"]["value"] == "nan"
    with override("de"):
        assert "60,5" in reason_text(kept)


def test_why_a_rehearsed_uav_crashed_is_read_in_german() -> None:
    hit = Reason("hit_ground", {"speed": 7.3})
    finding = {"code": "crashed", "facts": {"name": "Kite", "said": str(hit), "said_why": hit.to_json()}}
    with override("de"):
        assert reason_of(finding, {}, {}).endswith("Es ist mit 7,3 m/s auf den Boden geschlagen.")
        assert reason_of({"code": "crashed", "facts": {"name": "Kite", "said": str(hit)}}, {}, {}).endswith(str(hit))
