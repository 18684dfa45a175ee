/** The terrain models in the side: what counts on top first, where each is from, and how whole it is. */

import { byId, h, icon } from "../dom.js";
import { locale, t, tn } from "../text.js";
import { heightText, lengthText, numberText, whenText } from "../units.js";

/** @import { ModelFeature, ModelProperties } from "../api_types.d.ts" */

/**
 * Shares below what shows in one digit are not rounded to none.
 *
 * @param {Pick<ModelProperties, "posts" | "voids">} properties
 */
export function voidsText({ posts, voids }) {
  if (posts === null || voids === null || !posts) return t("not counted");
  if (!voids) return t("none");
  const percent = (100 * voids) / posts;
  const share =
    percent < 0.1
      ? t("under {share}", { share: numberText(0.1, 1) })
      : percent.toLocaleString(locale, { maximumFractionDigits: 1 });
  return `${tn(voids, "{count} post", "{count} posts")}, ${share}\u00a0%`;
}

/** [term, words] of one model. @param {ModelProperties} properties @returns {[string, string][]} */
export function factsOf(properties) {
  const { lowest_m, highest_m, vertical_datum, resolution_m, attribution, licence, is_synthetic, imported_at } =
    properties;
  return [
    [
      t("Heights"),
      lowest_m === null || highest_m === null
        ? t("not counted")
        : t("{low} to {high}", { low: heightText(lowest_m), high: heightText(highest_m) }),
    ],
    [t("Vertical datum"), vertical_datum],
    [t("Posts every"), lengthText(resolution_m)],
    [t("Voids"), voidsText(properties)],
    [t("Source"), attribution || (is_synthetic ? t("Synthetic demo data") : t("not stated"))],
    [t("Licence"), licence || t("not stated")],
    [t("Imported"), whenText(imported_at)],
  ];
}

/**
 * on: { show(model), point(model or null), remove(model) }. Returns show(models).
 *
 * @param {boolean} canCurate
 * @param {{ show: (model: ModelFeature) => void, point: (model: ModelFeature | null) => void, remove: (model: ModelFeature) => void }} on
 */
export function mountModelList(canCurate, on) {
  const list = byId("terrain-list");
  const end = byId("terrain-list-end");

  /** @param {ModelFeature} model @param {number} index @param {number} count */
  function row(model, index, count) {
    const { file_name } = model.properties;
    const words = count > 1 ? (index === 0 ? t("Counts on top") : t("Fills what those above leave void")) : "";
    const opener = h(
      "button",
      { class: "terrain-name", type: "button", title: t("Show it on the map"), onclick: () => on.show(model) },
      icon("mountain"),
      h("strong", {}, file_name),
    );
    for (const come of ["pointerenter", "focus"]) opener.addEventListener(come, () => on.point(model));
    for (const go of ["pointerleave", "blur"]) opener.addEventListener(go, () => on.point(null));
    return h(
      "li",
      { class: "terrain-row", dataset: { id: model.id } },
      h(
        "div",
        { class: "terrain-head" },
        opener,
        canCurate &&
          h(
            "button",
            {
              class: "icon-button tight",
              type: "button",
              "aria-label": t("Remove {name}", { name: file_name }),
              title: t("Remove"),
              onclick: () => on.remove(model),
            },
            icon("trash-2"),
          ),
      ),
      words && h("p", { class: "caption" }, words),
      h(
        "dl",
        { class: "terrain-facts" },
        factsOf(model.properties).map(([term, value]) => h("div", {}, h("dt", {}, term), h("dd", {}, value))),
      ),
    );
  }

  const empty = () =>
    h(
      "div",
      { class: "empty" },
      icon("mountain"),
      h("strong", {}, t("No terrain here yet.")),
      h("p", {}, t("Heights above sea level need a terrain model: a GeoTIFF or an HGT file.")),
      canCurate
        ? h("a", { class: "button", href: "/imports" }, t("Import a file"))
        : h("p", {}, t("A curator can import one.")),
    );

  /** @param {ModelFeature[]} models */
  return (models) => {
    byId("terrain-count").textContent = models.length ? String(models.length) : "";
    list.replaceChildren(...models.map((model, index) => row(model, index, models.length)));
    end.replaceChildren(...(models.length ? [] : [empty()]));
  };
}

/**
 * Ask for confirmation. Resolves to whether the model shall be removed.
 * @param {{ file_name: string }} model @returns {Promise<boolean>}
 */
export function askToRemove({ file_name }) {
  return new Promise((resolve) => {
    /** @type {HTMLDialogElement} */
    const dialog = h(
      "dialog",
      { "aria-labelledby": "remove-title" },
      h("h2", { id: "remove-title" }, t("Remove {name}?", { name: file_name })),
      h(
        "p",
        {},
        t(
          "Heights then come from older models where they reach, and from none elsewhere. Planned missions say that the ground has changed. The file can be imported again.",
        ),
      ),
      h(
        "form",
        { method: "dialog", class: "acts" },
        h("button", { class: "button", value: "keep" }, t("Keep it")),
        h("button", { class: "button danger", value: "remove" }, t("Remove")),
      ),
    );
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "remove");
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
