/** Parser of voltages. */

export const MAX_KV = 2_000;

/** "110, 20" or "110 kV; 20 kV" → volts, highest first; null where a part is no voltage. @param {string} words */
export function voltsOf(words) {
  const parts = words
    .split(/[;,/]/)
    .map((part) => part.replace(/kv/i, "").trim())
    .filter(Boolean);
  const volts = parts.map((part) => (/^\d+(\.\d+)?$/.test(part) ? Math.round(Number(part) * 1000) : 0));
  return volts.every((each) => each >= 1 && each <= MAX_KV * 1000) ? [...new Set(volts)].sort((a, b) => b - a) : null;
}
