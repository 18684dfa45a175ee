/* Runs before the first paint: the theme that was chosen in this browser, so that nothing flashes. */
try {
  const chosen = localStorage.getItem("spanwise.theme");
  if (chosen === "light" || chosen === "dark") document.documentElement.dataset.theme = chosen;
} catch {
  /* storage is closed: the system's theme stands */
}
