/** Acts on missions of the list: rename, duplicate, delete and restore. */

import { ApiError, patch, post } from "../api.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission, MissionSummary, MissionsDone } from "../api_types.d.ts" */
/** @import { MissionList } from "./list.js" */

/** @typedef {Pick<MissionSummary, "id" | "name">} Named */
/** @typedef {{ one: (name: string) => string, many: (count: number) => string, failed: string }} Outcomes texts of an act */

/** @type {Outcomes} */
const DELETED = {
  one: (name) => t("“{name}” is deleted.", { name }),
  many: (count) => tn(count, "{count} mission is deleted.", "{count} missions are deleted."),
  failed: t("Not deleted."),
};
/** @type {Outcomes} */
const BACK = {
  one: (name) => t("“{name}” is back.", { name }),
  many: (count) => tn(count, "{count} mission is back.", "{count} missions are back."),
  failed: t("Not brought back."),
};

/** @param {MissionList} list */
export function createActs({ reload, showProblem }) {
  /** @param {Named & { revision: number }} mission @param {string} name @returns {Promise<void>} */
  async function rename(mission, name) {
    try {
      const { data } = /** @type {Answer<Mission>} */ (
        await patch(`/missions/${mission.id}`, { name }, { headers: { "If-Match": `"${mission.revision}"` } })
      );
      await reload();
      toast(t("“{before}” is now “{name}”.", { before: mission.name, name: data.name }), {
        label: t("Undo"),
        act: () => rename({ ...mission, name: data.name, revision: data.revision }, mission.name),
      });
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 412) return showProblem(error, t("Not renamed."));
      await reload();
      showProblem(new ApiError(t("Somebody has changed the mission since; this is how it is now.")), t("Not renamed."));
    }
  }

  /** @param {Named} mission */
  async function duplicate(mission) {
    try {
      const { data } = /** @type {Answer<Mission>} */ (
        await post(
          `/missions/${mission.id}/duplicate`,
          {},
          { headers: { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } },
        )
      );
      await reload();
      toast(t("“{name}” is there.", { name: data.name }), {
        label: t("Open|verb"),
        act: () => location.assign(`/missions/${data.id}`),
      });
    } catch (error) {
      showProblem(error, t("Not duplicated."));
    }
  }

  /**
   * Delete or restore missions; shows the count, and the reason of a refusal.
   *
   * @param {Named[]} missions
   * @param {"delete" | "restore"} path
   * @param {Outcomes} words
   * @param {((missions: Named[]) => unknown) | null} undo
   */
  async function doTo(missions, path, words, undo) {
    try {
      const { data } = /** @type {Answer<MissionsDone>} */ (
        await post(`/missions/${path}`, { missions: missions.map(({ id }) => id) })
      );
      await reload();
      const done = missions.filter(({ id }) => data.done.includes(id));
      if (done.length)
        toast(
          done.length === 1 ? words.one(done[0].name) : words.many(done.length),
          undo && { label: t("Undo"), act: () => undo(done) },
        );
      if (data.refused.length) {
        const [first] = data.refused;
        const name = missions.find(({ id }) => id === first.id)?.name ?? "";
        showProblem(
          new ApiError(`“${name}”: ${first.message}`),
          tn(data.refused.length, "{count} mission stays as it is.", "{count} missions stay as they are."),
        );
      }
    } catch (error) {
      showProblem(error, words.failed);
    }
  }

  /** @param {Named[]} missions */
  const bringBack = (missions) => doTo(missions, "restore", BACK, null);
  /** @param {Named[]} missions */
  const removeAll = (missions) => doTo(missions, "delete", DELETED, bringBack);

  return { rename, duplicate, removeAll, bringBack };
}

/** @param {Named} mission */
export async function copyAddress(mission) {
  const address = `${location.origin}/missions/${mission.id}`;
  try {
    await navigator.clipboard.writeText(address);
    toast(t("Link to “{name}” copied.", { name: mission.name }));
  } catch {
    toast(address); // without the clipboard: there to be marked and copied
  }
}
