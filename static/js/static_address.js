/** Address of a static file that is loaded by name and not imported: it changes with the content, so the page supplies it. */

/** @param {string} name below /static/ */
export function staticAddress(name) {
  /** @type {HTMLMetaElement | null | undefined} */
  const summary = globalThis.document?.querySelector(`meta[name="static:${name}"]`);
  return new URL(summary?.content ?? `/static/${name}`, globalThis.location?.origin ?? "http://localhost").href;
}
