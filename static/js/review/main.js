/** The review of photos: one large, next and previous by keys, boxes, a category, a severity, or nothing to see. */

import { ApiError, freshKey, get, patch, post, remove } from "../api.js";
import { byId, h, icon, setChildren, term } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { announce, toast } from "../page/toast.js";
import { lookAgain, severityMark } from "../photos/findings_list.js";
import { thumbnail } from "../photos/section.js";
import { FINDING_STATES, PLACEMENTS, SEVERITIES, sizeText } from "../photos/words.js";
import { t } from "../text.js";
import { exactText, heightText, numberText, positionText } from "../units.js";
import { categoriesFor } from "./category_search.js";
import { createPicture } from "./picture.js";

/** @import { Answer } from "../api.js" */
/** @import { Category, CategoryList, InspectionFinding, InspectionFindingPage, Medium, MediumPage } from "../api_types.d.ts" */

const PAGE = 200;
/** @type {Record<string, string>} */
const REFERENCES = {
  amsl: t("AMSL"),
  ellipsoid: t("above the ellipsoid"),
  take_off: t("above take-off"),
  unknown: t("AMSL or above the ellipsoid"),
};

/** @type {{ canPlan: boolean, subject: { query: string, name: string, back: string } }} */
const page = readPage();
const { query } = page.subject;
/** @type {Medium[]} */
let media = [];
/** @type {string | null} */
let nextPage = null;
let place = 0;
/** @type {Category[]} */
let categories = [];
/** @type {Category | null} */
let category = null;
/** The last finding made. @type {{ category: Category, severity: number } | null} */
let last = null;
/** @type {InspectionFinding[]} */
let findings = [];
let isBusy = false;

const picture = createPicture(byId("review-photo"), { canDraw: page.canPlan, notify: drawForm });
const input = /** @type {HTMLInputElement} */ (byId("review-category"));
const note = /** @type {HTMLInputElement} */ (byId("review-note"));
const choices = byId("review-choices");

const medium = () => /** @type {Medium | undefined} */ (media[place]);

/** @param {number} step */
async function go(step) {
  const wanted = place + step;
  if (wanted >= media.length && nextPage) await load(nextPage);
  if (wanted < 0 || wanted >= media.length) {
    announce(step > 0 ? t("This is the last photo.") : t("This is the first photo."));
    return;
  }
  await show(wanted);
}

/** To the next photo that is not reviewed yet, else to the next one. */
async function goOn() {
  const open = media.findIndex((one, index) => index > place && !one.review && one.state === "ready");
  await (open > place ? show(open) : go(1));
}

/** @param {number} wanted */
async function show(wanted) {
  place = wanted;
  const shown = medium();
  if (!shown) return;
  picture.show(shown);
  findings = [];
  note.value = "";
  history.replaceState(null, "", `/review?${[query, `medium=${shown.id}`].filter(Boolean).join("&")}`);
  draw();
  const after = media[place + 1]?.previews["1600"];
  if (after) new Image().src = after; // so that the next one is there at once
  await readFindings(shown);
}

/** @param {Medium} shown */
async function readFindings(shown) {
  const { data } = /** @type {Answer<InspectionFindingPage>} */ (await get(`/findings?medium=${shown.id}`));
  if (medium()?.id !== shown.id) return;
  findings = data.results;
  drawFindings();
}

function draw() {
  const shown = medium();
  const all = `${numberText(media.length)}${nextPage ? "+" : ""}`;
  byId("review-count").textContent = media.length ? t("{place} of {all}", { place: numberText(place + 1), all }) : "";
  /** @type {HTMLButtonElement} */ (byId("review-previous")).disabled = place === 0;
  /** @type {HTMLButtonElement} */ (byId("review-next")).disabled = place >= media.length - 1 && !nextPage;
  byId("review-empty").hidden = media.length > 0;
  byId("review-body").hidden = media.length === 0;
  if (!shown) return;
  byId("review-name").textContent = shown.file_name;
  drawFacts(shown);
  drawPlacement(shown);
  drawFindings();
  drawForm();
  const strip = byId("review-strip");
  setChildren(
    strip,
    media.map((one, index) => h("li", { "aria-current": index === place && "true" }, stripThumb(one, index))),
  );
  strip.querySelector("[aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" });
}

/** @param {Medium} one @param {number} index */
function stripThumb(one, index) {
  const link = thumbnail(one, query);
  link.addEventListener("click", (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    show(index);
  });
  return link;
}

/** @param {Medium} shown */
function drawFacts(shown) {
  const heights = shown.heights.map(({ value_m, reference }) => `${heightText(value_m)} ${REFERENCES[reference]}`);
  setChildren(
    byId("review-facts"),
    term(t("Taken"), shown.taken_at && exactText(shown.taken_at)),
    term(t("Camera"), shown.camera_model),
    term(t("Position"), shown.position && positionText(/** @type {[number, number]} */ (shown.position.coordinates))),
    term(t("Height"), heights.length > 0 && heights.map((text) => h("div", {}, text))),
    term(t("Size"), [
      shown.width_px && `${numberText(shown.width_px)} × ${numberText(shown.height_px ?? 0)}, `,
      sizeText(shown.size_bytes, numberText),
    ]),
    term(t("Original"), h("a", { href: shown.original, download: true }, t("Download"))),
  );
}

/** @param {Medium} shown */
function drawPlacement(shown) {
  const label = shown.target_label || shown.asset_label;
  const isOpen = shown.placement === "unplaced";
  const assign = (/** @type {number} */ target) => change(shown, { target });
  setChildren(
    byId("review-placement"),
    h(
      "p",
      {},
      label ? h("strong", { translate: "no" }, label) : h("strong", {}, PLACEMENTS.unplaced),
      " ",
      label && h("span", { class: "caption" }, PLACEMENTS[shown.placement]),
    ),
    isOpen &&
      page.canPlan &&
      shown.candidates.map(({ target, label: name, distance_m }) =>
        h(
          "button",
          { type: "button", class: "button", onclick: () => assign(target) },
          icon("map-pin", "small"),
          h("span", { translate: "no" }, name),
          h("span", { class: "caption" }, heightText(distance_m)),
        ),
      ),
    !isOpen &&
      page.canPlan &&
      shown.placement !== "waiting" &&
      h(
        "button",
        { type: "button", class: "text-button", onclick: () => change(shown, { target: null, asset: null }) },
        t("Not this one"),
      ),
  );
}

function drawFindings() {
  const shown = medium();
  if (!shown) return;
  const rows = findings.map((finding) =>
    h(
      "li",
      {},
      severityMark(finding.severity),
      h(
        "span",
        {},
        h("strong", {}, finding.category_name),
        h("small", {}, [`#${finding.number}`, FINDING_STATES[finding.state], finding.note].filter(Boolean).join(" · ")),
      ),
    ),
  );
  setChildren(
    byId("review-findings"),
    rows.length
      ? h("ul", { class: "finding-list" }, rows)
      : h(
          "p",
          { class: "caption" },
          shown.review === "nothing" ? t("Nothing to see here.") : t("No findings on this photo."),
        ),
    page.canPlan && lookAgain(findings),
  );
  picture.mark(
    findings.flatMap((finding) =>
      finding.evidence
        .filter((one) => one.medium === shown.id)
        .map(({ shape }) => ({ shape, severity: finding.severity, title: finding.category_name })),
    ),
  );
}

function drawForm() {
  const form = byId("review-form");
  form.hidden = !page.canPlan;
  byId("review-box").textContent = picture.box()
    ? t("The box is the mark.")
    : t("Draw a box on the photo, or mark all of it.");
  for (const button of /** @type {NodeListOf<HTMLButtonElement>} */ (form.querySelectorAll("[data-severity]")))
    button.disabled = !category || isBusy;
  /** @type {HTMLButtonElement} */ (byId("review-same")).disabled = !last || isBusy;
}

/** @param {string} typed */
function drawChoices(typed) {
  const found = categoriesFor(categories, typed);
  setChildren(
    choices,
    found.slice(0, 8).map((one, index) =>
      h(
        "li",
        {},
        h(
          "button",
          {
            type: "button",
            "aria-pressed": String(one === category),
            "data-first": index === 0 && "true",
            onclick: () => choose(one),
          },
          one.name,
          h("span", { class: "caption" }, one.component_name),
        ),
      ),
    ),
    !found.length && h("li", { class: "caption" }, t("No category matches.")),
  );
}

/** @param {Category} chosen */
function choose(chosen) {
  category = chosen;
  input.value = chosen.name;
  drawChoices(chosen.name);
  drawForm();
  byId("review-photo").focus({ preventScroll: true });
}

/** @param {number} severity */
async function save(severity) {
  const shown = medium();
  if (!category || !shown || isBusy) return;
  if (category.needs_note && !note.value.trim()) {
    note.focus();
    toast(t("This category needs a note."));
    return;
  }
  isBusy = true;
  drawForm();
  const box = picture.box();
  const body = {
    category: category.code,
    severity,
    note: note.value.trim(),
    evidence: [{ medium: shown.id, shape: box && { type: "box", ...box } }],
  };
  try {
    const { data } = /** @type {Answer<InspectionFinding>} */ (
      await post("/findings", body, { headers: { "Idempotency-Key": freshKey() } })
    );
    last = { category, severity };
    media[place] = { ...shown, review: "findings" };
    picture.clear();
    note.value = "";
    toast(t("Finding {number} saved.", { number: data.number }), { label: t("Undo"), act: () => undo(data, shown) });
    await readFindings(shown);
    draw();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  } finally {
    isBusy = false;
    drawForm();
  }
}

/** @param {InspectionFinding} finding @param {Medium} shown */
async function undo(finding, shown) {
  await attempt(async () => {
    for (const { id } of finding.evidence) await remove(`/findings/${finding.id}/evidence/${id}`);
    await patch(`/findings/${finding.id}`, { state: "rejected" }, { headers: { "If-Match": "*" } });
    await reread(shown);
  });
}

async function nothing() {
  const shown = medium();
  if (!shown || isBusy || !page.canPlan) return;
  if (findings.length) {
    toast(t("This photo has findings."));
    return;
  }
  await change(shown, { review: "nothing" });
  toast(t("Nothing to see on {name}.", { name: shown.file_name }), {
    label: t("Undo"),
    act: () => change(shown, { review: "" }),
  });
  await goOn();
}

/** @param {Medium} shown @param {Record<string, unknown>} values */
async function change(shown, values) {
  await attempt(async () => {
    const { data } = /** @type {Answer<Medium>} */ (await patch(`/media/${shown.id}`, values));
    take(data);
  });
}

/** @param {Medium} shown */
async function reread(shown) {
  const { data } = /** @type {Answer<Medium>} */ (await get(`/media/${shown.id}`));
  take(data);
  if (medium()?.id === shown.id) await readFindings(shown);
}

/** @param {Medium} changed */
function take(changed) {
  media = media.map((one) => (one.id === changed.id ? changed : one));
  draw();
}

/** @param {() => Promise<void>} act */
async function attempt(act) {
  try {
    await act();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

function sameAsLast() {
  if (!last) return;
  choose(last.category);
  save(last.severity);
}

/** @param {string} address */
async function load(address) {
  const { data } = /** @type {Answer<MediumPage>} */ (await get(address));
  media = [...media, ...data.results];
  nextPage = data.next;
}

async function start() {
  const wanted = new URLSearchParams(location.search).get("medium");
  const [, answer] = await Promise.all([
    load(`/media?${[query, `limit=${PAGE}`].filter(Boolean).join("&")}`),
    get("/finding-categories"),
  ]);
  ({ categories } = /** @type {Answer<CategoryList>} */ (answer).data);
  while (wanted && nextPage && !media.some(({ id }) => id === wanted)) await load(nextPage);
  drawChoices("");
  const open = media.findIndex(({ review, state }) => !review && state === "ready");
  const at = wanted ? media.findIndex(({ id }) => id === wanted) : open;
  draw();
  await show(Math.max(at, 0));
}

byId("review-previous").addEventListener("click", () => go(-1));
byId("review-next").addEventListener("click", () => go(1));
byId("review-nothing").addEventListener("click", nothing);
byId("review-same").addEventListener("click", sameAsLast);
byId("review-zoom-in").addEventListener("click", () => picture.zoom(1));
byId("review-zoom-out").addEventListener("click", () => picture.zoom(-1));
for (const button of /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll("[data-severity]")))
  button.addEventListener("click", () => save(Number(button.dataset.severity)));
input.addEventListener("input", () => {
  category = null;
  drawChoices(input.value);
  drawForm();
});
input.addEventListener("focus", () => input.select());
input.addEventListener("keydown", (event) => {
  if (event.key !== "Enter") return;
  event.preventDefault();
  const [best] = categoriesFor(categories, input.value);
  if (best) choose(best);
});

startChrome({
  bindings: [
    { keys: ["j", "arrowright"], words: t("Next photo"), act: () => go(1) },
    { keys: ["k", "arrowleft"], words: t("Previous photo"), act: () => go(-1) },
    { keys: ["x", " "], words: t("Nothing to see, and go on"), act: nothing },
    {
      keys: ["c"],
      words: t("Choose the category"),
      act: () => input.focus(),
    },
    ...[1, 2, 3, 4].map((severity) => ({
      keys: [String(severity)],
      words: t("Save the finding: {severity}", { severity: SEVERITIES[severity] }),
      act: () => save(severity),
    })),
    { keys: ["s"], words: t("Same finding as the last one"), act: sameAsLast },
    { keys: ["+", "="], words: t("Zoom in"), act: () => picture.zoom(1) },
    { keys: ["-"], words: t("Zoom out"), act: () => picture.zoom(-1) },
    { keys: ["escape"], words: t("Remove the box"), whileTyping: true, act: () => picture.clear() },
  ],
});
await attempt(start);
document.documentElement.dataset.loaded = "true";
