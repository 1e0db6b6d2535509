// The widths at which the page is arranged otherwise; `lab.css` has the same.

const narrow = matchMedia("(max-width: 1080px)");
const phone = matchMedia("(max-width: 760px)");

/** Whether the exercise stands below the picture, not in a column of its own beside it. */
export const isNarrow = () => narrow.matches;

/** Whether dialogs are sheets at the bottom. */
export const isPhone = () => phone.matches;

/** Calls a listener when the page has to be arranged otherwise. */
export function onWidthChange(listener: () => void) {
  narrow.addEventListener("change", listener);
  phone.addEventListener("change", listener);
}
