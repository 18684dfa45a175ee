/** One chosen file: what it is, where it comes from, and how far it is on its way. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { percentText } from "../units.js";
import { KINDS, sizeText, VERTICAL_DATUMS } from "./words.js";

const FIELDS = {
  osm: [],
  zones: [["set_name", t("Name of the set"), t("The set that this file is the newest state of")]],
  assets: [["set_name", t("Name of the set"), t("The set that this file is the newest state of")]],
  terrain: [["vertical_datum", t("Heights count from"), t("Where the file does not say it")]],
};
const PROVENANCE = [
  ["licence", t("Licence"), "CC BY 4.0"],
  ["attribution", t("Attribution"), t("Who must be named")],
  ["source_address", t("Address"), "https://…"],
];
let count = 0;

/** acts: { start(item), stop(item), choose(item), drop(item), kind(item, kind), change(item) }. Returns { element, refresh(item) }. */
export function fileCard(item, acts) {
  const id = `file-${(count += 1)}`;
  const fields = h("div", { class: "stack" });
  const status = h("div", { class: "file-status" });
  const kind = h(
    "select",
    { class: "input", id: `${id}-kind`, onchange: () => (acts.kind(item, kind.value), drawFields()) },
    Object.entries(KINDS).map(([value, { words }]) => h("option", { value }, words)),
  );
  const form = h(
    "form",
    {
      class: "stack",
      id: `${id}-form`,
      "aria-label": item.name,
      onsubmit: (event) => (event.preventDefault(), acts.start(item)),
    },
    h("div", { class: "field" }, h("label", { for: `${id}-kind` }, t("What it is")), kind),
    fields,
  );
  const element = h(
    "li",
    { class: "file-card" },
    h(
      "div",
      { class: "file-head" },
      icon("file"),
      h(
        "span",
        { class: "file-name" },
        h("strong", {}, item.name),
        h("span", { class: "caption" }, sizeText(item.size)),
      ),
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("Take {name} off", { name: item.name }),
          title: t("Take it off"),
          onclick: () => acts.drop(item),
        },
        icon("x", "small"),
      ),
    ),
    form,
    status,
  );

  function input(group, name, hint, isUrl) {
    const box = h("input", {
      class: "input",
      id: `${id}-${name}`,
      type: isUrl ? "url" : "text",
      placeholder: hint,
      maxlength: "300",
      value: item[group][name] ?? "",
    });
    box.addEventListener("input", () => {
      item[group][name] = box.value;
      acts.change(item);
    });
    return box;
  }

  function datumChoice(name) {
    const choice = h(
      "select",
      { class: "input", id: `${id}-${name}` },
      VERTICAL_DATUMS.map((datum) => h("option", {}, datum)),
    );
    choice.value = item.parameters[name] ?? VERTICAL_DATUMS[0];
    item.parameters[name] = choice.value;
    choice.addEventListener("change", () => {
      item.parameters[name] = choice.value;
      acts.change(item);
    });
    return choice;
  }

  function drawFields() {
    kind.value = item.kind;
    fields.replaceChildren(
      ...FIELDS[item.kind].map(([name, words, hint]) =>
        h(
          "div",
          { class: "field" },
          h("label", { for: `${id}-${name}` }, words),
          name === "vertical_datum" ? datumChoice(name) : input("parameters", name, hint),
        ),
      ),
      item.kind === "osm"
        ? h("p", { class: "caption" }, t("© OpenStreetMap contributors, ODbL."))
        : h(
            "details",
            { open: item.kind === "zones" },
            h("summary", {}, t("Where it comes from")),
            h(
              "div",
              { class: "stack" },
              PROVENANCE.map(([name, words, hint]) =>
                h(
                  "div",
                  { class: "field" },
                  h("label", { for: `${id}-${name}` }, words),
                  input("provenance", name, hint, name === "source_address"),
                ),
              ),
            ),
          ),
    );
  }
  drawFields();

  let shown = "";
  function refresh() {
    const isIdle = item.phase === "chosen" || item.phase === "failed";
    form.hidden = !isIdle;
    if (shown !== item.phase) {
      shown = item.phase;
      status.replaceChildren(...statusOf(item, acts, form.id));
    }
    const share = item.size ? item.received / item.size : 0;
    for (const place of status.querySelectorAll("[data-share]")) place.textContent = percentText(share * 100);
    for (const place of status.querySelectorAll("[data-wait]")) place.textContent = `${item.waits_s}\u00a0s`;
    for (const place of status.querySelectorAll("[data-problem]")) place.textContent = item.problem;
    const bar = status.querySelector("[role=progressbar]");
    if (bar) {
      bar.setAttribute("aria-valuenow", String(Math.round(share * 100)));
      bar.firstElementChild.style.width = `${share * 100}%`;
    }
  }
  return { element, refresh };
}

function statusOf(item, acts, formId) {
  const share = () => h("span", { dataset: { share: "" } });
  const button = (words, act, look = "") =>
    h("button", { type: "button", class: `button ${look}`.trim(), onclick: act }, words);
  const bar = () =>
    h(
      "div",
      {
        class: "progress",
        role: "progressbar",
        "aria-label": t("Sending {name}", { name: item.name }),
        "aria-valuemin": "0",
        "aria-valuemax": "100",
      },
      h("i"),
    );
  if (item.phase === "sending")
    return [
      h("div", { class: "job-words" }, h("span", {}, t("Sending")), share()),
      bar(),
      h(
        "div",
        { class: "row-acts" },
        button(t("Stop"), () => acts.stop(item)),
      ),
    ];
  if (item.phase === "starting")
    return [h("div", { class: "job-words" }, h("span", { role: "status" }, t("Sent. It will be read now.")))];
  if (item.phase === "waiting") {
    const wait = h("span", { dataset: { wait: "" } });
    return [
      h(
        "div",
        { class: "notice warning" },
        icon("cloud-off"),
        h(
          "p",
          {},
          h("strong", { role: "status" }, t("The connection was cut.")),
          " ",
          share(),
          ` ${t("is there and stays. Next try in")} `,
          wait,
          ". ",
          h("button", { type: "button", class: "text-button", onclick: () => item.wake?.() }, t("Try now")),
        ),
      ),
      bar(),
      h(
        "div",
        { class: "row-acts" },
        button(t("Stop"), () => acts.stop(item)),
      ),
    ];
  }
  if (item.phase === "lost") {
    return [
      h("p", {}, share(), ` ${t("is there already. Choose the same file again, and it goes on from there.")}`),
      h(
        "div",
        { class: "row-acts" },
        button(t("Choose the file"), () => acts.choose(item)),
      ),
    ];
  }
  const problem =
    item.phase === "failed" &&
    h(
      "p",
      { class: "field-error", role: "alert" },
      icon("circle-alert", "small"),
      h("span", { dataset: { problem: "" } }),
    );
  const submit = h("button", { type: "submit", form: formId, class: "button primary" }, t("Read the file")); // Enter in a field does the same
  return [problem, h("div", { class: "row-acts" }, submit)].filter(Boolean);
}
