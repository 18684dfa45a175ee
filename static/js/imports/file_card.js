/** One chosen file: its kind, source and upload progress. */

import { h, icon, setChildren } from "../dom.js";
import { readPage } from "../page/chrome.js";
import { t } from "../text.js";
import { percentText } from "../units.js";
import { KINDS, sizeText, VERTICAL_DATUMS } from "./words.js";

/** @import { GroundPage } from "../ground/types.d.ts" */
/** @import { ImportKind, UploadActs, UploadItem } from "./types.d.ts" */

/** Fields of each kind: name, words, hint. @type {Record<ImportKind, [string, string, string][]>} */
const FIELDS = {
  osm: [],
  zones: [["set_name", t("Name of the set"), t("The set that this file is the newest state of")]],
  assets: [["set_name", t("Name of the set"), t("The set that this file is the newest state of")]],
  terrain: [["vertical_datum", t("Heights count from"), t("Where the file does not say it")]],
};
/** @type {[string, string, string][]} */
const PROVENANCE = [
  ["licence", t("Licence"), "CC BY 4.0"],
  ["attribution", t("Attribution"), t("Who must be named")],
  ["source_address", t("Address"), "https://…"],
];
let made = 0;

/** @param {UploadItem} item @param {UploadActs} acts */
export const fileCard = (item, acts) => new FileCard(item, acts);

class FileCard {
  #item;
  #acts;
  #id;
  #fields = h("div", { class: "stack" });
  #status = h("div", { class: "file-status" });
  #kind;
  #form;
  #shown = "";

  /** @param {UploadItem} item @param {UploadActs} acts */
  constructor(item, acts) {
    made += 1;
    this.#item = item;
    this.#acts = acts;
    this.#id = `file-${made}`;
    this.#kind = h(
      "select",
      { class: "input", id: `${this.#id}-kind` },
      Object.entries(KINDS).map(([value, { words }]) => h("option", { value }, words)),
    );
    this.#kind.addEventListener("change", () => {
      acts.kind(item, /** @type {ImportKind} */ (this.#kind.value));
      this.#drawFields();
    });
    this.#form = h(
      "form",
      { class: "stack", id: `${this.#id}-form`, "aria-label": item.name },
      this.#field("kind", t("What it is"), this.#kind),
      this.#fields,
    );
    this.#form.addEventListener("submit", (event) => {
      event.preventDefault();
      acts.start(item);
    });
    this.element = h("li", { class: "file-card" }, this.#head(), this.#form, this.#status);
    this.#drawFields();
  }

  refresh() {
    const { phase, size, received, waits_s, problem } = this.#item;
    this.#form.hidden = phase !== "chosen" && phase !== "failed";
    if (this.#shown !== phase) {
      this.#shown = phase;
      setChildren(this.#status, statusOf(this.#item, this.#acts, this.#form.id));
    }
    const share = size ? received / size : 0;
    const status = this.#status;
    for (const place of status.querySelectorAll("[data-share]")) place.textContent = percentText(share * 100);
    for (const place of status.querySelectorAll("[data-wait]")) place.textContent = `${waits_s}\u00a0s`;
    for (const place of status.querySelectorAll("[data-problem]")) place.textContent = problem;
    const bar = status.querySelector("[role=progressbar]");
    if (!bar) return;
    bar.setAttribute("aria-valuenow", String(Math.round(share * 100)));
    /** @type {HTMLElement} */ (bar.firstElementChild).style.width = `${share * 100}%`;
  }

  #head() {
    const { name, size } = this.#item;
    const label = t("Take {name} off", { name });
    const drop = () => this.#acts.drop(this.#item);
    const remove = { type: "button", class: "icon-button tight", "aria-label": label, title: t("Take it off") };
    return h(
      "div",
      { class: "file-head" },
      icon("file"),
      h("span", { class: "file-name" }, h("strong", {}, name), h("span", { class: "caption" }, sizeText(size))),
      h("button", { ...remove, onclick: drop }, icon("x", "small")),
    );
  }

  /** @param {string} name @param {string} words @param {HTMLElement} control */
  #field(name, words, control) {
    return h("div", { class: "field" }, h("label", { for: `${this.#id}-${name}` }, words), control);
  }

  #drawFields() {
    const { kind } = this.#item;
    this.#kind.value = kind;
    const own = FIELDS[kind].map(([name, words, hint]) =>
      this.#field(name, words, name === "vertical_datum" ? this.#datum(name) : this.#input("parameters", name, hint)),
    );
    const source = PROVENANCE.map(([name, words, hint]) =>
      this.#field(name, words, this.#input("provenance", name, hint)),
    );
    const provenance = h(
      "details",
      { open: kind === "zones" },
      h("summary", {}, t("Where it comes from")),
      h("div", { class: "stack" }, source),
    );
    const osm = h("p", { class: "caption" }, t("© OpenStreetMap contributors, ODbL."));
    setChildren(this.#fields, own, this.#region(), kind === "osm" ? osm : provenance);
  }

  /** The region that the file joins or makes. The demo takes no real data. */
  #region() {
    /** @type {GroundPage} */
    const { regions = [] } = readPage();
    const box = this.#input("parameters", "region", t("Blank: by its place"));
    box.maxLength = 200;
    box.setAttribute("list", `${this.#id}-regions`);
    const own = regions.filter((region) => !region.is_synthetic);
    const choices = h(
      "datalist",
      { id: `${this.#id}-regions` },
      own.map(({ name }) => h("option", { value: name })),
    );
    return this.#field("region", t("Region"), h("div", {}, box, choices));
  }

  /** @param {"parameters" | "provenance"} group @param {string} name @param {string} hint */
  #input(group, name, hint) {
    const values = this.#item[group];
    const type = name === "source_address" ? "url" : "text";
    const look = { class: "input", id: `${this.#id}-${name}`, type, placeholder: hint, maxlength: "300" };
    const box = h("input", { ...look, value: values[name] ?? "" });
    box.addEventListener("input", () => {
      values[name] = box.value;
      this.#acts.change(this.#item);
    });
    return box;
  }

  /** @param {string} name */
  #datum(name) {
    const { parameters } = this.#item;
    const choice = h(
      "select",
      { class: "input", id: `${this.#id}-${name}` },
      VERTICAL_DATUMS.map((datum) => h("option", {}, datum)),
    );
    choice.value = parameters[name] ?? VERTICAL_DATUMS[0];
    parameters[name] = choice.value;
    choice.addEventListener("change", () => {
      parameters[name] = choice.value;
      this.#acts.change(this.#item);
    });
    return choice;
  }
}

/** The elements below the card in each phase. @param {UploadItem} item @param {UploadActs} acts @param {string} formId */
function statusOf(item, acts, formId) {
  const share = h("span", { dataset: { share: "" } });
  switch (item.phase) {
    case "sending":
      return [
        h("div", { class: "job-words" }, h("span", {}, t("Sending")), share),
        progressBar(item),
        actRow(t("Stop"), () => acts.stop(item)),
      ];
    case "starting":
      return [h("div", { class: "job-words" }, h("span", { role: "status" }, t("Sent. It will be read now.")))];
    case "waiting":
      return [waitingNotice(item, share), progressBar(item), actRow(t("Stop"), () => acts.stop(item))];
    case "lost":
      return [
        h("p", {}, share, ` ${t("is there already. Choose the same file again, and it goes on from there.")}`),
        actRow(t("Choose the file"), () => acts.choose(item)),
      ];
    default: {
      const words = h("span", { dataset: { problem: "" } });
      const fault = h("p", { class: "field-error", role: "alert" }, icon("circle-alert", "small"), words);
      const submit = { type: "submit", form: formId, class: "button primary" }; // Enter in a field does the same
      return [
        item.phase === "failed" && fault,
        h("div", { class: "row-acts" }, h("button", submit, t("Read the file"))),
      ];
    }
  }
}

/** @param {string} words @param {() => void} act */
const actRow = (words, act) =>
  h("div", { class: "row-acts" }, h("button", { type: "button", class: "button", onclick: act }, words));

/** @param {UploadItem} item */
function progressBar({ name }) {
  const label = t("Sending {name}", { name });
  const range = { "aria-valuemin": "0", "aria-valuemax": "100" };
  return h("div", { class: "progress", role: "progressbar", "aria-label": label, ...range }, h("i"));
}

/** @param {UploadItem} item @param {HTMLElement} share */
function waitingNotice(item, share) {
  const wake = () => item.wake?.();
  return h(
    "div",
    { class: "notice warning" },
    icon("cloud-off"),
    h(
      "p",
      {},
      h("strong", { role: "status" }, t("The connection was cut.")),
      " ",
      share,
      ` ${t("is there and stays. Next try in")} `,
      h("span", { dataset: { wait: "" } }),
      ". ",
      h("button", { type: "button", class: "text-button", onclick: wake }, t("Try now")),
    ),
  );
}
