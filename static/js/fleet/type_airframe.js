/** Which simulated airframe flies for a type's UAVs: in rehearsals, and where they are stood in for. */

import { get, put } from "../api.js";
import { h } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { durationText, speedText } from "../units.js";
import { kilograms, wattHours } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { Airframe, AirframeList, TypeAirframe } from "../api_types.d.ts" */
/** @import { FleetType } from "./types.d.ts" */

/** @param {Airframe} airframe */
const wordsOf = ({ mass_kg, battery_wh, hover_min, max_airspeed_mps }) =>
  [
    kilograms(mass_kg),
    wattHours(battery_wh),
    t("hovers {time}", { time: durationText(hover_min * 60) }),
    t("up to {speed}", { speed: speedText(max_airspeed_mps) }),
  ].join(" · ");

/**
 * Draws itself into `place`. Rejects with ApiError, and calls failed(it) where one comes later.
 *
 * @param {HTMLElement} place
 * @param {FleetType} type
 * @param {{ canPlan: boolean, failed: (error: unknown) => void }} how
 */
export async function mountTypeAirframe(place, type, { canPlan, failed }) {
  const address = `/uav-types/${type.id}/airframe`;
  const [{ data: known }, { data }] = /** @type {[Answer<AirframeList>, Answer<TypeAirframe>]} */ (
    await Promise.all([get("/airframes"), get(address)])
  );
  const airframes = new Map(known.results.map((airframe) => [airframe.code, airframe]));

  const facts = h("p", { class: "caption" });
  const choice = h(
    "select",
    { class: "input", id: "type-airframe" },
    h("option", { value: "" }, t("The nearest by mass and endurance")),
    known.results.map(({ code, name }) => h("option", { value: code }, name)),
  );

  /** @param {TypeAirframe} chosen */
  function draw({ airframe, flown }) {
    const flies = airframes.get(flown);
    choice.value = airframe ?? "";
    facts.textContent = flies ? `${flies.name}: ${wordsOf(flies)}` : flown;
  }

  async function choose() {
    try {
      const { data: stored } = /** @type {Answer<TypeAirframe>} */ (
        await put(address, { airframe: choice.value || null })
      );
      draw(stored);
      toast(
        t(
          "In simulation {airframe} flies for {name}. Rehearsals of its missions are out of date if another one flew.",
          { airframe: airframes.get(stored.flown)?.name, name: type.name },
        ),
      );
    } catch (error) {
      draw(data);
      failed(error);
    }
  }

  choice.disabled = !canPlan;
  choice.addEventListener("change", () => void choose());
  place.replaceChildren(
    h("div", { class: "field" }, h("label", { for: choice.id }, t("Simulated airframe")), choice),
    facts,
    h("p", { class: "quiet-text" }, t("It flies with the battery of the UAV where that is stated.")),
  );
  draw(data);
}
