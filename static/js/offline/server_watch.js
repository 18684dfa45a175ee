/** Poll the server while it is unavailable; reloads the page once it answers. */

const ASK_INTERVAL_MS = 5_000;
const ASK_TIMEOUT_MS = 4_000;
const ANSWERS = new Set([200, 401, 403]); // of the application: the page can be loaded from it
const ELSEWHERE = new Set(["/sign-out", "/offline"]); // no pages to come back to

export function watchServer() {
  const ask = async () => {
    try {
      const answer = await fetch("/api/v1/account/session", { signal: AbortSignal.timeout(ASK_TIMEOUT_MS) });
      if (!ANSWERS.has(answer.status)) return;
      if (ELSEWHERE.has(location.pathname)) location.href = "/";
      else location.reload();
    } catch {
      /* still unavailable */
    }
  };
  setInterval(() => void ask(), ASK_INTERVAL_MS);
  addEventListener("online", () => void ask());
}
