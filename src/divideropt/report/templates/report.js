// How a page begins: with the selection, then the figures that show it; WebGL when it comes into view.

function showQuantity(name) { // one quantity over every parameter of a study
  const figure = shown.get("panels");
  const chosen = report.quantities[name];
  figure.data.forEach((trace, i) => { trace.y = chosen.y[i]; });
  for (const [key, axis] of Object.entries(figure.layout)) {
    if (!/^yaxis/.test(key)) continue;
    axis.range = [...chosen.range];
    if (axis.title) axis.title.text = chosen.label;
  }
  figure.layout.uirevision = name; // what was zoomed is another's
  return redraw(figure);
}

/** Make tables smaller that are wider than the paper. */
function fitToPaper() {
  for (const frame of document.querySelectorAll(".scroll")) {
    for (const content of frame.children) content.style.zoom = "";
    const share = Math.min(1, frame.clientWidth / frame.scrollWidth);
    if (onPaper()) for (const content of frame.children) content.style.zoom = share;
  }
}

/** Open what is folded away while the page is printed: paper has nothing to click. */
function unfoldForPaper() {
  for (const details of document.querySelectorAll(onPaper() ? "details:not([open])" : "details[data-folded]")) {
    details.toggleAttribute("data-folded", onPaper());
    details.open = onPaper();
  }
}

async function beginSelecting() {
  followInTables();
  followClosely();
  followInSketch();
  followInSheet();
  followToggle();
  beginParallel();
  followInBar();
  followInAddress();
  followInFigures(); // after the others: there may be WebGL among them
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && selection.active) clearSelection();
  });
  await (restore() ?? clearSelection());
}

function offerCampaign() { // as it stands in the page, which is what the store has
  const button = byId("save-campaign");
  if (button) button.addEventListener("click", () => offer(byId("campaign").textContent, "campaign.yaml", "application/yaml"));
}

async function begin() {
  beginScrollers();
  offerCampaign();
  const pictures = report.figures.filter((figure) => figure.webgl);
  if (report.selected) await beginSelecting(); // first: so that the figures are drawn once, with the selection in them
  const flat = report.figures.filter((figure) => !figure.webgl);
  const first = flat.filter((figure) => !report.selected || isDotted(figure) || figure.id === "response");
  for (const figure of first) await draw(figure);
  document.documentElement.dataset.ready = Math.round(performance.now()); // for brushes, since the navigation [ms]
  for (const figure of flat.filter((other) => !first.includes(other))) {
    await idle();
    await draw(figure);
  }
  if (report.quantities) byId("quantity").addEventListener("change", (event) => showQuantity(event.target.value));
  if (pictures.length && report.selected) await idle();
  const able = pictures.length > 0 && webgl();
  for (const figure of pictures) drawWhenSeen(figure, able);
  for (const media of ["(prefers-color-scheme: dark)", "print"]) {
    window.matchMedia(media).addEventListener("change", () => {
      themed = null;
      if (media === "print") {
        unfoldForPaper();
        fitToPaper();
      }
      shown.forEach(redraw);
      if (media === "print") pictures.filter(() => able).forEach(see);
      if (report.selected) layOut();
    });
  }
  window.addEventListener("resize", () => {
    if (!onPaper()) return;
    fitToPaper();
    shown.forEach((_, id) => fit(byId(id))); // at once: the page may be printed next
  });
  document.documentElement.dataset.drawn = Math.round(performance.now()); // since the navigation [ms]
  if (able) for (const figure of pictures) whenQuiet(() => see(figure)); // for who scrolls quickly, and for pictures of the page
}

begin();
