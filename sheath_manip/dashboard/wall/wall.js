// The wall lies over a replay: O opens it, Enter or a click shows that moment, Escape goes back.
const reopens = window.sheathWall?.shown ?? false;
window.sheathWall?.close();

const readAgainMs = 3000;
const here = `${location.pathname.replace(/\/$/, "")}${settings.path}`;
const get = (path) => fetch(here + path, { headers: { Accept: "*/*" } });

const style = document.createElement("style"), dialog = document.createElement("dialog");
style.textContent = settings.style;
document.head.append(style);
dialog.id = "sheath-wall";
dialog.setAttribute("aria-labelledby", "sheath-wall-title");
const head = document.createElement("header"), title = document.createElement("h2"), says = document.createElement("p");
title.id = "sheath-wall-title";
title.textContent = "Moments";
says.setAttribute("role", "status");
const button = (text, act) => Object.assign(document.createElement("button"), { type: "button", textContent: text, onclick: act });
const clipping = makeClipping(get);
let table = { count: 0 }, found = [], told = null, reading = 0, wasOpened = false, chosenKey = "";

const filters = makeFilters(() => filter());
const grid = makeGrid({ fill, open: (at) => show(table.row(found[at])) });
head.append(title, says, button("Clip (C)", clip), button("Close (Esc)", () => dialog.close()));
dialog.append(head, filters.form, grid.box);
const opener = button("Moments (O)", () => reveal());
opener.id = "sheath-wall-open";
opener.className = "sheath-small";
document.body.append(dialog, opener);

function fill(tile, at) {
  const moment = table.row(found[at]), atS = (moment.step / moment.rateHz).toFixed(1);
  const picture = document.createElement("div"), frame = document.createElement("div"), words = document.createElement("div");
  picture.className = "picture";
  frame.className = "frame";
  picture.append(frame);
  words.className = "words";
  const line = (text, name) => words.append(Object.assign(document.createElement("div"), { textContent: text, className: name }));
  line(moment.kind, "kind");
  words.firstChild.style.setProperty("--kind", settings.colours[moment.code]);
  line(moment.text || [moment.reason, moment.actor].filter(Boolean).join(" · ") || `after ${moment.steps} steps`, "why");
  line(`${atS} s · ${moment.method} r${moment.round} · ${moment.outcome}`, "where");
  tile.append(picture, words);
  tile.title = `${moment.name}, step ${moment.step + 1} of ${moment.steps}` +
    (moment.margin === null ? "" : `, margin ${moment.margin.toFixed(2)}`);
  tile.setAttribute("aria-label", `${[...words.children].map((each) => each.textContent).join(", ")}; ${tile.title}`);
  tile.rest = () => {
    tile.rest = null;
    const image = new Image();
    image.alt = "";
    image.onload = () => {
      // One frame of the strip is to be seen at a time, as large as there is room for.
      const ratio = image.naturalWidth / settings.frames / image.naturalHeight;
      const room = picture.clientWidth / picture.clientHeight;
      frame.style.cssText = ratio > room ? `width:100%;aspect-ratio:${ratio}` : `height:100%;aspect-ratio:${ratio}`;
      image.style.width = `${100 * settings.frames}%`;
      frame.append(image);
      tile.show = (shown) => { image.style.transform = `translateX(${(-100 * shown) / settings.frames}%)`; };
      tile.show(settings.middle);
    };
    image.onerror = () => picture.classList.add("blank");
    image.src = `${here}strip/${moment.place}/${moment.step}`;
  };
}

function filter() {
  if (!told) return;
  found = matching(table, filters.wanted);
  const at = found.findIndex((each) => table.key(each) === chosenKey);
  grid.show(found.length, Math.max(0, at));
  const many = (count) => count.toLocaleString("en");
  const read = told.read < told.of ? ` · reading ${many(told.read)} of ${many(told.of)} episodes` : ` in ${many(told.of)} episodes`;
  const damaged = told.damaged ? ` · ${told.damaged} cannot be read: sheath data check` : "";
  says.textContent = `${many(found.length)} of ${many(table.count)}${read}${damaged}`;
}

async function read() {
  clearTimeout(reading);
  if (!dialog.open) return;
  const answer = await get("moments").catch(() => null);
  if (!answer?.ok) says.textContent = "the moments cannot be had: no connection";
  else {
    told = await answer.json();
    chosenKey = found.length ? table.key(found[grid.chosen]) : chosenKey;
    table = readTable(told);
    filters.offer(table);
    filter();
  }
  if (!told || told.read < told.of) reading = setTimeout(read, readAgainMs);
}

function reveal() {
  if (!dialog.open) dialog.showModal();
  // Nobody sees what plays behind it.
  window.sheathSeek?.send({ key: "stop" });
  wasOpened = false;
  grid.box.focus();
  read();
}
function show(moment) {
  window.sheathSeek?.send({ episode: moment.place, step: moment.step });
  chosenKey = moment.key;
  dialog.close();
  wasOpened = true;
}
async function clip() {
  if (dialog.open) { if (found.length) clipping.ask(table.row(found[grid.chosen])); return; }
  const now = await get("now").then((answer) => answer.json(), () => null);
  if (now) clipping.ask({ place: now.place, step: now.step, steps: now.steps, rateHz: now.rate_hz });
}
dialog.onclose = () => { clearTimeout(reading); grid.still(); };

const writes = (target) => target instanceof Element && target.closest("input, textarea, select, [contenteditable='true']");
function press(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("#sheath-clip[open], #sheath-note")) return;
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (name === "Escape" && writes(event.target) && dialog.open) grid.box.focus();
  else if (writes(event.target)) return;
  else if (name === "/" && dialog.open) { filters.text.focus(); filters.text.select(); }
  else if (name === "c") clip();
  else if (name === "o") dialog.open ? dialog.close() : reveal();
  // Whose list or menu is open closes that by it.
  else if (name === "Escape" && wasOpened && !dialog.open && [document.body, opener].includes(document.activeElement)) reveal();
  else return;
  event.preventDefault();
  event.stopImmediatePropagation();
}
// Enter in the text goes on to what it found.
filters.text.onkeydown = (event) => { if (event.key === "Enter" || event.key === "ArrowDown") { event.preventDefault(); grid.box.focus(); } };
window.addEventListener("keydown", press, true);
if (reopens) reveal();

window.sheathWall = {
  get shown() { return dialog.open; },
  get count() { return found.length; },
  close() {
    clearTimeout(reading);
    grid.close();
    clipping.remove();
    window.removeEventListener("keydown", press, true);
    for (const each of [style, dialog, opener]) each.remove();
  },
};
