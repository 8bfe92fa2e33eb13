// The one selection: a set of designs, and the one of them that is shown closely. Whoever shows it, follows it.

const selection = {
  active: false, // without, nothing is told apart, and the best design is shown
  ids: new Set(), // in the page's order; may be empty where it is active: brushes through which no line goes
  lead: null, // the design shown closely
  by: "", // the view it was made in: the id of its element
};
const followers = { first: [], then: [] };
const follow = (follower) => followers.first.push(follower); // what is cheap: one sees at once what was selected
const followThen = (follower) => followers.then.push(follower); // when that is on the screen

/** Select designs, unknown ones left out; returns when every view has followed. */
function choose(wanted, by, lead) {
  const known = [...new Set(wanted)].filter((id) => rowOf.has(id)).sort((a, b) => rowOf.get(a) - rowOf.get(b));
  selection.active = true;
  selection.ids = new Set(known);
  selection.by = by;
  selection.lead = [lead, selection.lead].find((id) => selection.ids.has(id)) ?? known[0] ?? null;
  return tell();
}

/** Show another design of the selection closely. */
function showClosely(id) {
  if (!selection.ids.has(id)) return undefined;
  selection.lead = id;
  return tell();
}

/** Select one design, or with a key held add it to the selection or take it out. */
function pick(id, by, event) {
  if (!rowOf.has(id)) return undefined;
  if (!selection.active || !event || !(event.ctrlKey || event.metaKey || event.shiftKey)) return choose([id], by, id);
  const others = [...selection.ids].filter((other) => other !== id);
  if (!selection.ids.has(id)) return choose([...others, id], by, id);
  return others.length ? choose(others, by) : clearSelection();
}

function clearSelection() {
  selection.active = false;
  selection.ids = new Set();
  selection.by = "";
  selection.lead = report.selected;
  return tell();
}

const TASK = 30; // how long views follow before what was touched meanwhile has its turn [ms]

/** The next frame is on the screen; of a page in the background no frame is drawn. */
const painted = () => new Promise((done) => {
  requestAnimationFrame(() => setTimeout(done));
  setTimeout(done, 100);
});
const isReady = () => "ready" in document.documentElement.dataset; // else there is nothing to be seen yet

let told = 0; // selections so far

/** Tell everybody of the selection; whom another one overtakes is told of that one only. */
async function tell() {
  told += 1;
  const turn = told;
  document.documentElement.dataset.following = "yes"; // until all have
  for (const follower of followers.first) follower();
  if (isReady()) await painted();
  let began = performance.now();
  for (const follower of followers.then) {
    if (isReady() && performance.now() - began > TASK) {
      await new Promise((done) => setTimeout(done));
      began = performance.now();
    }
    if (turn !== told) return;
    await follower();
  }
  if (turn === told) delete document.documentElement.dataset.following;
}
