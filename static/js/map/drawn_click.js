/** Swallow the click that ends or drops a drawing on the map, so that it picks nothing. */

/**
 * Returns { begins(), ends() }: a press that may become a drawing, and a drawing that has come to its end.
 *
 * @param {HTMLElement} canvas
 */
export function swallowDrawnClick(canvas) {
  let isDrawn = false;
  canvas.addEventListener(
    "click",
    (event) => {
      if (isDrawn) event.stopImmediatePropagation();
      isDrawn = false;
    },
    true,
  );
  return {
    begins() {
      isDrawn = false;
    },
    ends() {
      isDrawn = true;
    },
  };
}
