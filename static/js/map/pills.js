/** Which target pills share one place on the screen, and what a shared one says. Values in, values out. */

const MERGE_PX = 25;
const LONGEST_LABEL = 8;

/** Groups of pills to draw, given their places on the screen: [{ members, x, y }]. */
export function mergePills(pills) {
  const groups = [];
  for (const pill of pills) {
    const group = groups.find(
      (candidate) => candidate.members[0].sequence === pill.sequence && Math.hypot(candidate.x - pill.x, candidate.y - pill.y) < MERGE_PX,
    );
    if (group) group.members.push(pill);
    else groups.push({ x: pill.x, y: pill.y, members: [pill] });
  }
  return groups;
}

/** "C3", "C3–4", "C1, 3–4": letter once, runs with a dash; "C × 12" where that would be long. */
export function mergedLabel(letter, numbers) {
  const runs = [];
  for (const number of [...numbers].sort((a, b) => a - b)) {
    const run = runs.at(-1);
    if (run && number === run.at(-1) + 1) run.push(number);
    else runs.push([number]);
  }
  const label = letter + runs.map((run) => (run.length > 1 ? `${run[0]}–${run.at(-1)}` : `${run[0]}`)).join(", ");
  return label.length <= LONGEST_LABEL ? label : `${letter} × ${numbers.length}`.trim();
}
