/** A dialog with the organisation's saved selections: keep the present targets under a name, load, rename, bring up to date, delete. */

import { ApiError, get, patch, post, remove } from "../../api.js";
import { h, icon } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { dayText } from "../../units.js";
import { requestOf, storedTarget } from "../selection.js";

const wordsOf = (error) => (error instanceof ApiError ? error.message : t("That did not work. Try again."));

async function allSelections() {
  const rows = [];
  for (let next = "/selections?limit=200"; next; ) {
    const { data } = await get(next);
    rows.push(...data.results);
    next = data.next;
  }
  return rows;
}

export function showSelections(store, actions) {
  const dialog = h("dialog", { class: "selections", "aria-labelledby": "selections-title" });
  const list = h("ul", { class: "selection-list", "aria-label": t("Saved selections") });
  const wrong = h("p", { class: "field-error", role: "alert" });
  const done = h("p", { class: "selection-done", role: "status" });
  const name = h("input", {
    class: "input",
    id: "selection-name",
    maxlength: "100",
    required: true,
    autocomplete: "off",
  });
  const picked = () => store.state.selection;
  const targetsNow = () => requestOf(picked()).targets;
  const close = h("button", { class: "button" }, t("Close"));
  let rows = [];

  /** Said in the dialog: what lies behind it cannot be reached. */
  const tell = (words, act = null) =>
    done.replaceChildren(
      words,
      act ? h("button", { type: "button", class: "text-button", onclick: act }, t("Undo")) : "",
    );

  const told =
    (work) =>
    async (...values) => {
      wrong.textContent = "";
      done.replaceChildren();
      try {
        await work(...values);
      } catch (error) {
        wrong.textContent = wordsOf(error);
        if (error.status === 412 || error.status === 404) await refresh().catch(() => {}); // what went wrong is said already
      }
    };

  async function refresh() {
    rows = await allSelections();
    draw();
  }

  const keep = told(async () => {
    const { data } = await post("/selections", { name: name.value.trim(), targets: targetsNow() });
    name.value = "";
    await refresh();
    tell(t("“{name}” is kept.", { name: data.name }));
  });

  const load = told(async (row, { instead }) => {
    const { data } = await get(`/selections/${row.id}`);
    const targets = data.targets.map(storedTarget);
    dialog.close();
    if (instead) actions.replaceTargets(targets, t("The targets of “{name}” are picked.", { name: data.name }));
    else actions.addMany(targets, (added) => t("{added} from “{name}”.", { added, name: data.name }));
    if (data.missing.length)
      actions.tell(
        tn(
          data.missing.length,
          "{count} target is no longer in the data.",
          "{count} targets are no longer in the data.",
        ),
        data.missing.join(", "),
      );
  });

  const etag = (row) => ({ headers: { "If-Match": `"${row.revision}"` } });

  function rename(row) {
    const input = h("input", {
      class: "input",
      value: row.name,
      maxlength: "100",
      required: true,
      "aria-label": t("New name of {name}", { name: row.name }),
    });
    const place = list.querySelector(`[data-selection="${row.id}"] .what`);
    const give = told(async () => {
      await patch(`/selections/${row.id}`, { name: input.value.trim() }, etag(row));
      await refresh();
    });
    const form = h(
      "form",
      { class: "rename", onsubmit: (event) => (event.preventDefault(), give()) },
      input,
      h("button", { class: "button" }, t("Rename")),
    );
    input.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      event.stopPropagation();
      draw();
    });
    place.replaceChildren(form);
    input.select();
  }

  const bringUpToDate = told(async (row) => {
    await patch(`/selections/${row.id}`, { targets: targetsNow() }, etag(row));
    await refresh();
    tell(t("“{name}” holds the present targets now.", { name: row.name }));
  });

  const drop = told(async (row) => {
    const { data } = await get(`/selections/${row.id}`);
    await remove(`/selections/${row.id}`, etag(row));
    await refresh();
    const targets = requestOf({ targets: data.targets.map(storedTarget), uavs: [] }).targets;
    const back = told(async () => {
      await post("/selections", { name: row.name, targets });
      await refresh();
    });
    tell(t("“{name}” is deleted.", { name: row.name }), targets.length ? back : null);
    (done.querySelector("button") ?? close).focus();
  });

  function rowOf(row) {
    const facts = [
      tn(row.target_count, "{count} target", "{count} targets"),
      row.author,
      dayText(new Date(row.updated_at)),
    ]
      .filter(Boolean)
      .join(" · ");
    const act = (sign, work, words) =>
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("{act}: {name}", { act: words, name: row.name }),
          title: words,
          onclick: () => work(row),
        },
        icon(sign, "small"),
      );
    const canKeep = picked().targets.length > 0;
    return h(
      "li",
      { "data-selection": row.id },
      h("div", { class: "what" }, h("strong", {}, row.name), h("small", {}, facts)),
      h(
        "button",
        {
          type: "button",
          class: "button",
          "aria-label": t("Add {name}", { name: row.name }),
          onclick: () => load(row, { instead: false }),
        },
        t("Add"),
      ),
      canKeep &&
        h(
          "button",
          {
            type: "button",
            class: "button quiet",
            "aria-label": t("Take {name} instead", { name: row.name }),
            onclick: () => load(row, { instead: true }),
          },
          t("Instead"),
        ),
      act("pencil", rename, t("Rename")),
      canKeep && act("refresh-cw", bringUpToDate, t("Keep the present targets in it")),
      act("trash-2", drop, t("Delete")),
    );
  }

  function draw() {
    if (rows.length) list.replaceChildren(...rows.map(rowOf));
    else
      list.replaceChildren(
        h(
          "li",
          { class: "quiet-text" },
          t("Nothing is kept yet. Pick targets, then keep them under a name: everybody here can load them."),
        ),
      );
  }

  const count = picked().targets.length;
  dialog.append(
    h(
      "div",
      { class: "stack" },
      h("h2", { id: "selections-title" }, t("Saved selections")),
      count > 0 &&
        h(
          "form",
          { class: "keep", onsubmit: (event) => (event.preventDefault(), keep()) },
          h(
            "div",
            { class: "field" },
            h(
              "label",
              { for: "selection-name" },
              tn(count, "Keep the {count} picked target as", "Keep the {count} picked targets as"),
            ),
            name,
          ),
          h("button", { class: "button primary" }, t("Keep")),
        ),
      wrong,
      done,
      list,
      h("form", { method: "dialog", class: "acts" }, close),
    ),
  );
  list.append(h("li", { class: "quiet-text" }, t("Loading…")));
  open(dialog);
  if (count) name.focus();
  told(refresh)();
}
