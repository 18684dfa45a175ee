/** The unsaved selection, kept in this browser for each user until it is saved. */

import { t } from "../../text.js";
import { EMPTY, storedBasisOf } from "../selection.js";

/** @import { Draft, Version } from "../types.d.ts" */
/** @import { Mission } from "../../api_types.d.ts" */

/**
 * Key of a user's own draft, also where several users share a browser.
 *
 * @param {number} user
 * @param {string | null} mission
 */
export const keyOf = (user, mission) => `spanwise.draft.${user}.${mission ?? "new"}`;

/**
 * Drafts of one user. `editor` identifies this page: drafts of another window of the same user are kept when this one saves.
 *
 * @param {{ user: number, editor: string, storage?: () => Storage }} options
 */
export function createDrafts({ user, editor, storage = () => globalThis.localStorage }) {
  /** @param {string | null} mission @returns {Draft | null} */
  function read(mission) {
    try {
      const draft = JSON.parse(storage().getItem(keyOf(user, mission)) ?? "null");
      return Array.isArray(draft?.selection?.targets) && Array.isArray(draft.selection.uavs) ? draft : null;
    } catch {
      return null;
    }
  }

  /** @param {string | null} mission */
  function drop(mission) {
    try {
      storage().removeItem(keyOf(user, mission));
    } catch {
      /* not stored */
    }
  }

  return {
    read,
    drop,
    /** @param {string | null} mission */
    dropOwn(mission) {
      if (read(mission)?.editor === editor) drop(mission);
    },
    /**
     * draft: { name, selection, revision }. False where storage is full or unavailable: leaving the page then asks first.
     *
     * @param {string | null} mission
     * @param {Omit<Draft, "editor" | "kept_at">} draft
     */
    keep(mission, draft) {
      try {
        storage().setItem(
          keyOf(user, mission),
          JSON.stringify({ ...draft, editor, kept_at: new Date().toISOString() }),
        );
        return true;
      } catch {
        return false;
      }
    },
  };
}

/**
 * Whether a new mission has content that a reload should restore, even a single chosen UAV or option.
 *
 * @param {Version} version
 */
export function isStarted({ name, selection }) {
  return name.trim() !== "" || storedBasisOf(selection) !== storedBasisOf(EMPTY);
}

/**
 * What to do with a draft of a stored mission: "none", "restore", or "behind" where another user has saved since.
 *
 * @param {Draft | null} draft
 * @param {Pick<Mission, "name" | "revision">} mission
 * @param {string | null} storedBasis
 * @returns {"none" | "restore" | "behind"}
 */
export function draftDecision(draft, mission, storedBasis) {
  if (!draft) return "none";
  const isSame = storedBasisOf(draft.selection) === storedBasis && (draft.name || mission.name) === mission.name;
  if (isSame) return "none";
  return draft.revision === mission.revision ? "restore" : "behind";
}

/**
 * "vera's", "your own" or "another operator's": the author of the other save.
 *
 * @param {string | null | undefined} actor
 * @param {string} userName
 */
export function whoseSave(actor, userName) {
  if (!actor) return t("another operator’s");
  return actor === userName ? t("your own") : t("{name}’s", { name: actor });
}
