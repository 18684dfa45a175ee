/** The catalogue of common cameras: read once, grouped by maker and payload, with the sources of a camera's figures. */

import { get } from "../api.js";
import { h } from "../dom.js";
import { t } from "../text.js";
import { FIGURES, readTitle, sourcesOf } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { Camera, CameraCatalogue, CatalogueCamera } from "../api_types.d.ts" */

/** @type {Promise<CatalogueCamera[]> | null} */
let read = null;

/** All cameras of the catalogue. Rejects with ApiError; the next call then asks again. */
export function readCatalogue() {
  read ??= get("/camera-catalogue").then(
    (answer) => /** @type {Answer<CameraCatalogue>} */ (answer).data.results,
    (error) => {
      read = null;
      throw error;
    },
  );
  return read;
}

/** A camera of the catalogue as a UAV type carries it. @param {CatalogueCamera} known @returns {Camera} */
export function cameraOf(known) {
  const { key, maker, payload, sources, derived, ...camera } = known;
  return camera;
}

/** By payload, with its maker where the payload does not begin with it. @param {readonly CatalogueCamera[]} cameras */
export function groupsOf(cameras) {
  /** @type {Map<string, CatalogueCamera[]>} */
  const groups = new Map();
  for (const camera of cameras) {
    const { maker, payload } = camera;
    const words = payload.startsWith(maker) ? payload : `${maker} ${payload}`;
    groups.set(words, [...(groups.get(words) ?? []), camera]);
  }
  return groups;
}

/** Those of which name, maker, payload and key have all words of a text. @param {readonly CatalogueCamera[]} cameras @param {string} text */
export function matching(cameras, text) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return cameras.filter(({ name, maker, payload, key }) => {
    const all = `${maker} ${payload} ${name} ${key}`.toLowerCase();
    return words.every((word) => all.includes(word));
  });
}

/** The groups and cameras as options of a select; `value` is the key. @param {readonly CatalogueCamera[]} cameras */
export const optionsOf = (cameras) =>
  [...groupsOf(cameras)].map(([words, group]) =>
    h(
      "optgroup",
      { label: words },
      group.map(({ key, name }) => h("option", { value: key }, name)),
    ),
  );

/**
 * Where the figures of a camera come from; null where the catalogue has none of this name.
 *
 * @param {Camera} camera
 * @param {readonly CatalogueCamera[]} cameras
 */
export function sourcesList(camera, cameras) {
  const known = cameras.find(({ name }) => name === camera.name);
  if (!known) return null;
  return h(
    "details",
    { class: "camera-sources" },
    h("summary", {}, t("Sources of the figures")),
    h(
      "ul",
      {},
      sourcesOf(camera, known).map((source) => {
        const { title, isVerified } = readTitle(source);
        const words = { lang: "en", translate: "no" };
        return h(
          "li",
          {},
          source.url
            ? h("a", { ...words, href: source.url, rel: "noreferrer", target: "_blank" }, title)
            : h("span", words, title),
          !isVerified && [" ", h("span", { class: "chip" }, t("not verified"))],
          h(
            "span",
            { class: "caption" },
            `${source.figures.map((name) => FIGURES[name] ?? name).join(", ")} · ${source.date}`,
          ),
        );
      }),
      Object.entries(known.derived).map(([name, words]) =>
        h("li", {}, `${FIGURES[name] ?? name}: `, h("span", { lang: "en", translate: "no" }, words)),
      ),
    ),
  );
}
