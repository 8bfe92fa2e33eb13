// The one selection: a set of designs, and the one of them that is shown closely. Whoever shows it, follows it.

const selection = {
  active: false, // without, nothing is told apart, and the best design is shown
  ids: new Set(), // in the page's order; may be empty where it is active: brushes through which no line goes
  lead: null, // the design shown closely
  by: "", // the view it was made in: the id of its element
};
const followers = [];
const follow = (follower) => followers.push(follower);

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

const tell = () => Promise.all(followers.map((follower) => follower(selection)));
