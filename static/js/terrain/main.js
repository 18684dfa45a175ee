/** The page "Terrain": composes its panel and the map. */

import { mountGroundPage } from "../ground/ground_page.js";

mountGroundPage().open();
