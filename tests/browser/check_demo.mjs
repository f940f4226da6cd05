// The demo's page in headless Chromium: it loads without errors and without network, every picture decodes, the wipe
// moves, enlarges and changes its pictures; and Chromium decodes our JPEG files as `pac jpeg decode` does.
// Usage: node check_demo.mjs CHROMIUM OUTDIR JPEGDIR   (JPEGDIR: x.jpg, each with x.ppm beside it)
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser } from './devtools.mjs';

const [, , chromium, outDir, jpegDir] = process.argv;
const browser = await Browser.start(chromium);
const problems = [];
browser.onEvent(({ method, params }) => {
  if (method === 'Runtime.exceptionThrown') problems.push(params.exceptionDetails.text);
  if (method === 'Runtime.consoleAPICalled' && params.type === 'error') problems.push('console.error');
  if (method === 'Log.entryAdded' && params.entry.level === 'error') problems.push(params.entry.text);
  if (method === 'Network.loadingFailed') problems.push(params.errorText);
  if (method === 'Network.requestWillBeSent' && !/^(file|data|about):/.test(params.request.url))
    problems.push(`request to ${params.request.url}`);
});

let n_checks = 0;
async function check(claim, run) {
  await run();
  ++n_checks;
  console.log(`ok  ${claim}`);
}

// Expressions for the page.
const wipe = '[...document.querySelectorAll(".wipe")].find(w => w.querySelector(".panel"))';
const cut = `parseFloat(getComputedStyle(${wipe}.querySelector('.stage')).getPropertyValue('--cut'))`;
const clip = `getComputedStyle(${wipe}.querySelector('.layer.left')).clipPath`;
const image = side => `${wipe}.querySelector('.layer.${side} img')`;

async function checkAnimations() {
  await check('the animations page loads', () => browser.open(pathToFileURL(resolve(outDir, 'animations.html')).href));
  await check('every film decodes, and is as tall as its frames', async () => {
    const wrong = await browser.evaluate(`Promise.all([...document.querySelectorAll('.film img')].map(film =>
      film.decode().then(() => film.naturalHeight === 16 * film.naturalWidth ? '' : film.src, () => film.src))).then(all => all.filter(Boolean))`);
    assert.deepEqual(wrong, []);
    assert.equal(await browser.evaluate('document.querySelectorAll(".film img").length'), 12);
  });
  await check('the films play by whole frames', async () => {
    const film = 'document.querySelector(".film img")';
    const place = ms => browser.evaluate(`(() => { const [a] = ${film}.getAnimations(); a.pause(); a.currentTime = ${ms};
      return new DOMMatrix(getComputedStyle(${film}).transform).m42 / ${film}.parentElement.getBoundingClientRect().height; })()`);
    for (const [ms, frames] of [[0, 0], [60, -1], [799, -15]]) assert.ok(Math.abs(await place(ms) - frames) < 0.1, `${await place(ms)} at ${ms} ms`);
  });
  await check('every file that the page links to is there', async () => {
    for (const file of await browser.evaluate('[...document.querySelectorAll("a[href]")].map(a => a.getAttribute("href"))'))
      if (!file.startsWith('#')) assert.ok(readFileSync(join(outDir, file)).length > 100, file);
  });
}

async function stageBox() {
  return browser.evaluate(`(() => {
    const stage = ${wipe}.querySelector('.stage');
    stage.scrollIntoView({ block: 'center', behavior: 'instant' });
    const { x, y, width, height } = stage.getBoundingClientRect();
    return { x, y, width, height };
  })()`);
}

async function checkPage() {
  await check('the page loads', () => browser.open(pathToFileURL(resolve(outDir, 'index.html')).href));
  await check('every picture decodes', async () => {
    const broken = await browser.evaluate(`Promise.all([...document.images].map(image =>
      image.decode().then(() => image.naturalWidth > 0 ? '' : image.src, () => image.src))).then(all => all.filter(Boolean))`);
    assert.deepEqual(broken, []);
    assert.ok(await browser.evaluate('document.images.length') > 20);
  });
  await check('every picture that a wipe offers decodes', async () => {
    const broken = await browser.evaluate(`Promise.all([...new Set([...document.querySelectorAll('option')]
      .map(option => option.dataset.file))].map(file => { const image = new Image(); image.src = file;
      return image.decode().then(() => '', () => file); })).then(all => all.filter(Boolean))`);
    assert.deepEqual(broken, []);
  });
  await check('Table I, its files and the plots are there', async () => {
    assert.ok(await browser.evaluate('document.querySelectorAll("#table-1 tbody tr").length') > 20);
    assert.ok(await browser.evaluate('document.querySelectorAll("svg.plot .point").length') > 20);
    const table = JSON.parse(readFileSync(join(outDir, 'table1.json'), 'utf8'));
    assert.ok(table.columns.length === 2);
    assert.ok(readFileSync(join(outDir, 'table1.csv'), 'utf8').split('\n').length > 20);
  });
}

async function checkWipe() {
  await check('the wipe moves when dragged', async () => {
    const box = await stageBox();
    const y = box.y + box.height / 2;
    const before = await browser.screenshot(box);
    assert.equal(await browser.evaluate(cut), 50);
    await browser.drag({ x: box.x + box.width / 2, y }, { x: box.x + box.width / 4, y });
    assert.ok(Math.abs(await browser.evaluate(cut) - 25) < 1);
    assert.match(await browser.evaluate(clip), /inset\(0(px)? calc\(75|inset\(0px 7[45]/);
    assert.ok(await browser.screenshot(box) !== before, 'the picture did not change');
  });
  await check('the wipe moves by keyboard', async () => {
    const start = await browser.evaluate(cut);
    await browser.evaluate(`${wipe}.querySelector('.handle').focus()`);
    for (let i = 0; i < 3; ++i) await browser.press('ArrowRight');
    assert.ok(Math.abs(await browser.evaluate(cut) - start - 3) < 0.01);
    await browser.press('End');
    assert.equal(await browser.evaluate(`${wipe}.querySelector('.handle').getAttribute('aria-valuenow')`), '100');
    await browser.press('Home');
    assert.equal(await browser.evaluate(cut), 0);
  });
  await check('enlarging shows sharp pixels, and dragging then moves the picture', async () => {
    await browser.evaluate(`${wipe}.querySelector('[data-zoom="4"]').click()`);
    assert.equal(await browser.evaluate(`getComputedStyle(${image('left')}).imageRendering`), 'pixelated');
    const place = () => browser.evaluate(`${image('right')}.style.transform`);
    const box = await stageBox(), before = await place();
    await browser.drag({ x: box.x + box.width * 0.7, y: box.y + 50 }, { x: box.x + box.width * 0.5, y: box.y + 90 });
    assert.notEqual(await place(), before);
    assert.equal(await browser.evaluate(cut), 0);
    await browser.evaluate(`${wipe}.querySelector('[data-zoom="1"]').click()`);
  });
  await check('any two pictures of a figure can be compared', async () => {
    const chosen = await browser.evaluate(`(() => {
      const select = ${wipe}.querySelector('select.left');
      select.selectedIndex = 0;
      select.dispatchEvent(new Event('change'));
      return [${image('left')}.getAttribute('src'), select.selectedOptions[0].dataset.file];
    })()`);
    assert.equal(chosen[0], chosen[1]);
    const right = await browser.evaluate(`(() => {
      const button = document.querySelector('.to-wipe button[data-side="right"]');
      button.click();
      return [${image('right')}.getAttribute('src'), button.dataset.id + '.png'];
    })()`);
    assert.equal(right[0], right[1]);
  });
}

async function checkLayouts() {
  await check('nothing sticks out on a telephone, light or dark', async () => {
    for (const scheme of ['light', 'dark']) {
      await browser.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: scheme }] });
      await browser.send('Emulation.setDeviceMetricsOverride', { width: 375, height: 800, deviceScaleFactor: 1, mobile: true });
      assert.ok(await browser.evaluate('document.documentElement.scrollWidth') <= 375);
    }
  });
}

// Pixels of a binary PPM file with 255 as its maximum.
function readPpm(path) {
  const bytes = readFileSync(path);
  const [header, width, height] = /^P6\s(\d+)\s(\d+)\s255\s/.exec(bytes.subarray(0, 64).toString('latin1'));
  return { width: Number(width), height: Number(height), samples: bytes.subarray(header.length) };
}

async function chromiumPixels(path) {
  const data = readFileSync(path).toString('base64');
  const pixels = await browser.evaluate(`(async () => {
    const image = new Image();
    image.src = 'data:image/jpeg;base64,${data}';
    await image.decode();
    const canvas = document.createElement('canvas');
    canvas.width = image.naturalWidth;
    canvas.height = image.naturalHeight;
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    let text = '';
    for (let i = 0; i < data.length; i += 0x8000) text += String.fromCharCode(...data.subarray(i, i + 0x8000));
    return { width: canvas.width, height: canvas.height, rgba: btoa(text) };
  })()`);
  return { ...pixels, rgba: Buffer.from(pixels.rgba, 'base64') };
}

async function checkJpegs() {
  const files = readdirSync(jpegDir).filter(name => name.endsWith('.jpg'));
  assert.ok(files.length >= 6);
  for (const file of files) {
    await check(`Chromium decodes ${file} as we do`, async () => {
      const ours = readPpm(join(jpegDir, file.replace('.jpg', '.ppm'))), theirs = await chromiumPixels(join(jpegDir, file));
      assert.deepEqual([theirs.width, theirs.height], [ours.width, ours.height]);
      let sum = 0, most = 0;
      for (let i = 0; i < ours.width * ours.height; ++i)
        for (let c = 0; c < 3; ++c) {
          const difference = Math.abs(ours.samples[3 * i + c] - theirs.rgba[4 * i + c]);
          sum += difference;
          most = Math.max(most, difference);
        }
      // Chromium's libjpeg-turbo may merge chroma upsampling with color conversion: a few levels at chroma edges.
      assert.ok(sum / (3 * ours.width * ours.height) < 1, `mean difference ${sum / (3 * ours.width * ours.height)}`);
      assert.ok(most <= 64, `largest difference ${most}`);
    });
  }
}

try {
  await checkPage();
  await checkWipe();
  await checkLayouts();
  await checkAnimations();
  await checkJpegs();
  await check('no error was logged and nothing was asked of the network', () => assert.deepEqual(problems, []));
  console.log(`${n_checks} checks passed`);
} finally {
  await browser.close();
}
