/** SI and ISO times become text here and nowhere else. A no-break space stands before each unit, minus is −. */

const SPACE = "\u00a0";

function grouped(value, digits = 0) {
  return value.toLocaleString("en-GB", { minimumFractionDigits: digits, maximumFractionDigits: digits }).replace("-", "−");
}

export function lengthText(length_m) {
  if (length_m === null || length_m === undefined) return "—";
  if (length_m < 999.5) return `${grouped(Math.round(length_m))}${SPACE}m`;
  const length_km = length_m / 1000;
  return `${grouped(length_km, length_km < 999.95 ? 1 : 0)}${SPACE}km`;
}

export function areaText(area_m2) {
  if (area_m2 < 100_000) return `${grouped(Math.round(area_m2))}${SPACE}m²`;
  const area_km2 = area_m2 / 1e6;
  return `${grouped(area_km2, area_km2 < 10 ? 2 : area_km2 < 999.95 ? 1 : 0)}${SPACE}km²`;
}

export function durationText(duration_s) {
  if (duration_s === null || duration_s === undefined) return "—";
  const minutes = Math.round(duration_s / 60);
  if (duration_s > 0 && minutes === 0) return `1${SPACE}min`;
  if (minutes < 100) return `${minutes}${SPACE}min`;
  const rest = minutes % 60;
  return `${grouped(Math.floor(minutes / 60))}${SPACE}h${rest ? ` ${rest}${SPACE}min` : ""}`;
}

export function heightText(height_m) {
  return `${grouped(Math.round(height_m))}${SPACE}m`;
}

export function speedText(speed_mps) {
  return `${grouped(speed_mps, Number.isInteger(speed_mps) ? 0 : 1)}${SPACE}m/s`;
}

export function percentText(percent) {
  return `${grouped(Math.round(percent))}${SPACE}%`;
}

export function voltageText(voltage_kv) {
  return `${grouped(voltage_kv, Number.isInteger(voltage_kv) ? 0 : 1)}${SPACE}kV`;
}

/** People read latitude first; everything else in the program has longitude first. */
export function coordinateText([longitude, latitude]) {
  return `${grouped(latitude, 4)}, ${grouped(longitude, 4)}`;
}

export function countText(count, singular, plural = `${singular}s`) {
  return `${grouped(count)} ${count === 1 ? singular : plural}`;
}

const isSameDay = (a, b) => a.getFullYear() === b.getFullYear() && a.getMonth() === b.getMonth() && a.getDate() === b.getDate();

export function clockText(iso) {
  return new Date(iso).toLocaleTimeString("en-GB", { hour: "2-digit", minute: "2-digit" });
}

/** "now", "today, 11:40", "yesterday, 09:12", "10 Sep", "10 Sep 2025". */
export function whenText(iso, now = new Date()) {
  const then = new Date(iso);
  if (now - then < 60_000 && now >= then) return "now";
  if (isSameDay(then, now)) return `today, ${clockText(iso)}`;
  const yesterday = new Date(now.getFullYear(), now.getMonth(), now.getDate() - 1);
  if (isSameDay(then, yesterday)) return `yesterday, ${clockText(iso)}`;
  const parts = { day: "numeric", month: "short" };
  if (then.getFullYear() !== now.getFullYear()) parts.year = "numeric";
  return then.toLocaleDateString("en-GB", parts);
}
