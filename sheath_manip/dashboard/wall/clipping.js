// Asks for a stretch around a moment, has the server make a film of it, and gives that to the browser.
const aroundS = 3, askAgainMs = 400;

function makeClipping(get) {
  const dialog = document.createElement("dialog"), form = document.createElement("form");
  dialog.id = "sheath-clip";
  dialog.setAttribute("aria-labelledby", "sheath-clip-title");
  const title = document.createElement("h2"), says = document.createElement("p"), fields = {};
  title.id = "sheath-clip-title";
  title.textContent = "Clip";
  says.setAttribute("role", "status");
  form.append(title);
  for (const [name, words] of [["first", "from step"], ["last", "to step"]]) {
    const label = document.createElement("label");
    fields[name] = Object.assign(document.createElement("input"), { type: "number", min: 1, step: 1, required: true });
    label.append(words, fields[name]);
    form.append(label);
  }
  const row = document.createElement("p");
  for (const kind of ["mp4", "gif"])
    row.append(Object.assign(document.createElement("button"), { textContent: kind, value: kind }));
  row.append(Object.assign(document.createElement("button"), {
    textContent: "Cancel (Esc)", type: "button", onclick: () => dialog.close() }));
  form.append(row, says);
  dialog.append(form);
  document.body.append(dialog);
  let place = 0;

  form.onsubmit = async (event) => {
    event.preventDefault();
    const [first, last] = [fields.first, fields.last].map((each) => Number(each.value));
    if (last < first) { says.textContent = `to step ${last} is before from step ${first}`; return; }
    if (last - first >= settings.longestClip) {
      says.textContent = `${last - first + 1} steps; at most ${settings.longestClip}: the tab Marks exports whole episodes`;
      return;
    }
    const kind = event.submitter?.value ?? "mp4", began = performance.now();
    for (let answer; dialog.open; await new Promise((done) => setTimeout(done, askAgainMs))) {
      says.textContent = `making the ${kind} … ${Math.round((performance.now() - began) / 1000)} s`;
      answer = await get(`clip/${place}/${first - 1}/${last}/${kind}`).catch(() => null);
      if (!answer) { says.textContent = "no connection; try again"; return; }
      if (answer.status === 202) continue;
      if (!answer.ok) { says.textContent = await answer.text(); return; }
      const name = answer.headers.get("Content-Disposition").match(/filename="(.*)"/)[1];
      const url = URL.createObjectURL(await answer.blob());
      Object.assign(document.createElement("a"), { href: url, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(url), 10000);
      says.textContent = name;
      return;
    }
  };
  return {
    ask(moment) {
      const around = Math.round(aroundS * moment.rateHz);
      place = moment.place;
      title.textContent = `Clip around step ${moment.step + 1} of ${moment.steps}`;
      for (const field of Object.values(fields)) field.max = moment.steps;
      fields.first.value = Math.max(0, moment.step - around) + 1;
      fields.last.value = Math.min(moment.steps, moment.step + around + 1);
      says.textContent = "";
      if (!dialog.open) dialog.showModal();
      row.firstChild.focus();
    },
    remove() { dialog.remove(); },
  };
}
