/** "Import": a zone file is sent from the page of zones; its difference is then shown on the page of imports. */

import { ApiError, post } from "../api.js";
import { guessKind, headOf, setNameOf, whyNotSent } from "../imports/kinds.js";
import { sendFile } from "../imports/send_file.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { percentText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { Proposal } from "../api_types.d.ts" */

/** @param {HTMLElement} button @param {HTMLInputElement} input of type file */
export function mountImportButton(button, input) {
  button.addEventListener("click", () => input.click());
  input.addEventListener("change", async () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) await send(file);
  });
}

/** @param {File} file */
async function send(file) {
  const head = await headOf(file);
  const why = whyNotSent(file.name, file.size, head);
  if (why) return toast(why);
  if (guessKind(file.name, head) !== "zones") {
    const act = () => location.assign("/imports");
    return toast(t("“{name}” holds no zones: import it on the page Imports.", { name: file.name }), {
      label: t("Imports"),
      act,
    });
  }
  try {
    const signal = new AbortController().signal;
    /** @param {{ received?: number }} progress */
    const notify = ({ received = 0 }) =>
      toast(t("Sending {name}: {percent}", { name: file.name, percent: percentText((received * 100) / file.size) }));
    const upload = await sendFile(file, { signal, notify });
    const body = { kind: "zones", upload, parameters: { set_name: setNameOf(file.name) } };
    const { data } = /** @type {Answer<Proposal>} */ (await post("/imports", body));
    location.assign(`/imports/${data.id}`);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}
