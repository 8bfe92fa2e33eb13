// The selection in the address, `#select=nsga2-1/3.14,complex-1/7&show=nsga2-1/14`: by run, so that it stays short. What
// comes from there is from anybody: only the ids of designs that the page has are taken from it.

const LONGEST_FRAGMENT = 200000; // characters; a front of 5,000 designs has some 25,000
const RUN = /^[a-z0-9_]{1,64}-[0-9]{1,20}(-branch-[0-9]{1,20})?$/;

/** Read a fragment; null where it is no selection. */
function readFragment(text) {
  if (text.length > LONGEST_FRAGMENT || !/^#select=[a-z0-9_./,&=-]+$/.test(text)) return null;
  const [list, show, ...more] = text.slice("#select=".length).split("&");
  if (more.length || (show !== undefined && !show.startsWith("show="))) return null;
  const found = [];
  for (const part of list.split(",")) {
    const [run, places, ...rest] = part.split("/");
    if (rest.length || places === undefined || !RUN.test(run)) return null;
    found.push(...places.split(".").map((place) => run + "/" + place));
  }
  return { ids: [...new Set(found)], lead: show && show.slice("show=".length) };
}

function writeFragment() {
  const byRun = new Map();
  for (const id of selection.ids) {
    const [run, place] = id.split("/");
    if (!RUN.test(run)) continue;
    if (!byRun.has(run)) byRun.set(run, []);
    byRun.get(run).push(place);
  }
  const list = [...byRun].map(([run, places]) => run + "/" + places.join(".")).join(",");
  const lead = selection.ids.size > 1 ? "&show=" + selection.lead : "";
  const ours = location.hash.startsWith("#select=");
  if (list) history.replaceState(null, "", "#select=" + list + lead);
  else if (ours) history.replaceState(null, "", location.pathname + location.search);
}

/** Select what the address names; undefined where it names nothing that the page has. */
function restore() {
  const wanted = readFragment(location.hash);
  if (wanted === null) return undefined;
  const missing = wanted.ids.filter((id) => !rowOf.has(id)).length;
  if (missing) announceMissing(missing, wanted.ids.length);
  return missing < wanted.ids.length ? choose(wanted.ids, "address", wanted.lead) : undefined;
}

function followInAddress() {
  followThen(writeFragment);
  window.addEventListener("hashchange", () => {
    if (restore() !== undefined) return;
    if (location.hash === "" && selection.active) clearSelection();
    else if (selection.active) writeFragment(); // a link to a section has been followed: the address names the selection again
  });
}
