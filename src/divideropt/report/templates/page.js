// What every part of the page's script begins with: the data, elements by id, and how a number is written.

const report = JSON.parse(document.getElementById("report-data").textContent);
const byId = (id) => document.getElementById(id);
const plain = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;"); // plotly reads tags

/** With an exponent that is a multiple of 3, as engineers write it. */
function raised(value) {
  const [mantissa, exponent] = value.toExponential(3).split("e").map(Number);
  const over = ((exponent % 3) + 3) % 3;
  const power = String(exponent - over).replace("-", "⁻").replace(/[0-9]/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);
  return (mantissa * 10 ** over).toFixed(3 - over) + "·10" + power;
}

function number(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const whole = Math.max(0, Math.floor(Math.log10(size)) - 3); // digits that four do not reach: 12345 is no 1.235e+4
  const text = size === 0 ? "0" : size < 1e-4 || size >= 1e6 ? raised(value) : whole ? value.toFixed(0) : value.toPrecision(4);
  return text.replace("-", "−");
}

const onPaper = () => window.matchMedia("print").matches;
const crisp = () => Math.max(onPaper() ? 3 : 1, window.devicePixelRatio || 1); // pixels of a canvas for one of the page
const divisor = (a, b) => (b ? divisor(b, a % b) : a);

/** The same in an order that jumps through it by the golden ratio: what is drawn last is not all of the last strategy. */
function mixed(list) {
  const { length } = list;
  let step = Math.max(1, Math.round(0.618 * length));
  while (divisor(length, step) > 1) step += 1;
  return list.map((_, i) => list[(i * step) % length]);
}

const counted = (count, word) => count + " " + word + (count === 1 ? "" : "s");

function make(name, text, attributes) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  for (const [key, value] of Object.entries(attributes || {})) element.setAttribute(key, value);
  return element;
}

/** Give a text to the user as a file. */
function offer(text, name, kind) {
  const address = URL.createObjectURL(new Blob([text], { type: kind }));
  make("a", undefined, { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
