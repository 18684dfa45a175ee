/** German, put together from one catalogue for each room of the program. */

import general from "./de/general.js";

export default { ...general };
