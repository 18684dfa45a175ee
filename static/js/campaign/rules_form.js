/** The form of a campaign: where crews start, how far UAVs may be from a launch site, and how long a working day is. */

import { boundsIn } from "../alert_limits/words.js";
import { ApiError, freshKey, get } from "../api.js";
import { h } from "../dom.js";
import { choiceField, numberField, switchField, textField } from "../page/fields.js";
import { open } from "../page/keyboard.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { coordinateText, LONG_UNIT } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { BasePage, CampaignRules, CampaignRulesRequest } from "../api_types.d.ts" */

/** @typedef {{ name: string, position: number[] }} Place where crews can start */
/** @typedef {Place & { is_required: boolean }} LaunchSite */

const MAX_BASES = 150; // of 200 launch sites
/** @satisfies {Omit<CampaignRulesRequest, "start">} */
const USUAL = {
  crews: 1,
  drive_kmh: 40,
  set_up_min: 15,
  day_h: 8,
  reach_m: 3000,
  flights: 4,
  sites: /** @type {LaunchSite[]} */ ([]),
  proposes_sites: /** @type {boolean} */ (true),
};

/** The bases; null where they cannot be read, which is shown. @returns {Promise<LaunchSite[] | null>} */
async function readBases() {
  try {
    const { data } = /** @type {Answer<BasePage>} */ (await get(`/bases?limit=${MAX_BASES}`));
    return data.results.map(({ name, position }) => ({ name, position, is_required: false }));
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
    return null;
  }
}

/**
 * Open the form. `send` is given what was stated; the form closes once it is done, and shows the fault where it rejects with ApiError.
 *
 * @param {object} options
 * @param {string} options.title
 * @param {string} options.act words of its button
 * @param {string} [options.name] proposed name of a new campaign; without it the name is not asked for
 * @param {CampaignRules | null} [options.rules] those of the campaign as it is
 * @param {Place[]} [options.starts] other places where crews can start
 * @param {string} [options.hint]
 * @param {(stated: { name: string, rules: CampaignRulesRequest, key: string }) => Promise<unknown>} options.send `key`: of all its tries
 */
export async function openRules({ title, act, name, rules = null, starts = [], hint = "", send }) {
  const key = freshKey();
  const known = await readBases();
  if (!known) return;
  const all = [...known, ...starts];
  const places = rules && !all.some(({ position }) => isAt(position, rules.start)) ? [placeOf(rules), ...all] : all;
  const own = (rules?.sites ?? []).filter(({ position }) => !known.some((base) => isAt(base.position, position)));
  const fields = fieldsOf({ ...USUAL, ...rules }, places, { name, start: rules?.start ?? null });
  const wrong = h("p", { class: "field-error", role: "alert", hidden: true });
  const go = h("button", { class: "button primary" }, act);
  const { name: nameField, ...others } = fields;
  const form = h(
    "form",
    {},
    name !== undefined && nameField.element,
    h(
      "div",
      { class: "campaign-fields" },
      Object.values(others).map(({ element }) => element),
    ),
    hint && h("p", { class: "caption" }, hint),
    wrong,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: () => void dialog.close() }, t("Cancel")),
      go,
    ),
  );
  const dialog = h(
    "dialog",
    { class: "campaign-rules", "aria-labelledby": "campaign-rules-title" },
    h("h2", { id: "campaign-rules-title" }, title),
    form,
  );

  /** @param {string} words */
  function announce(words) {
    wrong.hidden = !words;
    wrong.textContent = words;
  }

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (!fields.uses_bases.read() && !fields.proposes_sites.read() && own.length === 0) {
      announce(t("Without bases, launch sites must be proposed."));
      return;
    }
    if (go.disabled) return;
    announce("");
    go.setAttribute("aria-busy", "true");
    go.disabled = true;
    try {
      await send({ key, name: nameField.read(), rules: statedRules(fields, places, { known, own }) });
      dialog.close();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      announce(error.isAway ? t("The server cannot be reached. What you typed stays here.") : error.message);
    } finally {
      go.removeAttribute("aria-busy");
      go.disabled = false;
    }
  });
  open(dialog);
  (name === undefined ? fields.start : nameField).input.focus();
}

/**
 * @param {typeof USUAL} values
 * @param {Place[]} places where crews can start
 * @param {{ name?: string, start: number[] | null }} now
 */
function fieldsOf(values, places, { name, start: startsAt }) {
  const start = Math.max(
    0,
    places.findIndex(({ position }) => startsAt && isAt(position, startsAt)),
  );
  return {
    name: textField("name", t("Name"), name, { required: true, maxlength: 150 }),
    start: choiceField(
      "start",
      t("Crews start at"),
      start,
      places.map((place, index) => [index, place.name]),
      { isNumber: true, required: true },
    ),
    crews: numberField("crews", t("Crews"), values.crews, { required: true, min: 1, max: 20, step: 1 }),
    day_h: numberField("day_h", t("Working day"), values.day_h, { required: true, min: 1, max: 24, unit: t("h") }),
    reach_m: numberField("reach_m", t("Greatest distance from the launch site"), values.reach_m, {
      required: true,
      factor: LONG_UNIT.metres,
      unit: LONG_UNIT.unit,
      ...boundsIn([100, 50_000], LONG_UNIT.metres),
      hint: t("Such as the range of sight or of the radio. Routes may lead farther; the plan says where."),
    }),
    flights: numberField("flights", t("Flights of each UAV at a site"), values.flights, {
      required: true,
      min: 1,
      max: 20,
      step: 1,
      hint: t("Each on a full battery; batteries are charged between sites."),
    }),
    set_up_min: numberField("set_up_min", t("Set-up and packing at a site"), values.set_up_min, {
      required: true,
      min: 0,
      max: 240,
      unit: t("min"),
    }),
    drive_kmh: numberField("drive_kmh", t("Driving speed"), values.drive_kmh, {
      required: true,
      factor: LONG_UNIT.metres / 1000,
      ...boundsIn([5, 130], LONG_UNIT.metres / 1000),
      digits: 0,
      unit: LONG_UNIT.unit === "km" ? "km/h" : "mph",
      hint: t("Drives are estimated from the straight line."),
    }),
    uses_bases: switchField(
      "uses_bases",
      t("Launch from bases too"),
      !startsAt || values.sites.some(({ name: own }) => own !== ""),
      {
        hint: t("Where one is in reach of the targets."),
      },
    ),
    proposes_sites: switchField("proposes_sites", t("Propose launch sites"), values.proposes_sites, {
      hint: t("40 m beside towers, outside no-fly zones. Check each place, and its access by road, yourself."),
    }),
  };
}

/**
 * @param {ReturnType<typeof fieldsOf>} fields
 * @param {Place[]} places where crews can start
 * @param {{ known: LaunchSite[], own: LaunchSite[] }} sites bases, which the user may leave out, and launch sites set on the map
 * @returns {CampaignRulesRequest}
 */
const statedRules = (fields, places, { known, own }) => ({
  start: places[Number(fields.start.read() ?? 0)].position,
  crews: fields.crews.read() ?? USUAL.crews,
  day_h: fields.day_h.read() ?? USUAL.day_h,
  reach_m: fields.reach_m.read() ?? USUAL.reach_m,
  flights: fields.flights.read() ?? USUAL.flights,
  set_up_min: fields.set_up_min.read() ?? USUAL.set_up_min,
  drive_kmh: fields.drive_kmh.read() ?? USUAL.drive_kmh,
  sites: [...(fields.uses_bases.read() ? known : []), ...own],
  proposes_sites: fields.proposes_sites.read(),
});

/** @param {number[]} left @param {number[]} right */
const isAt = (left, right) => Math.abs(left[0] - right[0]) < 1e-6 && Math.abs(left[1] - right[1]) < 1e-6;

/** @param {CampaignRules} rules @returns {Place} */
const placeOf = ({ start }) => ({ name: coordinateText(start), position: start });
