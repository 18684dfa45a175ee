/** A no-fly zone for some hours from now, drawn on the mission's map: a freehand line round it, or a circle round a place. */

import { ApiError, freshKey, post } from "../../api.js";
import { h, setChildren } from "../../dom.js";
import { simplified } from "../../domain/geodesy.js";
import { shapeOf } from "../../draw/shape.js";
import { faultsOf } from "../../draw/validity.js";
import { numberField } from "../../page/fields.js";
import { open } from "../../page/keyboard.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { clockText } from "../../units.js";
import { zoneForm } from "../../zones/form.js";

/** @import { Position } from "../../map/types.d.ts" */

const [USUAL_HOURS, MAX_HOURS] = [2, 72];
const [USUAL_RADIUS_M, MAX_RADIUS_M] = [200, 20_000];
const WHOLE = { required: true, min: 1, step: 1 };
const ROUGH = 0.01; // of the drawn line, as a share of its extent

/** @typedef {{ ring: Position[] } | { centre: Position }} Drawn */

/** The period from a moment on. @param {number} from_ms @param {number} hours */
export const periodOf = (from_ms, hours) => ({
  startDateTime: new Date(from_ms).toISOString(),
  endDateTime: new Date(from_ms + hours * 3_600_000).toISOString(),
  schedule: [],
});

/**
 * The area of a freehand line, with few corners; a fault in words where it has one.
 *
 * @param {Position[]} ring
 */
export function areaOf(ring) {
  const corners = simplified(ring, ROUGH).map((position) => position.map((degrees) => Number(degrees.toFixed(6))));
  const geometry = { type: /** @type {"Polygon"} */ ("Polygon"), coordinates: [[...corners, corners[0]]] };
  const fault = corners.length < 3 ? t("An area needs three points.") : faultsOf(shapeOf(geometry)).at(0)?.message;
  return { geometry, fault: fault ?? "" };
}

/** Asks for its facts and stores it. @param {Drawn} drawn @param {{ closed: () => void }} on */
export function askForZone(drawn, { closed }) {
  const area = "ring" in drawn ? areaOf(drawn.ring) : null;
  if (area?.fault) return toast(t("{why} Draw it again.", { why: area.fault }));
  const hours = numberField("hours", t("Applies from now for"), USUAL_HOURS, {
    ...WHOLE,
    unit: "h",
    max: MAX_HOURS,
  });
  const radius = area
    ? null
    : numberField("radius_m", t("Radius"), USUAL_RADIUS_M, { ...WHOLE, unit: "m", max: MAX_RADIUS_M });
  const times = { element: hours.element, read: () => [periodOf(Date.now(), hours.read() ?? USUAL_HOURS)] };
  const kept = { name: t("Temporary zone"), restriction: "PROHIBITED" };
  const { element: form, read } = zoneForm(null, "", kept, times);
  const wrong = h("p", { class: "field-error", role: "alert" });
  const go = h("button", { class: "button primary" }, t("Add the zone"));
  const dialog = h(
    "dialog",
    { "aria-labelledby": "temporary-zone-title" },
    h("h2", { id: "temporary-zone-title" }, t("Temporary no-fly zone")),
    form,
  );
  const cancel = h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel"));
  form.prepend(
    h("p", { class: "quiet-text" }, t("It counts for all missions; plans that it touches become outdated.")),
  );
  if (radius) form.append(radius.element);
  form.append(wrong, h("div", { class: "acts" }, cancel, go));
  const key = freshKey();

  form.addEventListener("submit", async () => {
    const facts = read();
    const shape = area
      ? { geometry: area.geometry }
      : { circle: { centre: "centre" in drawn ? drawn.centre : [], radius_m: radius?.read() } };
    go.setAttribute("aria-busy", "true");
    try {
      await post("/zones", { ...facts, ...shape }, { headers: { "Idempotency-Key": key } });
      const [{ endDateTime }] = times.read();
      dialog.close();
      toast(t("“{name}” applies until {time}.", { name: String(facts.name), time: clockText(endDateTime) }));
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      setChildren(wrong, error.details?.message ?? error.message);
    } finally {
      go.removeAttribute("aria-busy");
    }
  });
  dialog.addEventListener("close", closed);
  open(dialog);
  const name = form.querySelector("input");
  name?.select();
}
