/** Address of the map library, in one place. */

import * as maplibre from "/static/lib/maplibre-gl/maplibre-gl.mjs";
import { staticAddress } from "../static_address.js";

maplibre.setWorkerUrl(staticAddress("lib/maplibre-gl/maplibre-gl-worker.mjs"));

export { maplibre };
