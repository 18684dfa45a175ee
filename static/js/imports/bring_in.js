/** "Bring in data": choosing, dropping and sending files; an interrupted upload is resumed. */

import { ApiError, post } from "../api.js";
import { byId, h, icon, keyedList } from "../dom.js";
import { announce, toast } from "../page/toast.js";
import { t } from "../text.js";
import { fileCard } from "./file_card.js";
import { guessKind, headOf, setNameOf, whyNotSent } from "./kinds.js";
import { createRememberedUploads, markOf } from "./remembered_uploads.js";
import { sendFile, untilAnswered } from "./send_file.js";

/** @import { Answer } from "../api.js" */
/** @import { ImportKind, Proposal, SendHints, UploadItem } from "./types.d.ts" */

/** @param {UploadItem} item */
const isUnderWay = (item) => ["sending", "waiting", "starting"].includes(item.phase);

/** @param {string} name @param {number} size */
const blank = (name, size) => ({
  name,
  size,
  received: 0,
  waits_s: 0,
  problem: "",
  parameters: {},
  provenance: {},
  uploadId: null,
  controller: null,
  wake: null,
});

/** @typedef {(proposal: Proposal, how: { isLast: boolean }) => void} OnStarted called when a file is whole and is being read */

/** @param {{ userId: number, onStarted: OnStarted }} options */
export const mountBringIn = ({ userId, onStarted }) => new Uploads(userId, onStarted);

class Uploads {
  #onStarted;
  #remembered;
  #input = byId("choose-file", HTMLInputElement);
  /** @type {UploadItem[]} */
  #items;
  /** By mark. @type {Map<string, ReturnType<typeof fileCard>>} */
  #cards = new Map();
  #drawCards;

  /** @param {number} userId @param {OnStarted} onStarted */
  constructor(userId, onStarted) {
    this.#onStarted = onStarted;
    this.#remembered = createRememberedUploads(userId);
    this.#items = this.#remembered.all().map((entry) => ({
      ...blank(entry.name, entry.size),
      ...entry,
      file: null,
      phase: "lost",
      received: entry.received ?? 0,
    }));
    this.#drawCards = keyedList(
      byId("files"),
      (/** @type {UploadItem} */ item) => item.mark,
      (item) => this.#makeCard(item).element,
      (_element, item) => this.#cards.get(item.mark)?.refresh(),
    );
    this.#input.addEventListener("change", async () => {
      const files = [...(this.#input.files ?? [])];
      this.#input.value = "";
      await this.#take(files);
    });
    listenToDrops(byId("file-drop"), (files) => {
      if (files.length) this.#take(files);
      else toast(t("Only files can be dropped here."));
    });
    addEventListener("beforeunload", (event) => {
      if (this.#items.some(isUnderWay)) event.preventDefault();
    });
    this.#draw();
  }

  choose() {
    this.#input.click();
  }

  #draw() {
    this.#drawCards(this.#items);
    byId("files").hidden = this.#items.length === 0;
  }

  /** @param {UploadItem} item */
  #makeCard(item) {
    const card = fileCard(item, {
      start: (one) => this.#start(one),
      stop: (one) => this.#stop(one),
      choose: () => this.choose(),
      drop: (one) => this.#takeOff(one),
      kind: setKind,
      change: (one) => {
        if (this.#remembered.find(one.mark)) this.#keep(one);
      },
    });
    this.#cards.set(item.mark, card);
    return card;
  }

  /** @param {UploadItem} item */
  #keep({ mark, name, size, kind, parameters, provenance, uploadId, received }) {
    this.#remembered.keep(mark, { name, size, kind, parameters, provenance, uploadId, received });
  }

  /** @param {File[]} files */
  async #take(files) {
    byId("notices").replaceChildren();
    for (const file of files) {
      const mark = markOf(file);
      const known = this.#items.find((item) => item.mark === mark);
      if (known) {
        known.file = file;
        if (known.phase === "lost") this.#start(known);
        continue;
      }
      const head = await headOf(file);
      const why = whyNotSent(file.name, file.size, head);
      if (why) {
        refuseFile(why);
        continue;
      }
      const kind = guessKind(file.name, head);
      /** @type {UploadItem} */
      const item = { ...blank(file.name, file.size), mark, file, kind, phase: "chosen" };
      if (kind === "zones" || kind === "assets") item.parameters.set_name = setNameOf(file.name);
      this.#items = [...this.#items, item];
    }
    this.#draw();
    const last = this.#cards.get(this.#items.at(-1)?.mark ?? "")?.element;
    last?.scrollIntoView({ block: "nearest" });
    /** @type {HTMLElement | null | undefined} */
    const control = last?.querySelector("select, button.button");
    control?.focus({ preventScroll: true });
  }

  /** Sends the file and has it read. @param {UploadItem} item */
  async #start(item) {
    if (isUnderWay(item) || !item.file) return;
    const controller = new AbortController();
    Object.assign(item, { phase: "sending", problem: "", controller });
    this.#keep(item);
    this.#draw();
    try {
      const hints = this.#hintsOf(item, controller);
      const onBegun = (/** @type {string} */ id) => {
        item.uploadId = id;
        this.#keep(item);
      };
      item.uploadId = await sendFile(item.file, { ...hints, uploadId: item.uploadId, onBegun });
      const proposal = await this.#haveRead(item, hints);
      this.#takeOff(item);
      announce(t("{name} is being read.", { name: item.name }));
      this.#onStarted(proposal, { isLast: !this.#items.some(isUnderWay) });
    } catch (error) {
      if (error instanceof DOMException && error.name === "AbortError") return;
      if (!(error instanceof ApiError)) throw error;
      Object.assign(item, { phase: "failed", problem: error.message });
      this.#draw();
    }
  }

  /** @param {UploadItem} item @param {AbortController} controller @returns {SendHints} */
  #hintsOf(item, { signal }) {
    return {
      signal,
      nudge: (wake) => {
        item.wake = wake;
      },
      notify: ({ received, waits_s }) => {
        if (received !== undefined) item.received = received;
        item.waits_s = waits_s;
        const phase = waits_s > 0 ? "waiting" : "sending";
        if (phase === "waiting" && item.phase !== "waiting") this.#keep(item);
        item.phase = phase;
        this.#draw();
      },
    };
  }

  /** @param {UploadItem} item @param {SendHints} hints @returns {Promise<Proposal>} */
  async #haveRead(item, hints) {
    const { kind, uploadId, parameters } = item;
    const provenance = Object.fromEntries(Object.entries(item.provenance).filter(([, value]) => value.trim()));
    const headers = { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` };
    const body = { kind, upload: uploadId, parameters, provenance };
    const answer = await untilAnswered(() => {
      item.phase = "starting";
      this.#draw();
      return post("/imports", body, { headers });
    }, hints);
    return /** @type {Answer<Proposal>} */ (answer).data;
  }

  /** Stop the upload. Received parts are kept for a day, so that it can be resumed. @param {UploadItem} item */
  #stop(item) {
    item.controller?.abort();
    item.phase = "chosen";
    this.#keep(item);
    this.#draw();
  }

  /** @param {UploadItem} item */
  #takeOff(item) {
    item.controller?.abort();
    this.#remembered.forget(item.mark);
    this.#items = this.#items.filter((other) => other !== item);
    this.#cards.delete(item.mark);
    this.#draw();
  }
}

/** @param {UploadItem} item @param {ImportKind} kind */
function setKind(item, kind) {
  item.kind = kind;
  const set_name = item.parameters.set_name ?? setNameOf(item.name);
  item.parameters = kind === "zones" || kind === "assets" ? { set_name } : {};
}

/** @param {string} why in one sentence; nothing of the file is sent */
const refuseFile = (why) =>
  byId("notices").append(h("div", { class: "notice critical", role: "alert" }, icon("circle-alert"), h("p", {}, why)));

/**
 * Accept a file dropped anywhere on the page; the drop area is highlighted meanwhile.
 * @param {HTMLElement} drop @param {(files: File[]) => void} take
 */
function listenToDrops(drop, take) {
  const hasFiles = (/** @type {DragEvent} */ event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  let depth = 0;
  const mark = () => {
    if (depth) drop.dataset.over = "true";
    else delete drop.dataset.over;
  };
  addEventListener("dragenter", (event) => {
    if (!hasFiles(event)) return;
    depth += 1;
    mark();
  });
  addEventListener("dragleave", (event) => {
    if (!hasFiles(event)) return;
    depth = Math.max(0, depth - 1);
    mark();
  });
  addEventListener("dragover", (event) => {
    if (hasFiles(event)) event.preventDefault();
  });
  addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    depth = 0;
    mark();
    take([...(event.dataTransfer?.files ?? [])]);
  });
}

/** The notice in place of the tools where the user may not import data. */
export function notAllowed() {
  return h(
    "div",
    { class: "notice advisory" },
    h(
      "p",
      {},
      h("strong", {}, t("Only curators bring data in.")),
      ` ${t("Ask an administrator for the curator role.")}`,
    ),
  );
}
