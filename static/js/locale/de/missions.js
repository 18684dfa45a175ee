/** The list of missions. English → German; [one, other] where there is a plural. */

export default {
  "{count} mission": ["{count} Mission", "{count} Missionen"],
};
