// The designs that the page knows, by id and by row: the first `drawn` rows are in the figures, the best come first.

const fields = report.fields || [];
const firstObjective = fields.length - (report.objectives || 0);
const ids = report.designs ? report.designs.ids : [];
const drawnDesigns = report.designs ? report.designs.drawn : 0;
const rowOf = new Map(ids.map((id, row) => [id, row]));
const columns = fields.map((field, i) =>
  Float64Array.from(report.designs.values[i], (value) => (value === null ? NaN : value * field.scale)));

const met = (row, i) => report.designs.values[i][row] <= fields[i].goal;
const attainment = (row) => report.designs.attainment && report.designs.attainment[row];
