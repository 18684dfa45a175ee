import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

globalThis.document ??= { cookie: "", documentElement: { dataset: {}, lang: "en" }, querySelector: () => null };
const { UploadQueue, sha256Of } = await import("../../../static/js/photos/upload_queue.js");

const PART = 4;
/** A server that keeps what it gets, and whose line can be cut. */
let server;

beforeEach(() => {
  server = { uploads: new Map(), known: new Set(), cuts: [], requests: [], open: 0, most: 0 };
  globalThis.fetch = async (address, { method, body, headers }) => {
    server.requests.push(`${method} ${address}`);
    server.open += 1;
    server.most = Math.max(server.most, server.open);
    await new Promise((resolve) => setTimeout(resolve, 1));
    server.open -= 1;
    const cut = server.cuts.shift();
    if (cut === "before") throw new TypeError("cut");
    const answer = await respond(address, method, body, headers);
    if (cut === "after") throw new TypeError("cut");
    return answer;
  };
});

const json = (status, value) => new Response(value === null ? null : JSON.stringify(value), { status });

async function respond(address, method, body, headers) {
  if (method === "POST") {
    const stated = JSON.parse(body);
    if (stated.file_name.endsWith(".html"))
      return json(422, { error: { code: "unsupported_type", message: "None of the supported kinds." } });
    const facts = { part_bytes: PART, size_bytes: stated.size_bytes, received_bytes: 0, is_known: false };
    if (server.known.has(stated.sha256)) return json(200, { ...facts, id: null, is_known: true });
    const id = String(server.uploads.size + 1);
    server.uploads.set(id, { stated, text: "" });
    return json(201, { ...facts, id });
  }
  const upload = server.uploads.get(address.split("/").at(-1));
  if (Number(headers["Upload-Offset"]) !== upload.text.length)
    return json(409, { error: { code: "offset", message: "", details: { received_bytes: upload.text.length } } });
  upload.text += await body.text();
  return json(204, null);
}

const file = (text, name = "DJI_1.JPG", lastModified = 1) => new File([text], name, { lastModified });
const queueOf = (stated = {}) => new UploadQueue({ stated, notify: () => {}, pause: async () => {} });
const texts = () => [...server.uploads.values()].map(({ text }) => text);

test("files are sent in parts with what they show, two at once", async () => {
  const queue = queueOf({ mission: "m" });
  await queue.add([file("0123456789"), file("abcd", "DJI_2.JPG"), file("x", "DJI_3.JPG")]);
  assert.deepEqual(texts().sort(), ["0123456789", "abcd", "x"]);
  assert.equal(server.uploads.get("1").stated.mission, "m");
  assert.equal(server.most, 2);
  assert.deepEqual(
    { ...queue.summary(), left_s: 0 },
    {
      count: 3,
      done: 3,
      known: 0,
      failed: 0,
      share: 1,
      isBusy: false,
      isPaused: false,
      left_s: 0,
    },
  );
});

test("a line that is cut before or after a part arrives costs nothing but time", async () => {
  server.cuts = [null, "before", "after", "before", "after", "after"];
  const queue = queueOf();
  await queue.add([file("0123456789abcdef")]);
  assert.deepEqual(texts(), ["0123456789abcdef"]);
  assert.equal(queue.items[0].phase, "done");
});

test("what the server knows is not sent", async () => {
  const photo = file("0123456789");
  server.known.add(await sha256Of(photo));
  const queue = queueOf();
  await queue.add([photo, file("other", "DJI_2.JPG")]);
  assert.deepEqual(
    queue.items.map(({ phase }) => phase),
    ["known", "done"],
  );
  assert.equal(server.requests.filter((one) => one.startsWith("PATCH")).length, 2);
});

test("a file that is refused names why, the others go on, and it can be tried again", async () => {
  const queue = queueOf();
  await queue.add([file("<html>", "page.html"), file("abcd")]);
  assert.deepEqual(
    queue.items.map(({ phase, problem }) => [phase, problem]),
    [
      ["failed", "None of the supported kinds."],
      ["done", ""],
    ],
  );
  assert.equal(queue.summary().failed, 1);
  await queue.retry();
  assert.equal(server.requests.filter((one) => one.startsWith("POST")).length, 3);
});

test("a file that is dropped twice is sent once", async () => {
  const queue = queueOf();
  await Promise.all([queue.add([file("abcd"), file("abcd")]), queue.add([file("abcd")])]);
  await queue.add([file("abcd")]);
  assert.deepEqual(texts(), ["abcd"]);
});

test("the hash is that of the standard", async () => {
  assert.equal(await sha256Of(file("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
});
