/* Runs before the first paint, so that nothing flashes: the account's theme, which the server wrote into the page, else what this browser had last. */
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
