/** Vehicles that sent messages to a gateway and belong to no UAV: an administrator adopts or ignores them. */

import { ApiError, get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { agoText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { AdoptionRequest, UavCollection, UavFeature, UnknownVehicle, UnknownVehiclePage } from "../api_types.d.ts" */

const ASKED_EVERY_MS = 15_000;
const NEW = "";
const NONE = t("None. Vehicles with an unknown system ID seen by the gateway are listed here.");

/**
 * @param {Pick<UnknownVehicle, "last_message_at" | "autopilot" | "vehicle_type" | "address" | "is_signed">} vehicle
 * @param {number} [now]
 */
export function aboutVehicle(vehicle, now = Date.now()) {
  const seconds = (now - Date.parse(vehicle.last_message_at)) / 1_000;
  const facts = [
    vehicle.autopilot,
    vehicle.vehicle_type,
    vehicle.address,
    vehicle.is_signed ? t("signed") : t("not signed"),
    t("last contact {ago}", { ago: agoText(seconds, vehicle.last_message_at) }),
  ];
  return facts.filter(Boolean).join(" · ");
}

/**
 * The form that adopts a vehicle as a UAV.
 *
 * @param {UnknownVehicle} vehicle
 * @param {UavFeature[]} uavs
 * @param {{ adopt: (body: AdoptionRequest) => unknown, cancel: () => unknown }} acts
 */
function adoptionForm(vehicle, uavs, { adopt, cancel }) {
  const choice = h(
    "select",
    { class: "input", id: `adopt-${vehicle.id}` },
    h("option", { value: NEW }, t("A new UAV")),
    uavs.map((uav) => h("option", { value: `${uav.id}` }, uav.properties.name)),
  );
  const name = h("input", {
    class: "input",
    type: "text",
    id: `adopt-name-${vehicle.id}`,
    maxlength: 100,
    required: true,
    autocomplete: "off",
  });
  const nameField = h("div", { class: "field" }, h("label", { for: name.id }, t("Name")), name);
  choice.addEventListener("change", () => {
    nameField.hidden = choice.value !== NEW;
    name.required = choice.value === NEW;
  });
  const form = h(
    "form",
    { class: "adoption" },
    h("div", { class: "field" }, h("label", { for: choice.id }, t("It is")), choice),
    nameField,
    h(
      "div",
      { class: "acts" },
      h("button", { class: "button" }, t("Adopt")),
      h("button", { type: "button", class: "button", onclick: cancel }, t("Cancel")),
    ),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    adopt(choice.value === NEW ? { name: name.value.trim() } : { uav: Number(choice.value) });
  });
  return form;
}

/**
 * @param {UnknownVehicle} vehicle
 * @param {HTMLFormElement | null} form that is open below it
 * @param {{ open: () => unknown, ignore: () => unknown, heed: () => unknown }} acts
 */
function vehicleRow(vehicle, form, { open, ignore, heed }) {
  const id = { id: vehicle.mavlink_system_id };
  /** @param {string} label @param {() => unknown} act @param {string} words */
  const quiet = (label, act, words) =>
    h("button", { type: "button", class: "button quiet", "aria-label": label, onclick: act }, words);
  return h(
    "li",
    {},
    h(
      "div",
      { class: "what" },
      h("strong", {}, t("System {id}", id)),
      h("span", { class: "caption" }, aboutVehicle(vehicle)),
    ),
    h(
      "div",
      { class: "acts" },
      !form &&
        h(
          "button",
          { type: "button", class: "button", "aria-label": t("Adopt system {id}", id), onclick: open },
          icon("plus", "small"),
          t("Adopt"),
        ),
      vehicle.state === "ignored"
        ? quiet(t("List again: system {id}", id), heed, t("List again"))
        : quiet(t("Ignore system {id}", id), ignore, t("Ignore")),
    ),
    form,
  );
}

/** onAdopted: called with the id of the UAV that it is now. @param {{ onAdopted: (uav: number) => unknown }} acts */
export function mountUnknownVehicles({ onAdopted }) {
  const section = byId("fleet-unknown");
  const list = h("ul", { class: "plain-list" });
  const none = h("p", { class: "quiet-text" }, NONE);
  const ignoredButton = h("button", { type: "button", class: "text-button", hidden: true, "aria-expanded": "false" });
  let showsIgnored = false;
  /** @type {number | null} */
  let adopting = null; // id of the vehicle whose form is open
  ignoredButton.addEventListener("click", () => {
    showsIgnored = !showsIgnored;
    load();
  });
  section.hidden = false;
  section.replaceChildren(h("h2", {}, t("Unknown vehicles")), list, none, ignoredButton);

  /** @param {unknown} error */
  const showFault = (error) => {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  };

  /** @param {() => Promise<unknown>} change */
  async function attempt(change) {
    try {
      await change();
    } catch (error) {
      showFault(error);
    }
    await load();
  }

  /** @param {UnknownVehicle} vehicle */
  const heed = (vehicle) => attempt(() => remove(`/unknown-vehicles/${vehicle.id}/ignore`));
  /** @param {UnknownVehicle} vehicle */
  const ignore = (vehicle) =>
    attempt(async () => {
      await post(`/unknown-vehicles/${vehicle.id}/ignore`);
      toast(t("System {id} is ignored.", { id: vehicle.mavlink_system_id }), {
        label: t("Undo"),
        act: () => heed(vehicle),
      });
    });

  /** @param {UnknownVehicle} vehicle @param {AdoptionRequest} body */
  async function adopt(vehicle, body) {
    try {
      const { data } = /** @type {Answer<UavFeature>} */ (await post(`/unknown-vehicles/${vehicle.id}/adopt`, body));
      adopting = null;
      toast(t("System {id} is {name} now.", { id: vehicle.mavlink_system_id, name: data.properties.name }));
      await load();
      onAdopted(data.id);
    } catch (error) {
      showFault(error);
    }
  }

  /** @param {number | null} vehicle its id; null: no form */
  async function openForm(vehicle) {
    adopting = vehicle;
    await load();
    if (vehicle !== null) section.querySelector("select")?.focus();
  }

  /** @param {UnknownVehicle} vehicle @param {UavFeature[]} uavs */
  function row(vehicle, uavs) {
    const acts = {
      /** @param {AdoptionRequest} body */
      adopt: (body) => adopt(vehicle, body),
      cancel: () => openForm(null),
    };
    return vehicleRow(vehicle, adopting === vehicle.id ? adoptionForm(vehicle, uavs, acts) : null, {
      open: () => openForm(vehicle.id),
      ignore: () => ignore(vehicle),
      heed: () => heed(vehicle),
    });
  }

  async function load() {
    const [{ data: found }, { data: ignored }] = /** @type {Answer<UnknownVehiclePage>[]} */ (
      await Promise.all([get("/unknown-vehicles"), get("/unknown-vehicles?state=ignored")])
    );
    const uavs = adopting === null ? [] : await uavsOfFleet();
    const rows = [...found.results, ...(showsIgnored ? ignored.results : [])];
    list.replaceChildren(...rows.map((vehicle) => row(vehicle, uavs)));
    none.hidden = rows.length > 0;
    ignoredButton.hidden = ignored.results.length === 0;
    ignoredButton.setAttribute("aria-expanded", `${showsIgnored}`);
    ignoredButton.textContent = showsIgnored
      ? t("Hide the ignored ones")
      : tn(ignored.results.length, "Show {count} ignored one", "Show {count} ignored ones");
  }

  setInterval(() => {
    if (document.visibilityState === "visible" && adopting === null) load().catch(() => {});
  }, ASKED_EVERY_MS);
  return load().catch(showFault);
}

async function uavsOfFleet() {
  const { data } = /** @type {Answer<UavCollection>} */ (await get("/uavs?limit=1000"));
  return data.features;
}
