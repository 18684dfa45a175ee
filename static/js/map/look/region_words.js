/** What a region holds, in words. */

import { countedText } from "../../domain/counted.js";
import { t } from "../../text.js";

/** "488 towers, 31 lines". @param {Record<string, number>} counts by kind */
export const countsText = (counts) => countedText(counts) || t("no assets");
