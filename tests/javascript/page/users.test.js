import assert from "node:assert/strict";
import { test } from "node:test";

import { browserName } from "../../../static/js/account/sign_in_row.js";
import { isSingleKey } from "../../../static/js/page/keyboard.js";

test("a browser is named by what it is and where it runs", () => {
  const names = {
    "Mozilla/5.0 (X11; Linux x86_64; rv:145.0) Gecko/20100101 Firefox/145.0": "Firefox, Linux",
    "Mozilla/5.0 (Windows NT 10.0; Win64; x64) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/142.0.0.0 Safari/537.36 Edg/142.0.0.0":
      "Edge, Windows",
    "Mozilla/5.0 (Linux; Android 15) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/142.0.0.0 Mobile Safari/537.36":
      "Chrome, Android",
    "Mozilla/5.0 (Macintosh; Intel Mac OS X 14_1) AppleWebKit/605.1.15 (KHTML, like Gecko) Version/18.1 Safari/605.1.15":
      "Safari, macOS",
    "Mozilla/5.0 (iPhone; CPU iPhone OS 18_1 like Mac OS X) AppleWebKit/605.1.15 (KHTML, like Gecko) Version/18.1 Mobile/15E148 Safari/604.1":
      "Safari, iOS",
    "curl/8.5.0": "curl/8.5.0",
    "": "—",
  };
  for (const [agent, name] of Object.entries(names)) assert.equal(browserName(agent), name);
});

test("what takes a character alone is a single key; what takes Ctrl, Alt or a named key is not", () => {
  for (const keys of ["p", "?", "/", "[", "1", "g m", "shift+p"]) assert.ok(isSingleKey(keys), keys);
  for (const keys of ["mod+s", "mod+shift+z", "alt+arrowup", "escape", "delete", "enter", "g enter"])
    assert.ok(!isSingleKey(keys), keys);
});
