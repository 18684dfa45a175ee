/** Side, map and dock; on a phone one page that scrolls: the sentence, the map, the replay, then the rest. */

import { byId } from "../dom.js";

const phone = matchMedia("(max-width: 720px)");

export function mountLayout() {
  const [workbench, rest, foot] = [byId("workbench"), byId("report-rest"), byId("report-foot")];
  const place = () => {
    if (phone.matches) byId("report-rest-on-phone").append(rest, foot);
    else {
      byId("side-scroll").append(rest);
      byId("side").append(foot);
    }
  };
  phone.addEventListener("change", place);
  place();
  return {
    /** @param {"side" | "dock"} part */
    fold(part) {
      if (workbench.dataset[part] === "folded") delete workbench.dataset[part];
      else workbench.dataset[part] = "folded";
    },
  };
}
