/** Photos of a mission or an asset: dropping and sending them, what came of it, thumbnails, and the way to the review. */

import { ApiError, get } from "../api.js";
import { h, icon, setChildren } from "../dom.js";
import { announce } from "../page/toast.js";
import { t, tn } from "../text.js";
import { durationText, numberText, percentText, whenText } from "../units.js";
import { UploadQueue } from "./upload_queue.js";
import { PLACEMENTS } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { Medium, MediumPage } from "../api_types.d.ts" */

const PAGE = 24;
const READING_MS = 3_000; // between looks while photos are read
const TYPES =
  "image/jpeg,image/png,image/tiff,image/webp,image/heic,video/mp4,video/quicktime,.dng,.heic,.jpg,.jpeg,.tif,.tiff,.mp4,.mov";
const MAX_NAMED = 5;
const HIDDEN = /^\.|^Thumbs\.db$/i;

/**
 * Fill an element with the photos of a mission or an asset.
 *
 * @param {HTMLElement} element
 * @param {{ query: string, stated: Record<string, unknown>, canUpload: boolean, notify?: (count: number, isMore: boolean) => void }} options
 *   query: which photos, as the API filters them. stated: what uploaded ones show
 */
export function mountPhotos(element, { query, stated, canUpload, notify = () => {} }) {
  const status = h("div", { class: "photo-status" });
  const grid = h("ul", { class: "photo-grid" });
  const end = h("div", { class: "photo-end" });
  const queue = new UploadQueue({ stated, notify: drawQueue });
  /** @type {Medium[]} */
  let media = [];
  /** @type {string | null} */
  let next = null;
  let stored = 0; // uploads that the list has taken notice of
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  setChildren(element, canUpload && dropArea((files) => send(files)), status, grid, end);
  load();

  /** @param {File[]} files */
  async function send(files) {
    if (files.length) await queue.add(files);
    const { done, known, failed } = queue.summary();
    if (files.length) announce(endWords(done, known, failed));
  }

  function drawQueue() {
    const { count, done, known, failed, share, isBusy, isPaused, left_s } = queue.summary();
    if (!count) return;
    const ended = done + known + failed;
    const left = left_s === null ? "" : t("{time} left", { time: durationText(left_s) });
    const facts = isPaused
      ? t("Connection lost. The upload continues by itself.")
      : [t("{done} of {all}", { done: numberText(ended), all: numberText(count) }), percentText(share * 100), left];
    setChildren(
      status,
      isBusy && h("p", { class: "photo-facts" }, [facts].flat().filter(Boolean).join(" · ")),
      isBusy && h("div", { class: "progress", "aria-hidden": "true" }, h("i", { style: `width: ${share * 100}%` })),
      !isBusy && h("p", { class: "photo-facts" }, endWords(done, known, failed)),
      failed > 0 && failures(queue),
    );
    if (done + known > stored && (!isBusy || done + known >= stored + PAGE)) {
      stored = done + known;
      load();
    }
  }

  /** @param {{ more?: boolean }} [options] */
  async function load({ more = false } = {}) {
    clearTimeout(timer);
    try {
      const address = more && next ? next : `/media?${query}&limit=${Math.min(Math.max(PAGE, media.length), 1_000)}`;
      const { data } = /** @type {Answer<MediumPage>} */ (await get(address));
      media = more ? [...media, ...data.results] : data.results;
      next = data.next;
      drawGrid();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      setChildren(end, h("p", { class: "caption" }, error.message));
    }
    if (media.some(({ state }) => state === "waiting")) timer = setTimeout(load, READING_MS);
  }

  function drawGrid() {
    notify(media.length, next !== null);
    setChildren(
      grid,
      media.map((medium) => h("li", {}, thumbnail(medium, query))),
    );
    const open = media.filter(({ review, state }) => !review && state === "ready").length;
    setChildren(
      end,
      media.length > 0 &&
        h(
          "a",
          { class: "button", href: `/review?${query}` },
          icon("eye", "small"),
          open ? t("Review photos") : t("Show photos"),
        ),
      next &&
        h("button", { type: "button", class: "text-button", onclick: () => load({ more: true }) }, t("Show more")),
      !media.length && !canUpload && h("p", { class: "caption" }, t("No photos yet.")),
    );
  }
}

/** What failed, by name, and the way to try again. @param {UploadQueue} queue */
function failures(queue) {
  const lost = queue.items.filter(({ phase }) => phase === "failed");
  return h(
    "div",
    { class: "notice critical", role: "alert" },
    icon("circle-alert"),
    h(
      "div",
      {},
      lost
        .slice(0, MAX_NAMED)
        .map(({ file, problem }) => h("p", {}, h("strong", { translate: "no" }, file.name), ` ${problem}`)),
      lost.length > MAX_NAMED && h("p", {}, t("And {count} more.", { count: numberText(lost.length - MAX_NAMED) })),
      h("button", { type: "button", class: "text-button", onclick: () => queue.retry() }, t("Try again")),
    ),
  );
}

/** @param {number} done @param {number} known @param {number} failed */
function endWords(done, known, failed) {
  return [
    tn(done, "{count} file uploaded.", "{count} files uploaded.", { count: numberText(done) }),
    known > 0 && tn(known, "{count} was here already.", "{count} were here already.", { count: numberText(known) }),
    failed > 0 && tn(failed, "{count} failed.", "{count} failed.", { count: numberText(failed) }),
  ]
    .filter(Boolean)
    .join(" ");
}

/** @param {Medium} medium @param {string} query of the photos that the review goes through */
export function thumbnail(medium, query) {
  const { file_name: name, taken_at: taken, target_label: target, asset_label: asset } = medium;
  const facts = [name, taken && whenText(taken), target || asset || PLACEMENTS[medium.placement], medium.fault].filter(
    Boolean,
  );
  const preview = medium.previews["400"];
  return h(
    "a",
    {
      class: "photo-thumb",
      href: `/review?${query}&medium=${medium.id}`,
      title: facts.join("\n"),
      "aria-label": facts.join(", "),
    },
    preview
      ? h("img", { src: preview, alt: "", loading: "lazy", decoding: "async" })
      : h(
          "span",
          { class: "photo-none" },
          icon(medium.kind === "video" ? "video" : medium.state === "waiting" ? "loader-circle" : "file"),
        ),
    h(
      "span",
      { class: "photo-marks", "aria-hidden": "true" },
      medium.placement === "unplaced" && h("i", { class: "photo-mark warning" }, icon("map-pin", "small")),
      medium.review === "findings" && h("i", { class: "photo-mark critical" }, icon("triangle-alert", "small")),
      medium.review === "nothing" && h("i", { class: "photo-mark" }, icon("check", "small")),
    ),
  );
}

/** @param {(files: File[]) => void} take */
function dropArea(take) {
  const input = h("input", {
    type: "file",
    class: "unseen",
    multiple: true,
    accept: TYPES,
    onchange: () => {
      take([...(input.files ?? [])]);
      input.value = "";
    },
  });
  const area = h(
    "label",
    { class: "file-drop photo-drop" },
    input,
    icon("upload"),
    h(
      "span",
      { class: "file-drop-words" },
      h("strong", {}, t("Drop photos or a folder here,")),
      h("u", {}, t("or choose files")),
    ),
    h("span", { class: "caption" }, t("JPEG, PNG, TIFF, DNG, WebP, HEIC, MP4, MOV")),
  );
  listenToDrops(area, take);
  return area;
}

/** @param {HTMLElement} area that is highlighted while files are over the page @param {(files: File[]) => void} take */
function listenToDrops(area, take) {
  const hasFiles = (/** @type {DragEvent} */ event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  addEventListener("dragover", (event) => {
    if (!hasFiles(event) || !area.isConnected) return;
    event.preventDefault();
    area.dataset.over = "true";
  });
  addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) delete area.dataset.over;
  });
  addEventListener("drop", async (event) => {
    delete area.dataset.over;
    if (!hasFiles(event) || !area.isConnected || !event.dataTransfer) return;
    event.preventDefault();
    take(await filesOfDrop(event.dataTransfer));
  });
}

/** @param {DataTransfer} dropped with files or folders @returns {Promise<File[]>} in the order of their paths */
async function filesOfDrop(dropped) {
  // Entries must be taken before the first wait: the list is empty afterwards.
  const entries = [...dropped.items].map((item) => item.webkitGetAsEntry?.() ?? null);
  if (entries.some((entry) => entry === null)) return [...dropped.files];
  const found = await Promise.all(entries.map((entry) => filesIn(/** @type {FileSystemEntry} */ (entry))));
  return found.flat();
}

/** @param {FileSystemEntry} entry @returns {Promise<File[]>} */
async function filesIn(entry) {
  if (HIDDEN.test(entry.name)) return [];
  if (entry.isFile)
    return [await new Promise((resolve, reject) => /** @type {FileSystemFileEntry} */ (entry).file(resolve, reject))];
  const reader = /** @type {FileSystemDirectoryEntry} */ (entry).createReader();
  /** @type {FileSystemEntry[]} */
  const inside = [];
  for (;;) {
    /** @type {FileSystemEntry[]} a part of them: browsers return 100 at a time */
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!some.length) break;
    inside.push(...some);
  }
  inside.sort((one, other) => one.name.localeCompare(other.name));
  return (await Promise.all(inside.map(filesIn))).flat();
}
