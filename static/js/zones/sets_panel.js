/** Sets and sources: the origin of zones, their age, earlier states, and automatic fetching. */

import { ApiError, follow, get, post } from "../api.js";
import { byId, h, icon, setChildren, term } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { whenText } from "../units.js";
import { askSubscription, openDialog } from "./subscription_dialog.js";

/** @import { Answer } from "../api.js" */
/** @import { FetchJob, Proposal, ZoneSet, ZoneSetPage, ZoneSetVersion, ZoneSetVersionPage, ZoneSubscription } from "../api_types.d.ts" */
/** @import { Child } from "../dom.js" */

/** "from 1 Jan until 31 Dec": what a file states of itself. @param {{ valid_from: string | null, valid_until: string | null }} source */
export const validityText = ({ valid_from: from, valid_until: until }) =>
  [from && t("from {when}", { when: whenText(from) }), until && t("until {when}", { when: whenText(until) })]
    .filter(Boolean)
    .join(" ");

/** @typedef {{ canCurate: boolean, askFile: () => void, showZones: (set: ZoneSet) => void }} SetsOptions */

/** @param {SetsOptions} options */
export const mountSetsPanel = (options) => new SetsPanel(options);

class SetsPanel {
  #canCurate;
  #showZones;
  #askFile;
  #place = byId("zone-sets");
  /** @type {ZoneSet[]} */
  #sets = [];

  /** @param {SetsOptions} options */
  constructor({ canCurate, askFile, showZones }) {
    this.#canCurate = canCurate;
    this.#askFile = askFile;
    this.#showZones = showZones;
  }

  load = async () => {
    try {
      this.#sets = [];
      /** @type {string | null} */
      let next = "/zone-sets?limit=200";
      while (next) {
        const { data } = /** @type {Answer<ZoneSetPage>} */ (await get(next));
        this.#sets.push(...data.results);
        next = data.next;
      }
      this.#draw();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message, { label: t("Try again"), act: this.load });
    }
  };

  /** Carry out an act, then read the sets again. @param {() => Promise<unknown>} act @param {string} [words] */
  #attempt = async (act, words) => {
    try {
      await act();
      if (words) toast(words);
      await this.load();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    }
  };

  /** @param {ZoneSet | null} set */
  #askSubscription(set) {
    askSubscription(set, { attempt: this.#attempt, reload: this.load });
  }

  #draw() {
    const subscribe = () => this.#askSubscription(null);
    const button = h("button", { type: "button", class: "button", onclick: subscribe });
    setChildren(button, icon("plus", "small"), t("Subscribe to a zone source"));
    setChildren(
      this.#place,
      this.#canCurate &&
        h(
          "section",
          { class: "panel-section zone-sources" },
          h(
            "button",
            { type: "button", class: "button", onclick: this.#askFile },
            icon("upload", "small"),
            t("Import a file"),
          ),
          button,
        ),
      this.#sets.length
        ? h(
            "div",
            {},
            this.#sets.map((set) => this.#oneSet(set)),
          )
        : this.#nothing(),
    );
  }

  #nothing() {
    return h(
      "div",
      { class: "record-end" },
      h(
        "div",
        { class: "empty" },
        h("strong", {}, t("No sets yet.")),
        h("span", {}, t("Bring in an ED-269, ED-318, OpenAir or GeoJSON file, or have one fetched.")),
      ),
    );
  }

  /** @param {ZoneSet} set */
  #oneSet(set) {
    return h(
      "section",
      { class: "set", "aria-label": set.name },
      h(
        "div",
        { class: "set-head" },
        h("strong", {}, set.name),
        h("span", { class: "caption" }, tn(set.zone_count, "{count} zone", "{count} zones")),
      ),
      factsOf(set),
      noticesOf(set),
      h("div", { class: "record-acts" }, this.#acts(set)),
    );
  }

  /** @param {ZoneSet} set */
  #acts(set) {
    const { subscription } = set;
    /** @param {string} kind @param {() => unknown} act @param {...Child} words */
    const button = (kind, act, ...words) => h("button", { type: "button", class: kind, onclick: act }, words);
    return [
      button("button", () => this.#showZones(set), t("Show zones")),
      this.#canCurate &&
        set.version_count > 0 &&
        button("button", () => this.#askVersion(set), icon("history", "small"), t("Version history")),
      this.#canCurate &&
        subscription && [
          button("button", () => this.#fetchNow(subscription), icon("refresh-cw", "small"), t("Fetch now")),
          button("text-button", () => this.#askSubscription(set), t("Change")),
        ],
    ];
  }

  /** @param {ZoneSubscription} subscription */
  async #fetchNow(subscription) {
    await this.#attempt(async () => {
      toast(t("Fetching…"));
      const { data } = /** @type {Answer<FetchJob>} */ (await post(`/zone-subscriptions/${subscription.id}/fetch`));
      const job = await follow(data.job);
      const result = /** @type {{ proposal?: string, is_new?: boolean } | null} */ (job.result);
      if (!result?.proposal || !result.is_new) {
        toast(t("Nothing new."));
        return;
      }
      const see = () => location.assign(`/imports/${result.proposal}`);
      toast(t("Something new: look at the difference."), { label: t("See it"), act: see });
    });
  }

  /** @param {ZoneSet} set */
  async #askVersion(set) {
    const { data } = /** @type {Answer<ZoneSetVersionPage>} */ (await get(`/zone-sets/${set.id}/versions`));
    const close = () => dialog.close();
    /** @param {ZoneSetVersion} version */
    const rollBack = (version) => {
      dialog.close();
      this.#rollBack(set, version);
    };
    /** @type {HTMLDialogElement} */
    const dialog = openDialog(
      t("Versions of {name}", { name: set.name }),
      h("p", { class: "caption" }, t("Going back is shown as a difference first.")),
      h(
        "ol",
        { class: "history-list" },
        data.results.map((version, index) => versionRow(version, index === 0, () => rollBack(version))),
      ),
      h("div", { class: "acts" }, h("button", { type: "button", class: "button", onclick: close }, t("Close"))),
    );
  }

  /** @param {ZoneSet} set @param {ZoneSetVersion} version */
  async #rollBack(set, version) {
    await this.#attempt(async () => {
      const address = `/zone-sets/${set.id}/roll-back`;
      const { data } = /** @type {Answer<Proposal>} */ (await post(address, { version: version.version }));
      location.assign(`/imports/${data.id}`);
    });
  }
}

/** @param {ZoneSet} set */
function factsOf({ source, subscription, source_format, edited_count }) {
  const edited = edited_count ? tn(edited_count, "{count} zone by hand", "{count} zones by hand") : "";
  return h(
    "dl",
    { class: "facts" },
    term(t("File"), source?.file_name),
    term(t("Format"), source_format),
    term(t("Licence"), source?.licence || (source ? t("not stated") : "")),
    term(t("Attribution"), source?.attribution),
    term(t("Address"), source?.source_address),
    term(t("Fetched"), source?.fetched_at && whenText(source.fetched_at)),
    term(t("Imported"), source?.imported_at && whenText(source.imported_at)),
    term(t("Valid"), source ? validityText(source) || t("not stated") : ""),
    term(t("Edited"), edited),
    subscription && term(t("Subscription"), subscriptionWords(subscription)),
  );
}

/** Faults of the source, and its waiting changes. @param {ZoneSet} set */
function noticesOf({ subscription }) {
  const proposal = subscription?.proposal;
  return [
    subscription?.problem &&
      h(
        "div",
        { class: "notice warning" },
        icon("triangle-alert"),
        h("p", {}, h("strong", {}, `${t("Not fetched.")} `), subscription.problem),
      ),
    proposal?.state === "ready" &&
      h(
        "div",
        { class: "notice advisory" },
        icon("info"),
        h(
          "p",
          {},
          h("strong", {}, `${t("A new version waits.")} `),
          h("a", { href: `/imports/${proposal.id}` }, t("See the difference")),
        ),
      ),
  ];
}

/** @param {ZoneSubscription} subscription */
function subscriptionWords({ is_active, interval_h, fetched_at }) {
  if (!is_active) return t("paused");
  const last = fetched_at ? t("source last answered {when}", { when: whenText(fetched_at) }) : t("not fetched yet");
  return `${t("every {hours}\u00a0h", { hours: interval_h })}, ${last}`;
}

/** @param {ZoneSetVersion} version @param {boolean} isNewest @param {() => void} rollBack */
function versionRow({ version: number, zone_count, created_at, created_by, source }, isNewest, rollBack) {
  const facts = [tn(zone_count, "{count} zone", "{count} zones"), whenText(created_at), created_by, source?.file_name];
  const title = isNewest ? t("Version {number}, the newest", { number }) : t("Version {number}", { number });
  return h(
    "li",
    {},
    h(
      "div",
      { class: "history-head" },
      h("strong", {}, title),
      h("span", { class: "caption" }, facts.filter(Boolean).join(" · ")),
    ),
    h(
      "button",
      { type: "button", class: "text-button", onclick: rollBack },
      icon("undo-2", "small"),
      t("Go back to this"),
    ),
  );
}
