// A grid of tiles of which only those in sight exist: 100,000 of them cost no more than 100.
const gapPx = 10, wordsPx = 74, restMs = 90, nextFrameMs = 220;

function makeGrid({ fill, open }) {
  const box = document.createElement("div"), sheet = document.createElement("div"), tiles = new Map();
  box.className = "grid";
  box.tabIndex = 0;
  box.setAttribute("role", "listbox");
  box.setAttribute("aria-label", "Moments, the worst first");
  sheet.setAttribute("role", "presentation");
  box.append(sheet);
  let count = 0, chosen = 0, columns = 1, widthPx = 0, heightPx = 0, drawing = 0, resting = 0, playing = 0;

  function measure() {
    const room = box.clientWidth - gapPx;
    columns = Math.max(1, Math.floor(room / ((room < 620 ? 156 : 226) + gapPx)));
    widthPx = Math.floor(room / columns) - gapPx;
    heightPx = Math.round(widthPx * 0.6) + wordsPx;
    sheet.style.height = `${Math.ceil(count / columns) * (heightPx + gapPx) + gapPx}px`;
  }
  function put(at) {
    const tile = tiles.get(at) ?? document.createElement("div");
    if (!tiles.has(at)) {
      tile.className = "tile";
      tile.id = `sheath-moment-${at}`;
      tile.setAttribute("role", "option");
      tile.setAttribute("aria-setsize", count);
      tile.setAttribute("aria-posinset", at + 1);
      tile.onclick = () => { choose(at); open(at); };
      tile.onpointerenter = () => play(tile);
      tile.onpointerleave = () => play(null);
      fill(tile, at);
      tiles.set(at, tile);
      sheet.append(tile);
    }
    const left = gapPx + (at % columns) * (widthPx + gapPx), top = gapPx + Math.floor(at / columns) * (heightPx + gapPx);
    tile.style.cssText = `left:${left}px;top:${top}px;width:${widthPx}px;height:${heightPx}px`;
    tile.setAttribute("aria-selected", at === chosen);
  }
  function draw() {
    drawing = 0;
    const rows = heightPx + gapPx, first = Math.max(0, Math.floor(box.scrollTop / rows) - 1) * columns;
    const stop = Math.min(count, (Math.ceil((box.scrollTop + box.clientHeight) / rows) + 1) * columns);
    for (const [at, tile] of tiles) if (at < first || at >= stop) { tile.remove(); tiles.delete(at); }
    for (let at = first; at < stop; at++) put(at);
    if (tiles.has(chosen)) box.setAttribute("aria-activedescendant", `sheath-moment-${chosen}`);
    else box.removeAttribute("aria-activedescendant");
    // Who scrolls past wants no picture.
    clearTimeout(resting);
    resting = setTimeout(() => tiles.forEach((tile) => tile.rest?.()), restMs);
  }
  const soon = () => { drawing ||= requestAnimationFrame(draw); };
  function play(tile) {
    clearInterval(playing);
    for (const each of tiles.values()) each.show?.(settings.middle);
    let frame = 0;
    if (tile && !matchMedia("(prefers-reduced-motion: reduce)").matches)
      playing = setInterval(() => tile.show?.(frame++ % settings.frames), nextFrameMs);
  }
  function choose(at) {
    chosen = Math.max(0, Math.min(count - 1, at));
    const top = gapPx + Math.floor(chosen / columns) * (heightPx + gapPx);
    if (top - gapPx < box.scrollTop) box.scrollTop = top - gapPx;
    else if (top + heightPx + gapPx > box.scrollTop + box.clientHeight)
      box.scrollTop = top + heightPx + gapPx - box.clientHeight;
    draw();
    play(tiles.get(chosen));
  }
  const page = () => columns * Math.max(1, Math.floor(box.clientHeight / (heightPx + gapPx)));
  const moves = {
    ArrowLeft: () => -1, ArrowRight: () => 1, ArrowUp: () => -columns, ArrowDown: () => columns,
    PageUp: () => -page(), PageDown: page, Home: () => -count, End: () => count,
  };
  box.onkeydown = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !count) return;
    if (event.key === "Enter" || event.key === " ") open(chosen);
    else if (event.key in moves) {
      const to = chosen + moves[event.key]();
      // In the last row there may be nothing right below.
      choose(event.key === "ArrowUp" && to < 0 ? chosen : to);
    } else return;
    event.preventDefault();
  };
  box.onscroll = soon;
  box.onfocus = () => { if (count) play(tiles.get(chosen)); };
  const sizes = new ResizeObserver(() => { measure(); draw(); });
  sizes.observe(box);
  return {
    box,
    get chosen() { return chosen; },
    show(length, at) {
      for (const tile of tiles.values()) tile.remove();
      tiles.clear();
      count = length;
      chosen = Math.max(0, Math.min(count - 1, at));
      measure();
      if (!at) box.scrollTop = 0;
      draw();
    },
    still() { play(null); },
    close() { clearTimeout(resting); clearInterval(playing); sizes.disconnect(); },
  };
}
