/** Vehicles that spoke to a gateway and belong to no UAV: an administrator says whose they are, or that nobody cares. */

import { ApiError, get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { agoText } from "../units.js";

const ASKED_EVERY_MS = 15_000;
const NEW = "";

export function aboutVehicle(vehicle, now = Date.now()) {
  const seconds = (now - Date.parse(vehicle.heard_at)) / 1_000;
  const facts = [
    vehicle.autopilot,
    vehicle.vehicle_type,
    vehicle.address,
    vehicle.is_signed ? t("signed") : t("not signed"),
    t("heard {ago}", { ago: agoText(seconds, vehicle.heard_at) }),
  ];
  return facts.filter(Boolean).join(" · ");
}

/** onAdopted(uav): the id of the UAV that it is now. */
export function mountUnknownVehicles({ onAdopted }) {
  const section = byId("fleet-unknown");
  const title = h("h2", {}, t("Unknown vehicles"));
  const list = h("ul", { class: "plain-list" });
  const none = h(
    "p",
    { class: "quiet-text" },
    t("None. A vehicle that speaks to a gateway with a system id of no UAV is listed here."),
  );
  const ignoredButton = h("button", {
    type: "button",
    class: "text-button",
    hidden: true,
    "aria-expanded": "false",
    onclick: () => ((showsIgnored = !showsIgnored), load()),
  });
  let showsIgnored = false;
  let adopting = null; // id of the vehicle whose form is open
  section.hidden = false;
  section.replaceChildren(title, list, none, ignoredButton);

  const tell = (error) => {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  };

  async function attempt(change) {
    try {
      await change();
    } catch (error) {
      tell(error);
    }
    await load();
  }

  const heed = (vehicle) => attempt(() => remove(`/unknown-vehicles/${vehicle.id}/ignore`));
  const ignore = (vehicle) =>
    attempt(async () => {
      await post(`/unknown-vehicles/${vehicle.id}/ignore`);
      toast(t("System {id} is ignored.", { id: vehicle.mavlink_system_id }), {
        label: t("Undo"),
        act: () => heed(vehicle),
      });
    });

  async function adopt(vehicle, body) {
    try {
      const { data } = await post(`/unknown-vehicles/${vehicle.id}/adopt`, body);
      adopting = null;
      toast(t("System {id} is {name} now.", { id: vehicle.mavlink_system_id, name: data.properties.name }));
      await load();
      onAdopted(data.id);
    } catch (error) {
      tell(error);
    }
  }

  async function openForm(vehicle) {
    adopting = vehicle.id;
    await load();
    section.querySelector("form select")?.focus();
  }

  function adoptionForm(vehicle, uavs) {
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
    const onsubmit = (event) => {
      event.preventDefault();
      adopt(vehicle, choice.value === NEW ? { name: name.value.trim() } : { uav: Number(choice.value) });
    };
    const cancel = h(
      "button",
      { type: "button", class: "button", onclick: () => ((adopting = null), load()) },
      t("Cancel"),
    );
    return h(
      "form",
      { class: "adoption", onsubmit },
      h("div", { class: "field" }, h("label", { for: choice.id }, t("It is")), choice),
      nameField,
      h("div", { class: "acts" }, h("button", { class: "button" }, t("Adopt")), cancel),
    );
  }

  function row(vehicle, uavs) {
    const isIgnored = vehicle.state === "ignored";
    const id = { id: vehicle.mavlink_system_id };
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
        adopting !== vehicle.id &&
          h(
            "button",
            {
              type: "button",
              class: "button",
              "aria-label": t("Adopt system {id}", id),
              onclick: () => openForm(vehicle),
            },
            icon("plus", "small"),
            t("Adopt"),
          ),
        isIgnored
          ? h(
              "button",
              {
                type: "button",
                class: "button quiet",
                "aria-label": t("List again: system {id}", id),
                onclick: () => heed(vehicle),
              },
              t("List again"),
            )
          : h(
              "button",
              {
                type: "button",
                class: "button quiet",
                "aria-label": t("Ignore system {id}", id),
                onclick: () => ignore(vehicle),
              },
              t("Ignore"),
            ),
      ),
      adopting === vehicle.id && adoptionForm(vehicle, uavs),
    );
  }

  async function load() {
    const [found, ignored, uavs] = await Promise.all([
      get("/unknown-vehicles"),
      get("/unknown-vehicles?state=ignored"),
      adopting === null ? null : get("/uavs?limit=1000"),
    ]);
    const hidden = ignored.data.results;
    const rows = [...found.data.results, ...(showsIgnored ? hidden : [])];
    list.replaceChildren(...rows.map((vehicle) => row(vehicle, uavs?.data.features ?? [])));
    none.hidden = rows.length > 0;
    ignoredButton.hidden = hidden.length === 0;
    ignoredButton.setAttribute("aria-expanded", `${showsIgnored}`);
    ignoredButton.textContent = showsIgnored
      ? t("Hide the ignored ones")
      : tn(hidden.length, "Show {count} ignored one", "Show {count} ignored ones");
  }

  setInterval(
    () => document.visibilityState === "visible" && adopting === null && load().catch(() => {}),
    ASKED_EVERY_MS,
  );
  return load().catch(tell);
}
