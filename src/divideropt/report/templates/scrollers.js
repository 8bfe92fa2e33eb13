// What is wider than its room, or higher, and so scrolls: keys can reach it where nothing inside can be reached by them.

const REACHED = "a[href], button, select, summary, [tabindex='0']";

function tellScroller(frame) {
  const scrolls = frame.scrollWidth > frame.clientWidth || frame.scrollHeight > frame.clientHeight;
  if (!scrolls || frame.querySelector(REACHED)) {
    for (const name of ["tabindex", "role", "aria-label"]) frame.removeAttribute(name);
    return;
  }
  frame.tabIndex = 0;
  frame.setAttribute("role", "region");
  frame.setAttribute("aria-label", headingAbove(frame) + ", scrolls");
}

/** The last heading before an element; a summary heads what it folds away. */
function headingAbove(element) {
  const before = [...document.querySelectorAll("h1, h2, h3, summary")].filter((heading) =>
    heading.compareDocumentPosition(element) & Node.DOCUMENT_POSITION_FOLLOWING);
  return before.length ? before[before.length - 1].textContent.trim() : document.title;
}

function beginScrollers() {
  const frames = [...document.querySelectorAll(".scroll, pre")];
  const observer = new ResizeObserver((entries) => entries.forEach((entry) => tellScroller(entry.target)));
  for (const frame of frames) observer.observe(frame);
}
