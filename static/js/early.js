/* Runs before the first paint. So that nothing flashes: the account's theme, which the server wrote into the page, else what this browser had last. */
try {
  const { dataset } = document.documentElement;
  if (dataset.themeOf === "account") {
    if (dataset.theme) localStorage.setItem("spanwise.theme", dataset.theme);
    else localStorage.removeItem("spanwise.theme");
  } else {
    const chosen = localStorage.getItem("spanwise.theme");
    if (chosen === "light" || chosen === "dark") dataset.theme = chosen;
  }
} catch {
  /* storage is closed: the account's theme or the system's stands */
}

/* Documents that the page's script reads first, requested while it is still loading: api.js takes each once. */
{
  /** @type {HTMLMetaElement | null} */
  const meta = document.querySelector('meta[name="documents"]');
  const isCopy = "offlineCopy" in document.documentElement.dataset;
  const addresses = meta && !isCopy ? meta.content.split(" ").filter(Boolean) : [];
  /** @type {any} */ (globalThis).earlyRequests = new Map(
    addresses.map((/** @type {string} */ address) => {
      const answer = fetch(address, { credentials: "same-origin", headers: { Accept: "application/json" } });
      answer.catch(() => {}); // api.js requests it again
      return [address, answer];
    }),
  );

  /* The page's live feed: live/feed.js takes over the socket with the messages that have come. */
  /** @type {HTMLMetaElement | null} */
  const feed = document.querySelector('meta[name="feed"]');
  if (feed && !isCopy) {
    const socket = new WebSocket(location.origin.replace(/^http/, "ws") + feed.content);
    /** @type {string[]} */
    const messages = [];
    const keep = (/** @type {MessageEvent} */ { data }) => messages.push(data);
    socket.addEventListener("message", keep);
    const take = () => {
      socket.removeEventListener("message", keep);
      return messages;
    };
    /** @type {any} */ (globalThis).earlySocket = { socket, take };
  }
}
