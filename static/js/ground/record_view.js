/** One record: its facts, its history, and the acts of curators. */

import { ApiError, get, post, remove } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { announce, toast } from "../page/toast.js";
import { t } from "../text.js";
import { historyList } from "./history_list.js";

/** @import { Answer } from "../api.js" */
/** @import { GroundHistoryEntry, GroundHistoryPage } from "../api_types.d.ts" */
/** @import { Box, Geometry } from "../map/types.d.ts" */
/** @import { RecordFeature, RecordKind } from "./types.d.ts" */

const ROUND_DEG = 0.0008;

/** @param {unknown[]} coordinates of a geometry @returns {number[][]} */
const positionsOf = (coordinates) =>
  typeof coordinates[0] === "number"
    ? [/** @type {number[]} */ (coordinates)]
    : /** @type {unknown[][]} */ (coordinates).flatMap(positionsOf);

/** The box round a geometry, with some room. @param {Geometry} geometry @returns {Box} */
function boxOf(geometry) {
  const [west, south, east, north] = boxAround(positionsOf(geometry.coordinates)) ?? [0, 0, 0, 0];
  return [west - ROUND_DEG, south - ROUND_DEG, east + ROUND_DEG, north + ROUND_DEG];
}

/** @param {string | null} etag */
export const ifMatch = (etag) => ({ headers: { "If-Match": etag ?? "" } });

/**
 * @template {RecordFeature} Feature
 * @typedef {object} ViewHandlers
 * @property {boolean} canCurate
 * @property {(view: "find" | "show") => void} go
 * @property {() => void} ring rings the selection
 * @property {(geometries?: Geometry[]) => void} ringAlso
 * @property {(box: Box) => void} fit
 * @property {() => Promise<void>} reload the list and the map
 * @property {(feature: Feature) => void} edit
 * @property {(id: number | undefined) => void} left called when the view of a record is left for the list
 * @property {(id: number) => void} chose called when a record is shown
 * @property {(error: unknown, again?: () => unknown) => void} failed
 */

/** @template {RecordFeature} Feature */
export class RecordView {
  #kind;
  #on;
  #element = byId("record-show");
  /** @type {{ feature: Feature, etag: string | null } | null} */
  chosen = null;

  /** @param {RecordKind<Feature, any>} kind @param {ViewHandlers<Feature>} on */
  constructor(kind, on) {
    this.#kind = kind;
    this.#on = on;
  }

  /** @param {number | string} id @param {{ stay?: boolean, keepScroll?: boolean }} [how] stay: the map does */
  async choose(id, { stay = false, keepScroll = false } = {}) {
    const { path, title } = this.#kind;
    try {
      const [one, { data: past }] = await Promise.all([get(`${path}/${id}`), get(`${path}/${id}/history`)]);
      const { data: feature, etag } = /** @type {Answer<Feature>} */ (one);
      this.chosen = { feature, etag };
      const scroll = byId("side-scroll").scrollTop;
      this.#draw(feature, /** @type {GroundHistoryPage} */ (past));
      this.#on.go("show");
      if (keepScroll) byId("side-scroll").scrollTop = scroll;
      this.#on.chose(feature.id);
      this.#on.ring();
      if (!stay) this.#on.fit(boxOf(feature.geometry));
      rememberAddress(id);
      announce(title(feature));
    } catch (error) {
      if (error instanceof ApiError && error.status === 404) toast(t("It is no longer there."));
      else this.#on.failed(error, () => this.choose(id));
    }
  }

  back() {
    const id = this.chosen?.feature.id;
    this.chosen = null;
    this.#on.ring();
    rememberAddress(null);
    this.#on.go("find");
    this.#on.left(id);
  }

  /** @param {Feature} feature @param {GroundHistoryPage} past */
  #draw(feature, past) {
    const { backWords, title, details, act, more } = this.#kind;
    this.#kind.closed?.();
    const own = feature.properties.vanished_at ? null : act?.(feature);
    const back = h("button", { type: "button", class: "text-button back", onclick: () => this.back() });
    setChildren(back, icon("arrow-left", "small"), backWords);
    setChildren(
      this.#element,
      back,
      h("h2", { class: "record-title", tabindex: -1 }, title(feature)),
      details(feature),
      h("div", { class: "record-acts" }, own, this.#on.canCurate ? this.#acts(feature, Boolean(own)) : []),
      more?.(feature),
      h("h3", {}, icon("history", "small"), t("History")),
      this.#historyPart(past),
    );
  }

  /** @param {Feature} feature @param {boolean} hasPrimary whether another act is the next one */
  #acts(feature, hasPrimary) {
    const isGone = Boolean(feature.properties.vanished_at);
    const edit = () => this.#on.edit(feature);
    const follow = () => this.#follow();
    const takeOff = () => this.#takeOff();
    return [
      h(
        "button",
        { type: "button", class: hasPrimary ? "button" : "button primary", onclick: edit, disabled: isGone },
        icon("pencil", "small"),
        t("Edit"),
      ),
      feature.properties.follows &&
        h("button", { type: "button", class: "button", onclick: follow }, t("Follow the source again")),
      !isGone &&
        h(
          "button",
          { type: "button", class: "button danger", onclick: takeOff },
          icon("trash-2", "small"),
          t("Delete"),
        ),
    ];
  }

  /** The newest changes; earlier ones on demand. @param {GroundHistoryPage} page @returns {HTMLElement} */
  #historyPart({ results, next: earlier }) {
    const revert = this.#on.canCurate ? (/** @type {GroundHistoryEntry} */ entry) => this.#revert(entry) : null;
    const part = h("div", {}, historyList(results, { revert, ring: this.#on.ringAlso }));
    if (!earlier) return part;
    const button = h("button", { type: "button", class: "text-button" }, t("Earlier changes"));
    const more = async () => {
      try {
        const { data } = /** @type {Answer<GroundHistoryPage>} */ (await get(earlier));
        button.replaceWith(this.#historyPart(data));
      } catch (error) {
        this.#on.failed(error, more);
      }
    };
    button.addEventListener("click", more);
    part.append(button);
    return part;
  }

  /** Carry out an act on the chosen record, then reload list and map. @param {() => Promise<unknown>} act @param {string} [words] */
  async #change(act, words) {
    try {
      await act();
      if (words) toast(words);
      await this.#on.reload();
    } catch (error) {
      const id = this.chosen?.feature.id;
      if (error instanceof ApiError && error.status === 412 && id !== undefined)
        toast(error.message, { label: t("Look"), act: () => this.choose(id) });
      else this.#on.failed(error);
    }
  }

  /** Posts to a sub-resource of the chosen record and shows what became of it. @param {string} name @param {unknown} body @param {string} words */
  #post(name, body, words) {
    if (!this.chosen) return;
    const { feature, etag } = this.chosen;
    this.#change(async () => {
      await post(`${this.#kind.path}/${feature.id}/${name}`, body, ifMatch(etag));
      await this.choose(feature.id, { stay: true });
    }, words);
  }

  #follow() {
    this.#post("follow-source", undefined, t("It follows its source again."));
  }

  /** @param {GroundHistoryEntry} entry */
  #revert(entry) {
    this.#post("revert", { entry: entry.id }, t("What was before is back."));
  }

  #takeOff() {
    if (!this.chosen) return;
    const { feature, etag } = this.chosen;
    const address = `${this.#kind.path}/${feature.id}`;
    const name = this.#kind.title(feature);
    this.#change(async () => {
      await remove(address, ifMatch(etag));
      const { data } = /** @type {Answer<GroundHistoryPage>} */ (await get(`${address}/history`));
      this.back();
      const restore = async () => {
        await post(`/history/${data.results[0].id}/undo`);
        await this.choose(feature.id, { stay: true });
      };
      const act = () => this.#change(restore, t("It is back."));
      toast(t("{name} deleted.", { name }), { label: t("Undo"), act });
    });
  }
}

/** @param {number | string | null} id */
function rememberAddress(id) {
  const address = new URL(location.href);
  if (id) address.searchParams.set("id", String(id));
  else address.searchParams.delete("id");
  history.replaceState(history.state, "", address);
}
