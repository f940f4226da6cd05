// The page's script: the wipe between two pictures, its zoom, and the tips of the plots. The page reads without it.
#pragma once

namespace pac::sim {

inline constexpr char kReportScript[] = R"js(
(() => {
  'use strict';
  document.documentElement.classList.add('script');
  const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

  function setUpWipe(root) {
    const stage = root.querySelector('.stage'), handle = root.querySelector('.handle');
    const side = name => ({
      image: stage.querySelector('.layer.' + name + ' img'), tag: stage.querySelector('.tag.' + name),
      select: root.querySelector('select.' + name), numbers: root.querySelector('.numbers.' + name),
    });
    const sides = { left: side('left'), right: side('right') };
    const panel = root.querySelector('.panel');  // the wipe at the head of the page has none
    const zooms = [...root.querySelectorAll('button[data-zoom]')], blink = root.querySelector('button.blink');
    const view = { cut: 50, zoom: 1, x: 0.5, y: 0.5 };  // cut in %, zoom about the point (x, y) of the picture
    let blinking = 0;

    function draw() {
      stage.style.setProperty('--cut', view.cut + '%');
      handle.setAttribute('aria-valuenow', Math.round(view.cut));
      const edge = 0.5 / view.zoom;
      view.x = clamp(view.x, edge, 1 - edge);
      view.y = clamp(view.y, edge, 1 - edge);
      const move = at => (50 - 100 * view.zoom * at) + '%';
      const enlarged = stage.clientWidth * view.zoom / Number(root.dataset.width);
      for (const { image } of Object.values(sides)) {
        image.style.transform = `translate(${move(view.x)}, ${move(view.y)}) scale(${view.zoom})`;
        image.classList.toggle('sharp', enlarged > 1.4);
      }
      stage.classList.toggle('zoomed', view.zoom > 1);
      for (const button of zooms) button.setAttribute('aria-pressed', Number(button.dataset.zoom) === view.zoom);
    }
    function setCut(cut) { stopBlinking(); view.cut = clamp(cut, 0, 100); draw(); }
    function setZoom(zoom, x = view.x, y = view.y) { Object.assign(view, { zoom, x, y }); draw(); }
    function show(name) {
      const { image, tag, select, numbers } = sides[name], option = select.selectedOptions[0];
      image.src = option.dataset.file;
      image.alt = option.dataset.alt;
      tag.textContent = option.textContent;
      numbers.textContent = option.dataset.details;
    }
    function stopBlinking() {
      if (!blinking) return;
      clearInterval(blinking);
      blinking = 0;
      blink.setAttribute('aria-pressed', false);
      view.cut = 50;
      draw();
    }

    const place = event => {
      const box = stage.getBoundingClientRect();
      return { x: (event.clientX - box.left) / box.width, y: (event.clientY - box.top) / box.height };
    };
    let drag = null;
    stage.addEventListener('pointerdown', event => {
      if (event.button !== 0) return;
      const at = place(event);
      const pan = view.zoom > 1 && event.target !== handle;
      drag = { pan, at, x: view.x, y: view.y };
      stage.setPointerCapture(event.pointerId);
      stage.classList.toggle('panning', pan);
      handle.focus({ preventScroll: true });
      if (!pan) setCut(100 * at.x);
      event.preventDefault();
    });
    stage.addEventListener('pointermove', event => {
      if (!drag) return;
      const at = place(event);
      if (drag.pan) setZoom(view.zoom, drag.x - (at.x - drag.at.x) / view.zoom, drag.y - (at.y - drag.at.y) / view.zoom);
      else setCut(100 * at.x);
    });
    for (const end of ['pointerup', 'pointercancel'])
      stage.addEventListener(end, () => { drag = null; stage.classList.remove('panning'); });
    stage.addEventListener('dblclick', event => {
      const at = place(event);
      const next = view.zoom >= 8 ? 1 : view.zoom * 2;
      setZoom(next, view.x + (at.x - 0.5) / view.zoom, view.y + (at.y - 0.5) / view.zoom);
    });
    handle.addEventListener('keydown', event => {
      const step = event.shiftKey ? 10 : 1, pan = 0.1 / view.zoom;
      const keys = event.altKey ? {
        ArrowLeft: () => setZoom(view.zoom, view.x - pan), ArrowRight: () => setZoom(view.zoom, view.x + pan),
        ArrowUp: () => setZoom(view.zoom, view.x, view.y - pan), ArrowDown: () => setZoom(view.zoom, view.x, view.y + pan),
      } : {
        ArrowLeft: () => setCut(view.cut - step), ArrowRight: () => setCut(view.cut + step),
        ArrowDown: () => setCut(view.cut - step), ArrowUp: () => setCut(view.cut + step),
        Home: () => setCut(0), End: () => setCut(100),
        '+': () => setZoom(Math.min(8, view.zoom * 2)), '=': () => setZoom(Math.min(8, view.zoom * 2)),
        '-': () => setZoom(Math.max(1, view.zoom / 2)),
      };
      if (!keys[event.key]) return;
      keys[event.key]();
      event.preventDefault();
    });
    for (const button of zooms) button.addEventListener('click', () => setZoom(Number(button.dataset.zoom)));
    if (panel) blink.addEventListener('click', () => {
      if (blinking) return stopBlinking();
      blink.setAttribute('aria-pressed', true);
      view.cut = 100;
      draw();
      blinking = setInterval(() => { view.cut = view.cut > 50 ? 0 : 100; draw(); }, 700);
    });
    if (panel) for (const name of ['left', 'right']) sides[name].select.addEventListener('change', () => show(name));
    root.choose = (name, id) => {
      sides[name].select.value = id;
      show(name);
      root.scrollIntoView({ block: 'nearest' });
    };
    new ResizeObserver(draw).observe(stage);
    draw();
  }

  document.querySelectorAll('.wipe').forEach(setUpWipe);
  document.addEventListener('click', event => {
    const button = event.target.closest('.to-wipe button');
    if (button) document.getElementById(button.dataset.wipe).choose(button.dataset.side, button.dataset.id);
  });

  const tip = document.createElement('div');
  tip.id = 'tip';
  tip.hidden = true;
  document.body.append(tip);
  document.addEventListener('pointerover', event => {
    const point = event.target.closest && event.target.closest('.point');
    tip.hidden = !point;
    if (!point) return;
    const title = point.querySelector('title');
    if (title) { point.dataset.tip = title.textContent; title.remove(); }  // no second, native tip
    tip.textContent = point.dataset.tip;
    const box = point.getBoundingClientRect();
    tip.style.left = Math.min(box.right + 10, innerWidth - tip.offsetWidth - 8) + 'px';
    tip.style.top = Math.max(8, box.top - tip.offsetHeight - 4) + 'px';
  });
})();
)js";

}  // namespace pac::sim
