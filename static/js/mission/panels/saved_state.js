/** Indicator of whether the page is saved, and of other users who have it open; always visible. */

import { byId, h, icon } from "../../dom.js";
import { t, tn } from "../../text.js";
import { clockText, exactText } from "../../units.js";
import { isUnsaved } from "../plan/plan_view.js";

/** @import { Present } from "../../api_types.d.ts" */
/** @import { MissionPageState, MissionStore } from "../types.d.ts" */

/** @typedef {{ words: string, image: string, isBad?: boolean, at?: string }} SavedWords `at`: when it was saved */

/** Text on whether the selection is saved. @param {MissionPageState} state @returns {SavedWords | null} */
export function savedWords(state) {
  const { mission, saving, problem, conflict, isAway } = state;
  if (!mission && !isUnsaved(state)) return null;
  if (saving) return { words: t("Saving…"), image: "loader-circle" };
  if (!mission && isAway) return { words: t("No connection. Kept in this browser."), image: "cloud-off", isBad: true };
  if (!mission) return { words: t("Kept in this browser until it is planned or saved"), image: "info" };
  if (!isUnsaved(state))
    return isAway
      ? {
          words: t("No connection. Saved {time}.", { time: clockText(mission.updated_at) }),
          image: "cloud-off",
          isBad: true,
        }
      : { words: t("Saved {time}", { time: clockText(mission.updated_at) }), image: "check", at: mission.updated_at };
  if (conflict)
    return {
      words: t("Not saved: {whose} save came in between", { whose: conflict.whose }),
      image: "triangle-alert",
      isBad: true,
    };
  if (isAway) return { words: t("Not saved: the server cannot be reached"), image: "cloud-off", isBad: true };
  if (problem?.isOfSaving) return { words: t("Not saved: see below"), image: "circle-alert", isBad: true };
  return { words: t("Not saved yet"), image: "circle-dashed" };
}

/** @param {Present[]} others */
function othersWords(others) {
  const names = others.map(({ name, is_me, is_planning }) => {
    const who = is_me ? t("you, in another window") : name;
    return is_planning ? t("{who} (planning)", { who }) : who;
  });
  return tn(others.length, "Also open: {names}", "Also open: {names}", { names: names.join(", ") });
}

/** @param {MissionStore} store @param {boolean} canPlan */
export function mountSavedState(store, canPlan) {
  const place = byId("save-state");
  store.listen(
    ["mission", "saving", "problem", "conflict", "isAway", "selection", "name", "plan", "planIsStored", "savedBasis"],
    (state) => {
      const found = canPlan
        ? savedWords(state)
        : state.isAway
          ? { words: t("No connection"), image: "cloud-off", isBad: true }
          : null;
      place.hidden = !found;
      if (!found) return;
      place.className = `save-state${found.isBad ? " bad" : ""}`;
      place.title = found.at ? exactText(found.at) : "";
      place.replaceChildren(icon(found.image, "small"), h("span", {}, found.words));
    },
  );
  store.listen(["others"], ({ others }) => {
    byId("others").hidden = others.length === 0;
    byId("others").replaceChildren(
      ...(others.length ? [icon("users", "small"), h("span", {}, othersWords(others))] : []),
    );
  });
}
