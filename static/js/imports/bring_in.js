/** "Bring in data": choosing and dropping files, and sending them; what was cut short goes on. */

import { ApiError, post } from "../api.js";
import { byId, h, keyedList } from "../dom.js";
import { say, toast } from "../page/toast.js";
import { t } from "../text.js";
import { fileCard } from "./file_card.js";
import { guessKind, HEAD_BYTES, setNameOf } from "./kinds.js";
import { createRememberedUploads, markOf } from "./remembered_uploads.js";
import { sendFile, untilAnswered } from "./send_file.js";

const isUnderWay = (item) => ["sending", "waiting", "starting"].includes(item.phase);

/** onStarted(proposal): a file is whole and is being read. */
export function mountBringIn({ userId, onStarted }) {
  const remembered = createRememberedUploads(userId);
  const input = byId("choose-file");
  const drop = byId("file-drop");
  let items = remembered.all().map((entry) => ({
    ...blank(entry.name, entry.size),
    ...entry,
    file: null,
    phase: "lost",
    received: entry.received ?? 0,
  }));

  const cards = new Map();
  const acts = {
    start,
    stop,
    choose: () => input.click(),
    drop: takeOff,
    kind: setKind,
    change: (item) => isRemembered(item) && keep(item),
  };
  const drawCards = keyedList(
    byId("files"),
    (item) => item.mark,
    (item) => {
      const card = fileCard(item, acts);
      cards.set(item.mark, card);
      return card.element;
    },
    (element, item) => cards.get(item.mark).refresh(),
  );
  const draw = () => {
    drawCards(items);
    byId("files").hidden = items.length === 0;
  };

  function blank(name, size) {
    return {
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
    };
  }
  const isRemembered = (item) => remembered.find(item.mark) !== null;
  const keep = ({ mark, name, size, kind, parameters, provenance, uploadId, received }) =>
    remembered.keep(mark, { name, size, kind, parameters, provenance, uploadId, received });

  async function take(files) {
    for (const file of files) {
      const mark = markOf(file);
      const known = items.find((item) => item.mark === mark);
      if (known) {
        known.file = file;
        if (known.phase === "lost") start(known);
        continue;
      }
      const kind = guessKind(file.name, await headOf(file));
      const item = { ...blank(file.name, file.size), mark, file, kind, phase: "chosen" };
      if (kind === "zones" || kind === "assets") item.parameters.set_name = setNameOf(file.name);
      items = [...items, item];
    }
    draw();
    const last = cards.get(items.at(-1)?.mark)?.element;
    last?.scrollIntoView({ block: "nearest" });
    last?.querySelector("select, button.button")?.focus({ preventScroll: true });
  }

  function setKind(item, kind) {
    item.kind = kind;
    item.parameters =
      kind === "zones" || kind === "assets" ? { set_name: item.parameters.set_name ?? setNameOf(item.name) } : {};
  }

  async function start(item) {
    if (isUnderWay(item)) return;
    Object.assign(item, { phase: "sending", problem: "", controller: new AbortController() });
    keep(item);
    draw();
    const hints = {
      signal: item.controller.signal,
      nudge: (wake) => (item.wake = wake),
      tell({ received, waits_s }) {
        if (received !== undefined) item.received = received;
        item.waits_s = waits_s;
        const phase = waits_s > 0 ? "waiting" : "sending";
        if (phase === "waiting" && item.phase !== "waiting") keep(item);
        item.phase = phase;
        draw();
      },
    };
    const onBegun = (id) => {
      item.uploadId = id;
      keep(item);
    };
    try {
      item.uploadId = await sendFile(item.file, { ...hints, uploadId: item.uploadId, onBegun });
      const provenance = Object.fromEntries(Object.entries(item.provenance).filter(([, value]) => value.trim()));
      const headers = { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` };
      const body = { kind: item.kind, upload: item.uploadId, parameters: item.parameters, provenance };
      const { data } = await untilAnswered(() => {
        item.phase = "starting";
        draw();
        return post("/imports", body, { headers });
      }, hints);
      takeOff(item);
      say(t("{name} is being read.", { name: item.name }));
      onStarted(data, { isLast: !items.some(isUnderWay) });
    } catch (error) {
      if (error.name === "AbortError") return;
      if (!(error instanceof ApiError)) throw error;
      Object.assign(item, { phase: "failed", problem: error.message });
      draw();
    }
  }

  /** What has arrived stays there for a day, so that somebody who stopped can go on. */
  function stop(item) {
    item.controller?.abort();
    item.phase = "chosen";
    keep(item);
    draw();
  }

  function takeOff(item) {
    item.controller?.abort();
    remembered.forget(item.mark);
    items = items.filter((other) => other !== item);
    cards.delete(item.mark);
    draw();
  }

  input.addEventListener("change", async () => {
    const files = [...input.files];
    input.value = "";
    await take(files);
  });
  listenToDrops(drop, (files) => (files.length ? take(files) : toast("Only files can be dropped here.")));
  addEventListener("beforeunload", (event) => {
    if (items.some(isUnderWay)) event.preventDefault();
  });
  draw();
  return { choose: () => input.click() };
}

async function headOf(file) {
  return new Uint8Array(await file.slice(0, HEAD_BYTES).arrayBuffer());
}

/** A file may be dropped anywhere on the page; the drop place says so meanwhile. */
function listenToDrops(drop, take) {
  const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  let depth = 0;
  const mark = (isOver) => (isOver ? (drop.dataset.over = "true") : delete drop.dataset.over);
  addEventListener("dragenter", (event) => {
    if (!hasFiles(event)) return;
    depth += 1;
    mark(true);
  });
  addEventListener("dragleave", (event) => {
    if (!hasFiles(event)) return;
    depth = Math.max(0, depth - 1);
    if (!depth) mark(false);
  });
  addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
  addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    depth = 0;
    mark(false);
    take([...event.dataTransfer.files]);
  });
}

/** Said instead of the tools where somebody may not bring data in. */
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
