/** Where a static file is that is loaded by name and not imported: its address changes with its content, so the page says it. */

/** @param {string} name below /static/ */
export function staticAddress(name) {
  /** @type {HTMLMetaElement | null | undefined} */
  const summary = globalThis.document?.querySelector(`meta[name="static:${name}"]`);
  return new URL(summary?.content ?? `/static/${name}`, globalThis.location?.origin ?? "http://localhost").href;
}
