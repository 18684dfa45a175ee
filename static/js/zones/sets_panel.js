/** Sets and sources: where zones come from, how old they are, earlier states, and what is fetched by itself. */

import { ApiError, follow, get, patch, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { countText, whenText } from "../units.js";

const FORMATS = [
  ["", t("found out from the file")],
  ["ed269", "ED-269"],
  ["ed318", "ED-318"],
  ["openair", "OpenAir"],
  ["geojson", "GeoJSON"],
];
const term = (name, value) => (value ? [h("dt", {}, name), h("dd", {}, value)] : []);
/** "from 1 Jan until 31 Dec": what a file states of itself. */
export const validityText = ({ valid_from: from, valid_until: until }) =>
  [from && t("from {when}", { when: whenText(from) }), until && t("until {when}", { when: whenText(until) })]
    .filter(Boolean)
    .join(" ");

export function mountSetsPanel({ canCurate, showZones }) {
  const place = byId("zone-sets");
  let sets = [];

  async function load() {
    try {
      sets = [];
      for (let next = "/zone-sets?limit=200"; next; ) {
        const { data } = await get(next);
        sets.push(...data.results);
        next = data.next;
      }
      draw();
    } catch (error) {
      toast(error.message, { label: t("Try again"), act: load });
    }
  }

  async function attempt(act, words) {
    try {
      await act();
      if (words) toast(words);
      await load();
    } catch (error) {
      toast(error.message);
      if (!(error instanceof ApiError)) throw error;
    }
  }

  function draw() {
    place.replaceChildren(
      canCurate &&
        h(
          "section",
          { class: "panel-section" },
          h(
            "button",
            { type: "button", class: "button", onclick: () => askSubscription() },
            icon("plus", "small"),
            t("Fetch a source by itself"),
          ),
        ),
      sets.length
        ? h("div", {}, sets.map(oneSet))
        : h(
            "div",
            { class: "record-end" },
            h(
              "div",
              { class: "empty" },
              h("strong", {}, t("No sets yet.")),
              h("span", {}, t("Bring in an ED-269, ED-318, OpenAir or GeoJSON file, or have one fetched.")),
              canCurate && h("a", { class: "button", href: "/imports" }, t("Import a file")),
            ),
          ),
    );
  }

  function oneSet(set) {
    const { source, subscription } = set;
    return h(
      "section",
      { class: "set", "aria-label": set.name },
      h(
        "div",
        { class: "set-head" },
        h("strong", {}, set.name),
        h("span", { class: "caption" }, countText(set.zone_count, "zone")),
      ),
      h(
        "dl",
        { class: "facts" },
        term(t("File"), source?.file_name),
        term(t("Format"), set.source_format),
        term(t("Licence"), source?.licence || (source ? t("not stated") : "")),
        term(t("Attribution"), source?.attribution),
        term(t("Address"), source?.source_address),
        term(t("Fetched"), source?.fetched_at && whenText(source.fetched_at)),
        term(t("Imported"), source?.imported_at && whenText(source.imported_at)),
        term(t("Valid"), source ? validityText(source) || t("not stated") : ""),
        term(
          t("Edited"),
          set.edited_count ? tn(set.edited_count, "{count} zone by hand", "{count} zones by hand") : "",
        ),
        subscription && term(t("Subscription"), subscriptionWords(subscription)),
      ),
      subscription?.problem &&
        h(
          "div",
          { class: "notice warning" },
          icon("triangle-alert"),
          h("p", {}, h("strong", {}, `${t("Not fetched.")} `), subscription.problem),
        ),
      subscription?.proposal?.state === "ready" &&
        h(
          "div",
          { class: "notice advisory" },
          icon("info"),
          h(
            "p",
            {},
            h("strong", {}, `${t("A new version waits.")} `),
            h("a", { href: `/imports/${subscription.proposal.id}` }, t("See the difference")),
          ),
        ),
      h(
        "div",
        { class: "record-acts" },
        h("button", { type: "button", class: "button", onclick: () => showZones(set) }, t("Its zones")),
        canCurate &&
          set.version_count > 0 &&
          h(
            "button",
            { type: "button", class: "button", onclick: () => askVersion(set) },
            icon("history", "small"),
            countText(set.version_count, "version"),
          ),
        canCurate &&
          subscription &&
          h(
            "button",
            { type: "button", class: "button", onclick: () => fetchNow(subscription) },
            icon("refresh-cw", "small"),
            t("Fetch now"),
          ),
        canCurate &&
          subscription &&
          h("button", { type: "button", class: "text-button", onclick: () => askSubscription(set) }, t("Change")),
      ),
    );
  }

  const subscriptionWords = ({ is_active, interval_h, fetched_at }) =>
    is_active
      ? `${t("every {hours}\u00a0h", { hours: interval_h })}, ${fetched_at ? t("source last answered {when}", { when: whenText(fetched_at) }) : t("not fetched yet")}`
      : t("paused");

  async function fetchNow(subscription) {
    await attempt(async () => {
      toast(t("Fetching…"));
      const { data } = await post(`/zone-subscriptions/${subscription.id}/fetch`);
      const job = await follow(data.job.id ?? data.job);
      toast(
        job.result?.proposal && job.result.is_new ? t("Something new: look at the difference.") : t("Nothing new."),
        job.result?.proposal && job.result.is_new
          ? { label: t("See it"), act: () => (location.href = `/imports/${job.result.proposal}`) }
          : null,
      );
    });
  }

  function openDialog(title, ...content) {
    const dialog = h("dialog", { "aria-label": title }, h("h2", {}, title), ...content);
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
    return dialog;
  }

  async function askVersion(set) {
    const { data } = await get(`/zone-sets/${set.id}/versions`);
    const dialog = openDialog(
      t("Versions of {name}", { name: set.name }),
      h("p", { class: "caption" }, t("Going back is shown as a difference first.")),
      h(
        "ol",
        { class: "history-list" },
        data.results.map((version, index) =>
          h(
            "li",
            {},
            h(
              "div",
              { class: "history-head" },
              h(
                "strong",
                {},
                index === 0
                  ? t("Version {number}, the newest", { number: version.version })
                  : t("Version {number}", { number: version.version }),
              ),
              h(
                "span",
                { class: "caption" },
                [
                  countText(version.zone_count, "zone"),
                  whenText(version.created_at),
                  version.created_by,
                  version.source?.file_name,
                ]
                  .filter(Boolean)
                  .join(" · "),
              ),
            ),
            h(
              "button",
              { type: "button", class: "text-button", onclick: () => rollBack(set, version, dialog) },
              icon("undo-2", "small"),
              t("Go back to this"),
            ),
          ),
        ),
      ),
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Close")),
      ),
    );
  }

  async function rollBack(set, version, dialog) {
    dialog.close();
    await attempt(async () => {
      const { data } = await post(`/zone-sets/${set.id}/roll-back`, { version: version.version });
      location.href = `/imports/${data.id}`;
    });
  }

  function askSubscription(set = null) {
    const old = set?.subscription;
    const input = (id, words, rest) =>
      h(
        "div",
        { class: "field" },
        h("label", { for: id }, words),
        h("input", { class: "input", id, autocomplete: "off", ...rest }),
      );
    const form = h(
      "form",
      {},
      !old && input("subscription-set", t("Name of the set"), { required: true, maxlength: 200 }),
      input("subscription-address", t("Address of the file"), {
        type: "url",
        required: true,
        placeholder: "https://",
        maxlength: 500,
        value: old?.address ?? "",
      }),
      h(
        "div",
        { class: "pair" },
        h(
          "div",
          { class: "field" },
          h("label", { for: "subscription-format" }, t("Format")),
          h(
            "select",
            { class: "input", id: "subscription-format" },
            FORMATS.map(([value, words]) =>
              h("option", { value, selected: value === (old?.source_format ?? "") }, words),
            ),
          ),
        ),
        input("subscription-interval", t("Every … hours"), {
          type: "number",
          min: 1,
          max: 8760,
          required: true,
          value: String(old?.interval_h ?? 24),
        }),
      ),
      input("subscription-licence", t("Licence"), { maxlength: 200, value: old?.licence ?? "" }),
      input("subscription-attribution", t("Attribution"), { maxlength: 300, value: old?.attribution ?? "" }),
      h(
        "p",
        { class: "caption" },
        t("What it brings is shown as a difference; nothing is replaced before somebody applies it."),
      ),
      h("p", { class: "field-error", id: "subscription-fault", hidden: true }),
      h(
        "div",
        { class: "acts" },
        old &&
          h(
            "button",
            {
              type: "button",
              class: "button danger",
              onclick: () => (
                dialog.close(),
                attempt(() => remove(`/zone-subscriptions/${old.id}`), t("No longer fetched. Its zones stay."))
              ),
            },
            t("Fetch no longer"),
          ),
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
        h("button", { type: "submit", class: "button primary" }, old ? t("Save") : t("Subscribe")),
      ),
    );
    const dialog = openDialog(old ? t("Source of {name}", { name: set.name }) : t("Fetch a source by itself"), form);
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const value = (id) => byId(id).value.trim();
      const body = {
        address: value("subscription-address"),
        source_format: value("subscription-format"),
        interval_h: Number(value("subscription-interval")),
        licence: value("subscription-licence"),
        attribution: value("subscription-attribution"),
      };
      try {
        if (old) await patch(`/zone-subscriptions/${old.id}`, body);
        else await post("/zone-subscriptions", { set_name: value("subscription-set"), ...body });
        dialog.close();
        toast(old ? t("Saved.") : t("Subscribed. It is fetched within a minute."));
        await load();
      } catch (error) {
        const fault = byId("subscription-fault");
        fault.hidden = false;
        fault.textContent = error.message;
      }
    });
  }

  return { load };
}
