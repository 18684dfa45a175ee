/** Words that stand everywhere: units, counts, times, the bar. English → German; [one, other] where there is a plural. */

export default {
  now: "jetzt",
  "today, {time}": "heute, {time}",
  "yesterday, {time}": "gestern, {time}",
};
