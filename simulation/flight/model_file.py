"""A JSBSim model file as a flight model that can be stepped: loaded quietly, with its mixer worked out from where its rotors are."""

from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import jsbsim
import numpy as np

MODELS = Path(__file__).resolve().parent.parent / "aircraft_models"
ROTORS = 4
AXES = ("thrust", "roll", "pitch", "yaw")


def flight_model(code: str, step_s: float, seed: int) -> jsbsim.FGFDMExec:
    """The model of an airframe, not yet placed anywhere. Raises ValueError where its file cannot be loaded."""
    jsbsim.set_logger(jsbsim.DefaultLogger(jsbsim.LogLevel.ERROR))
    model = jsbsim.FGFDMExec(str(MODELS))
    model.set_debug_level(0)
    model.set_aircraft_path(str(MODELS))
    model.set_systems_path(str(MODELS / "systems"))
    model.set_dt(step_s)  # before the model is loaded: its filters and integrals take the step that is set then
    if not model.load_model(code):
        raise ValueError(f"The airframe {code!r} has no model file that can be loaded.")
    model["simulation/randomseed"] = seed % 2**31
    for axis, row in zip(AXES, mixer_of(code), strict=True):
        for number, share in enumerate(row, start=1):
            model[f"mixer/{axis}-{number}"] = share
    return model


@lru_cache
def mixer_of(code: str) -> tuple[tuple[float, ...], ...]:
    """Thrust of each rotor [N] for a newton of thrust, and for a newton metre about each axis: (axes, rotors).

    The inverse of what the rotors do where the model file puts them.
    """
    root = ElementTree.parse(MODELS / code / f"{code}.xml").getroot()  # noqa: S314 - our own file
    figures = {(node.text or "").strip(): node.get("value") for node in root.findall("./system/property")}
    reaction_m = float(figures.get("figure/moment-m") or "nan")
    turning = root.find("./external_reactions/moment/function/product/difference")
    if turning is None:
        raise ValueError(f"The airframe {code!r} has no reaction of its rotors.")
    clockwise = {(node.text or "").strip() for node in turning[1].iter("property")}
    effects = []
    for number in range(1, ROTORS + 1):
        place = root.find(f"./external_reactions/force[@name='rotor-{number}']/location")
        if place is None:
            raise ValueError(f"The airframe {code!r} has no rotor {number}.")
        forward_m, right_m = -float(place.findtext("x", "nan")), float(place.findtext("y", "nan"))
        sign = -1.0 if f"rotor/thrust-{number}-n" in clockwise else 1.0
        effects.append((1.0, -right_m, forward_m, sign * reaction_m))
    inverse = np.linalg.inv(np.array(effects).T)
    if not np.isfinite(inverse).all():
        raise ValueError(f"The rotors of the airframe {code!r} cannot turn it.")
    return tuple(tuple(float(share) for share in inverse[:, axis]) for axis in range(len(AXES)))
