"use strict";
(function () {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const data = read("numbers"), crops = read("crops");
  const detail = document.getElementById("detail");
  let now = -1;

  function element(name, text, className) {
    const e = document.createElement(name);
    if (text !== undefined) e.textContent = text;
    if (className) e.className = className;
    return e;
  }
  const digits = (v, n) => (v === null || v === undefined ? "-" : v.toFixed(n));

  function numbers(s) {
    const table = element("table"), head = element("tr");
    for (const h of ["scene", "ms", "dB", "edges", "FLIP", "SSIM"]) head.append(element("th", h));
    table.append(head);
    for (const c of s.scenes) {
      const row = element("tr"), edges = c.silhouettes;
      for (const v of [c.scene, digits(c.ms.median, 2), digits(c.whole.psnr_db, 2), digits(edges && edges.psnr_db, 2),
                       digits(c.whole.flip, 4), digits(c.whole.ssim, 4)])
        row.append(element("td", v));
      table.append(row);
    }
    return table;
  }

  // Milliseconds of each pass, mean over the scenes; what belongs to no pass is waiting.
  function bars(s) {
    const box = element("div", undefined, "bars"), rows = [];
    let rest = s.ms.median;
    s.scenes[0].passes.forEach((pass, k) => {
      const ms = s.scenes.reduce((sum, c) => sum + c.passes[k].ms, 0) / s.scenes.length;
      rows.push([pass.name, ms]);
      rest -= ms;
    });
    rows.push(["rest", Math.max(0, rest)]);
    const most = Math.max(...rows.map((r) => r[1]), 1e-9);
    for (const [name, ms] of rows) {
      const bar = element("i");
      bar.style.width = (100 * ms / most).toFixed(1) + "%";
      const track = element("span");
      track.append(bar);
      box.append(element("span", name), track, element("b", ms.toFixed(2)));
    }
    return box;
  }

  function picture(uri, caption) {
    const f = element("figure"), img = element("img");
    img.src = uri;
    img.alt = caption;
    f.append(img, element("figcaption", caption));
    return f;
  }

  function pictures(i) {
    const box = element("div", undefined, "crops");
    data.settings[i].scenes.forEach((c, k) => {
      box.append(picture(crops.settings[i][k], c.scene + ", this setting"), picture(crops.truth[k], "ray-traced"));
    });
    return box;
  }

  const ranks = { front: "On the front.", tied: "Perhaps on the front: the times overlap.", beaten: "Another setting is faster and no worse." };

  function show(i) {
    if (i === now) return;
    now = i;
    const s = data.settings[i];
    detail.replaceChildren(
      element("h3", s.name),
      element("p", digits(s.ms.median, 2) + " ms (" + digits(s.ms.low, 2) + " to " + digits(s.ms.high, 2) + "), " +
              digits(-20 * Math.log10(s.error), 2) + " dB. " + ranks[s.rank], "soft"),
      element("pre", "hyperfocal IN.exr -o OUT.exr " + s.options),
      element("pre", 'hyperfocal-bench tradeoff --setting="' + s.options + '"'),
      numbers(s), bars(s));
    if (crops.settings.length) detail.append(pictures(i));
    for (const e of document.querySelectorAll("[data-i]")) e.classList.toggle("now", +e.dataset.i === i);
  }

  function index(event) {
    const e = event.target.closest && event.target.closest("[data-i]");
    return e ? +e.dataset.i : -1;
  }
  for (const kind of ["pointerover", "focusin", "click"])
    document.addEventListener(kind, (event) => {
      const i = index(event);
      if (i >= 0 && (kind !== "pointerover" || event.target.closest("svg"))) show(i);
    });
  document.addEventListener("keydown", (event) => {
    const all = [...document.querySelectorAll(".view.shown svg .pt[tabindex='0']")].filter((e) => e.getClientRects().length);
    const at = all.indexOf(document.activeElement), step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (at >= 0 && step && all[at + step]) {
      all[at + step].focus();
      event.preventDefault();
    }
  });

  for (const button of document.querySelectorAll(".tabs button"))
    button.addEventListener("click", () => {
      for (const b of document.querySelectorAll(".tabs button")) b.setAttribute("aria-pressed", b === button);
      for (const v of document.querySelectorAll(".view")) v.classList.toggle("shown", v.id === "view-" + button.dataset.view);
    });
  const last = data.settings.reduce((best, s, i) => (s.step > (best < 0 ? 0 : data.settings[best].step) ? i : best), -1);
  show(Math.max(last, 0));
})();
