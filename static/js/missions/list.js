/** The list of missions: its query, the pages of the answer, and the chosen missions. */

import { ApiError, get } from "../api.js";
import { createStore } from "../store.js";
import { t } from "../text.js";
import { askedOf, NOTHING, requestOf, searchOf } from "./asked.js";

/** @import { Answer } from "../api.js" */
/** @import { MissionFilters, MissionPage } from "../api_types.d.ts" */
/** @import { Asked } from "./asked.js" */

/**
 * @typedef {object} ListState
 * @property {Asked} asked
 * @property {MissionPage["results"] | null} missions null: not loaded yet
 * @property {string} address of the page in the API
 * @property {string | null} next address of the page after it
 * @property {number} total
 * @property {MissionPage["by_state"]} byState of those that are not deleted; empty until they were listed
 * @property {number} deletedCount
 * @property {string[]} pages addresses of the pages before it
 * @property {ReadonlySet<string>} chosen ids
 * @property {MissionFilters} filters
 * @property {{ title: string, text: string, isOut?: boolean } | null} problem
 * @property {boolean} isBusy
 */
/** @typedef {ReturnType<typeof createList>} MissionList */

/** Returns the store of the list and what loads it. */
export function createList() {
  const store = createStore(
    /** @type {ListState} */ ({
      asked: askedOf(location.search),
      missions: null,
      address: "",
      next: null,
      total: 0,
      byState: {},
      deletedCount: 0,
      pages: [],
      chosen: new Set(),
      filters: { authors: [], uavs: [] },
      problem: null,
      isBusy: false,
    }),
  );
  /** @type {AbortController | null} */
  let loading = null;

  /** @param {unknown} error @param {string} title */
  function showProblem(error, title) {
    if (!(error instanceof ApiError)) throw error;
    const isOut = error.isSignedOut;
    store.update({
      problem: isOut
        ? { title: t("You are signed out."), text: t("Sign in to go on."), isOut }
        : { title, text: error.message },
    });
  }

  /**
   * Load the page at an address of the API; of two at once the later one counts.
   *
   * @param {string} [address]
   * @param {string[]} [pages] addresses of the pages before it
   * @returns {Promise<void>}
   */
  async function load(address = requestOf(store.state.asked), pages = []) {
    loading?.abort();
    const mine = new AbortController();
    loading = mine;
    store.update({ isBusy: true });
    try {
      const { data } = /** @type {Answer<MissionPage>} */ (await get(address, { signal: mine.signal }));
      const before = pages.at(-1);
      if (!data.results.length && before) {
        await load(before, pages.slice(0, -1)); // the last one of the page was removed
        return;
      }
      store.update({
        missions: data.results,
        next: data.next,
        total: data.total,
        byState: store.state.asked.deleted ? store.state.byState : data.by_state,
        deletedCount: data.deleted_count,
        pages,
        address,
        chosen: new Set(),
        problem: null,
      });
    } catch (error) {
      if (!(error instanceof DOMException && error.name === "AbortError")) showProblem(error, t("Not loaded."));
    } finally {
      if (loading === mine) store.update({ isBusy: false });
    }
  }

  /** @param {Partial<Asked>} change */
  function ask(change) {
    const asked = { ...store.state.asked, ...change };
    store.update({ asked });
    history.replaceState(null, "", `/${searchOf(asked)}`);
    return load();
  }

  return {
    store,
    load,
    ask,
    showProblem,
    reload: () => load(store.state.address || undefined, store.state.pages),
    clearFilters: () => ask({ ...NOTHING, order: store.state.asked.order }),

    async loadFilters() {
      try {
        const { data } = /** @type {Answer<MissionFilters>} */ (await get("/missions/filters"));
        store.update({ filters: data });
      } catch (error) {
        showProblem(error, t("Not loaded."));
      }
    },

    /** @param {string[]} ids @param {boolean} isChosen */
    choose(ids, isChosen) {
      const chosen = new Set(store.state.chosen);
      for (const id of ids) isChosen ? chosen.add(id) : chosen.delete(id);
      store.update({ chosen });
    },
  };
}
