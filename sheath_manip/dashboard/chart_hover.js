function () {
  // Sent to each page by the server. A pointer over a chart, a touch on it, or arrows while it has the
  // focus show the numbers of a round in a box; what is said there came with the chart.
  window.sheathHover?.close();
  let chart = null, at = 0;
  const box = document.createElement("div");
  box.id = "sheath-hover";
  box.setAttribute("role", "status");
  box.hidden = true;
  const style = document.createElement("style");
  style.textContent =
    "#sheath-hover { position: fixed; z-index: 10002; pointer-events: none; box-sizing: border-box;" +
    " width: max-content; max-width: min(28em, calc(100vw - 16px)); padding: .5em .8em; border-radius: 6px;" +
    " border: 1px solid #8080808c; box-shadow: 0 2px 14px rgba(0,0,0,.3); background: #fff; color: #22272e;" +
    " font: 13px/1.4 sans-serif; font-variant-numeric: tabular-nums }" +
    "[data-mantine-color-scheme=dark] #sheath-hover { background: #22262c; color: #eceef1 }" +
    "#sheath-hover > div { margin-top: .35em } #sheath-hover small { display: block; opacity: .85 }" +
    "#sheath-hover div > small { padding-left: 2.6em }" +
    "[data-mantine-color-scheme=dark] [data-sheath-tone] { color: color-mix(in oklab, var(--own) 68%, white) !important }" +
    "[data-sheath-chart] { border-radius: 4px } [data-sheath-rule] { visibility: hidden; opacity: .5 }" +
    "[data-sheath-chart][data-shown] [data-sheath-rule] { visibility: visible }";
  document.head.append(style);
  document.body.append(box);

  const roundsOf = (each) => [...each.querySelectorAll("template[data-sheath-round]")];
  const placeOf = (round) => Number(round.dataset.sheathRound);
  function show(target, index) {
    if (chart !== target) hide();
    const rounds = roundsOf(target), drawing = target.querySelector("svg");
    if (!rounds.length) return;
    chart = target;
    at = Math.max(0, Math.min(rounds.length - 1, index));
    const x = placeOf(rounds[at]), rule = target.querySelector("[data-sheath-rule]");
    rule.setAttribute("x1", x);
    rule.setAttribute("x2", x);
    target.dataset.shown = "";
    box.replaceChildren(rounds[at].content.cloneNode(true));
    box.hidden = false;
    // Over the scene, beside the panel; on a narrow page above the chart, or below it. Never out of the window.
    const place = drawing.getBoundingClientRect(), size = box.getBoundingClientRect();
    const beside = place.left - size.width - 24, above = place.top - size.height - 6;
    const middle = place.left + (x / drawing.viewBox.baseVal.width) * place.width;
    const top = beside >= 8 ? place.top : above >= 8 ? above : place.bottom + 6;
    const inside = (wanted, most) => `${Math.max(8, Math.min(wanted, most - 8))}px`;
    box.style.left = inside(beside >= 8 ? beside : middle - size.width / 2, window.innerWidth - size.width);
    box.style.top = inside(top, window.innerHeight - size.height);
    renewal.observe(document.body, { childList: true, subtree: true });
  }
  function hide() {
    renewal.disconnect();
    if (chart) delete chart.dataset.shown;
    chart = null;
    box.hidden = true;
  }
  // A new round draws the chart anew, perhaps below the pointer.
  const renewal = new MutationObserver(() => {
    if (!chart || chart.isConnected) return;
    const label = (each) => each.getAttribute("aria-label"), old = chart, index = at;
    const anew = [...document.querySelectorAll("[data-sheath-chart]")].find((each) => label(each) === label(old));
    const focused = document.activeElement === document.body && old.dataset.focused !== undefined;
    hide();
    if (!anew) return;
    if (focused) anew.focus({ preventScroll: true });
    show(anew, index);
  });

  const under = (target) => (target instanceof Element ? target.closest("[data-sheath-chart]") : null);
  function point(event) {
    const target = under(event.target);
    if (!target) return chart?.matches(":focus-visible") && event.type === "pointermove" ? undefined : hide();
    const drawing = target.querySelector("svg"), place = drawing.getBoundingClientRect();
    const x = ((event.clientX - place.left) / place.width) * drawing.viewBox.baseVal.width;
    const away = roundsOf(target).map((round) => Math.abs(placeOf(round) - x));
    show(target, away.indexOf(Math.min(...away)));
  }
  function focus(event) {
    const target = under(event.target);
    if (!target) return;
    target.dataset.focused = "";
    // One that a pointer gives the focus shows where the pointer is.
    if (target !== chart) show(target, Infinity);
  }
  function blur(event) {
    const target = under(event.target);
    if (!target) return;
    // Not at once: a chart that is being drawn anew loses the focus, too, and gets it back.
    setTimeout(() => {
      delete target.dataset.focused;
      if (target === chart) hide();
    });
  }
  const steps = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity };
  function press(event) {
    if (event.key === "Escape") return hide();
    const target = under(event.target), step = steps[event.key];
    if (!target || step === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    // Neither viser's camera nor a replay gets it.
    event.preventDefault();
    event.stopImmediatePropagation();
    show(target, (target === chart ? at : roundsOf(target).length) + step);
  }

  // A mouse that leaves the window is over nothing any more; a finger that is lifted has just begun to read.
  const leave = (event) => { if (!event.relatedTarget && event.pointerType === "mouse") hide(); };
  const follow = () => { if (chart) show(chart, at); };
  const listening = [
    ["pointermove", point], ["pointerdown", point], ["pointerout", leave], ["focusin", focus],
    ["focusout", blur], ["keydown", press], ["scroll", follow], ["resize", follow],
  ];
  for (const [name, act] of listening) window.addEventListener(name, act, true);

  window.sheathHover = {
    close() {
      for (const [name, act] of listening) window.removeEventListener(name, act, true);
      hide();
      style.remove();
      box.remove();
    },
  };
}
