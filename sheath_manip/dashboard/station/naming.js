// Gives names to those of viser's elements that have none, for screen readers, and lays the page out
// around them. viser builds them anew at any time, so they are looked through after each change.
const namingMs = 300;

function nameElements() {
  const named = (element) => (element.getAttribute("aria-label") ?? "").trim() || element.labels?.length;
  // The label that stands in the same row, which for boxes of several fields is not theirs by id.
  function labelOf(element) {
    for (let row = element.parentElement, n = 0; row && n < 6; row = row.parentElement, n++) {
      const label = row.querySelector("label");
      if (label?.textContent.trim()) return label.textContent.trim();
    }
    return "";
  }
  for (const each of document.querySelectorAll("[role=slider], input, select, textarea"))
    if (!named(each)) each.setAttribute("aria-label", labelOf(each) || each.placeholder || "value");
  for (const each of document.querySelectorAll("img:not([alt])")) {
    const window = each.closest("[role=tabpanel], .mantine-Paper-root, section");
    const title = window?.querySelector("[role=tab][aria-selected=true]")?.textContent;
    each.alt = each.parentElement?.parentElement?.textContent.trim() || title || "picture";
  }
  for (const each of document.querySelectorAll("button")) {
    if (each.textContent.trim() || named(each)) continue;
    const closes = each.matches("[class*=CloseButton]");
    each.setAttribute("aria-label", closes ? "Close this message" : each.title || "Settings of the view");
  }
  // viser's whole page is what this one is about.
  document.getElementById("root")?.setAttribute("role", "main");
}

// viser's sheet opens by a touch alone. A button in its handle is there for the keyboard, too: its click is the handle's.
function openerOf(sheet) {
  const there = sheet.querySelector(".sheath-opener");
  if (there) return there;
  const opener = Object.assign(document.createElement("button"), { className: "sheath-opener sheath-small", textContent: "Panel" });
  sheet.querySelector("[style*='cursor: pointer']").append(opener);
  // It begins closed: one touch opens it.
  opener.click();
  return opener;
}

// The scene as it lies beside viser's panel, for what lies over it; on a phone its panel is a sheet.
function layOut(seen, sizes) {
  const canvas = [...document.querySelectorAll("canvas")].find((each) => each.clientHeight > innerHeight / 3);
  const box = canvas?.getBoundingClientRect();
  const style = document.documentElement.style;
  if (box?.width) {
    style.setProperty("--sheath-left", `${box.left}px`);
    style.setProperty("--sheath-width", `${box.width}px`);
  }
  const sheet = [...document.querySelectorAll(".mantine-Paper-root")].find(
    (each) => each.style.position === "fixed" && each.style.bottom === "0px");
  if (sheet) {
    sheet.classList.add("sheath-sheet");
    if (!seen.has(sheet)) sizes.observe(sheet);
    seen.add(sheet);
    // Open, it has viser's own buttons beside that one.
    openerOf(sheet).setAttribute("aria-expanded", String(Boolean(sheet.querySelector(".sheath-opener ~ button"))));
  }
  document.body.classList.toggle("sheath-sheet-open", Boolean(sheet && sheet.clientHeight > 90));
}

function keepNamed() {
  const seen = new WeakSet();
  let waiting = 0;
  const soon = () => { waiting ||= setTimeout(all, namingMs); }, sizes = new ResizeObserver(soon);
  function all() { waiting = 0; nameElements(); layOut(seen, sizes); }
  const watching = new MutationObserver(soon);
  watching.observe(document.body, { childList: true, subtree: true });
  window.addEventListener("resize", soon);
  all();
  return () => { watching.disconnect(); sizes.disconnect(); clearTimeout(waiting); window.removeEventListener("resize", soon); };
}
