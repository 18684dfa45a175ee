/** The dock: the chosen gap in one sentence, its facts, and what can be done about it. */

import { byId, h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { coordinateText, whenText } from "../units.js";
import { cautionOf, dismissWords, factsOf } from "./kinds.js";

const LONGEST_NOTE = 500;

/**
 * on: { repair(body), dismiss(note), reopen(), preview(collection or null), place(tell), placeDone(offer), placeBack(), placeCancel(), next(), close() };
 * canCurate says whether they are offered. `place` begins to take places from the map and tells how many there are.
 * Returns { show(gap or null), refresh(the same gap), busy(whether), fault(sentence) }. `refresh` leaves alone what is being done in the panel.
 */
export function mountGapPanel(canCurate, on) {
  const dock = byId("dock");
  const panel = byId("gap-panel");
  let acts = null;
  let said = null;
  let drawn = ""; // the gap as it is shown
  let noting = null; // the form of a note, with the gap's id: it outlives a new drawing of the gap

  function show(gap) {
    dock.hidden = !gap;
    drawn = JSON.stringify(gap);
    if (gap?.id !== noting?.id || gap?.properties.state !== "open") noting = null;
    if (!gap) {
      panel.replaceChildren();
      return;
    }
    const { properties } = gap;
    acts = h("div", { class: "gap-acts" }, ...actsOf(gap));
    said = h("p", { class: "field-error", role: "alert" });
    const caution = properties.state === "open" ? cautionOf(properties) : "";
    panel.replaceChildren(
      h(
        "div",
        { class: "gap-words" },
        h("h2", { class: "gap-sentence" }, properties.sentence),
        h("p", { class: "gap-assets" }, assetWords(properties)),
        h(
          "dl",
          { class: "gap-facts" },
          [...factsOf(properties), [t("Place"), coordinateText(properties.position)]].map(([term, value]) =>
            h("div", {}, h("dt", {}, term), h("dd", {}, value)),
          ),
        ),
        caution && h("p", { class: "caption" }, caution),
        properties.state !== "open" &&
          h(
            "p",
            { class: "gap-decided" },
            icon(properties.state === "repaired" ? "circle-check" : "hand"),
            decidedWords(properties),
          ),
      ),
      h("div", { class: "gap-do" }, acts, said),
      h(
        "button",
        {
          class: "icon-button tight gap-close",
          type: "button",
          "aria-label": t("Close"),
          title: t("Close (Esc)"),
          onclick: on.close,
        },
        icon("x"),
      ),
    );
  }

  function refresh(gap) {
    if (JSON.stringify(gap) === drawn) return;
    const focused = panel.contains(document.activeElement) ? document.activeElement : null;
    show(gap);
    if (focused?.isConnected) focused.focus();
  }

  function actsOf(gap) {
    const { repairs, state } = gap.properties;
    if (!canCurate) return [h("p", { class: "caption" }, state === "open" ? t("Curators can repair this.") : "")];
    const following = h("button", { class: "button primary", type: "button", onclick: on.next }, t("Next gap"));
    if (state === "dismissed")
      return [
        following,
        h("button", { class: "button", type: "button", onclick: on.reopen }, icon("undo-2"), t("Open it again")),
      ];
    if (state === "repaired") return [following];
    return [...repairs.flatMap((offer, index) => offerActs(offer, index === 0)), dismissAct(gap)];
  }

  function offerActs(offer, isFirst) {
    if (offer.parameter === "way") return [choiceOf(offer)];
    const refused = offer.refused;
    const style = isFirst ? "button primary" : "button";
    const act = h(
      "button",
      { class: style, type: "button", disabled: Boolean(refused), title: refused || null },
      offer.words,
    );
    previews(act, offer.preview);
    act.addEventListener("click", () => on.repair({ action: offer.action }));
    if (offer.parameter === "positions") {
      return [
        act,
        h(
          "button",
          {
            class: "button",
            type: "button",
            onclick: () => (on.place((count) => placing(offer, count)), placing(offer, 0)),
          },
          icon("map-pin"),
          t("Place them on the map"),
        ),
      ];
    }
    if (offer.parameter === "voltages_v")
      return [offer.choices.length ? act : null, voltageForm(offer, !offer.choices.length)];
    return [act];
  }

  function previews(act, collection) {
    if (!collection) return;
    for (const come of ["pointerenter", "focus"]) act.addEventListener(come, () => on.preview(collection));
    for (const go of ["pointerleave", "blur"]) act.addEventListener(go, () => on.preview(null));
  }

  function choiceOf(offer) {
    const choices = offer.choices.map(({ value, words }) =>
      h(
        "button",
        {
          class: "button",
          type: "button",
          onclick: () => on.repair({ action: offer.action, [offer.parameter]: value }),
        },
        words,
      ),
    );
    return h(
      "div",
      { class: "gap-choice", role: "group", "aria-label": offer.words },
      h("span", { class: "field-label" }, offer.words),
      choices,
    );
  }

  function voltageForm(offer, isFirst) {
    const input = h("input", {
      class: "input",
      id: "gap-volts",
      inputmode: "decimal",
      placeholder: "110, 20",
      autocomplete: "off",
      required: true,
    });
    const submit = (event) => {
      event.preventDefault();
      const kilovolts = input.value
        .split(/[,;\s]+/)
        .filter(Boolean)
        .map(Number);
      if (!kilovolts.length || kilovolts.some((value) => !(value > 0)))
        return fault("Give one voltage or several in kV, with commas.");
      on.repair({ action: offer.action, voltages_v: kilovolts.map((value) => Math.round(value * 1000)) });
    };
    return h(
      "form",
      { class: "gap-form", onsubmit: submit },
      h("label", { for: "gap-volts" }, t("Voltage")),
      h("span", { class: "with-unit" }, input, h("span", { class: "unit" }, "kV")),
      h("button", { class: isFirst ? "button primary" : "button" }, t("Set")),
    );
  }

  function dismissAct({ id, properties }) {
    if (noting) return noting.form;
    const opener = h("button", { class: "button quiet", type: "button" }, dismissWords(properties.kind));
    opener.addEventListener("click", () => {
      const note = h("input", {
        class: "input",
        id: "gap-note",
        maxlength: LONGEST_NOTE,
        placeholder: t("Why it is right"),
        "aria-label": t("Note"),
        autocomplete: "off",
      });
      const form = h(
        "form",
        { class: "gap-form", onsubmit: (event) => (event.preventDefault(), on.dismiss(note.value.trim())) },
        note,
        h("button", { class: "button primary" }, t("Leave it")),
        h(
          "button",
          {
            class: "button quiet",
            type: "button",
            onclick: () => ((noting = null), form.replaceWith(opener), opener.focus()),
          },
          t("Cancel"),
        ),
      );
      noting = { id, form };
      opener.replaceWith(form);
      note.focus();
    });
    return opener;
  }

  /** While places are clicked on the map the acts say how many there are. */
  function placing(offer, count) {
    drawn = "";
    const words = count ? tn(count, "Place {count} tower", "Place {count} towers") : t("Click along the span");
    acts.replaceChildren(
      h(
        "button",
        { class: "button primary", type: "button", disabled: !count, onclick: () => on.placeDone(offer) },
        words,
      ),
      h(
        "button",
        { class: "button", type: "button", disabled: !count, onclick: () => on.placeBack() },
        icon("undo-2"),
        t("Take one back"),
      ),
      h("button", { class: "button quiet", type: "button", onclick: () => on.placeCancel() }, t("Cancel")),
    );
  }

  function fault(sentence) {
    said?.replaceChildren(...(sentence ? [icon("circle-alert"), sentence] : []));
  }

  return {
    show,
    refresh,
    fault,
    busy(isBusy) {
      panel.setAttribute("aria-busy", String(isBusy));
      for (const button of panel.querySelectorAll(".gap-acts button"))
        button.setAttribute("aria-disabled", String(isBusy));
    },
  };
}

function assetWords({ asset, other_asset: other }) {
  const name = (thing) => [thing.label, thing.detail].filter(Boolean).join(", ");
  return [asset, other].filter(Boolean).map(name).join(" · ");
}

function decidedWords({ state, decided_by: who, decided_at: when, note }) {
  const words = {
    repaired: who ? t("Repaired by {name}", { name: who }) : t("No longer found"),
    dismissed: who ? t("Left as it is by {name}", { name: who }) : t("Left as it is"),
  };
  return `${words[state]}${when ? `, ${whenText(when)}` : ""}${note ? `: ${note}` : ""}`;
}
