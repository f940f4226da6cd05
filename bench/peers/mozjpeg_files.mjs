// Files of mozjpeg for jpeg_bytes: NAME.SETTING.QUALITY.jpg beside each NAME.ppm.
//   npm install @jsquash/jpeg && node mozjpeg_files.mjs NAME.ppm ...      (from the folder that has node_modules)
// Baseline, 4:2:0, trellis on. Of what the package exposes (not the lambdas that -tune-psnr and -tune-ssim also set):
//   moz-default   its default table (3)
//   moz-flat      table 1, flat, which -tune-psnr and -tune-ssim use
//   moz-flat-all  the same with every option of the trellis: more loops and passes, tables and zero blocks optimized
//   moz-ms-ssim   table 2, tuned for MS-SSIM
//   moz-psnr-hvs  table 4, tuned for PSNR-HVS-M
//   node mozjpeg_files.mjs --quality Q NAME.ppm OUT.jpg
// writes one file as the package does by default: progressive.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import {pathToFileURL} from 'node:url';

const require = createRequire(process.cwd() + '/');
const {default: encode, init} = await import(pathToFileURL(require.resolve('@jsquash/jpeg/encode.js')));
const wasm = require.resolve('@jsquash/jpeg/codec/enc/mozjpeg_enc.wasm');
await init(await WebAssembly.compile(fs.readFileSync(wasm)));

// P6 with 8-bit samples and no comment.
function readPpm(path) {
  const bytes = fs.readFileSync(path);
  let at = 0;
  const word = () => {
    const begin = at;
    while (bytes[at] > 32) ++at;
    return bytes.toString('latin1', begin, at++);
  };
  word();
  const width = Number(word()), height = Number(word());
  word();
  const data = new Uint8ClampedArray(4 * width * height).fill(255);
  for (let i = 0; i < width * height; ++i)
    for (let c = 0; c < 3; ++c) data[4 * i + c] = bytes[at + 3 * i + c];
  return {data, width, height};
}

if (process.argv[2] === '--quality') {
  const [quality, source, out] = process.argv.slice(3);
  const file = await encode(readPpm(source), {quality: Number(quality), progressive: true, chroma_subsample: 2});
  fs.writeFileSync(out, Buffer.from(file));
  process.exit();
}
for (const path of process.argv.slice(2)) {
  const image = readPpm(path);
  for (const [name, quant_table, all] of [['moz-default', 3, false], ['moz-flat', 1, false], ['moz-flat-all', 1, true],
                                          ['moz-ms-ssim', 2, false], ['moz-psnr-hvs', 4, false]]) {
    for (const quality of [15, 30, 45, 60, 75, 84, 90]) {
      const file = await encode(image, {
        quality, quant_table, baseline: true, progressive: false, arithmetic: false, optimize_coding: true, smoothing: 0,
        color_space: 3, trellis_multipass: all, trellis_opt_zero: all, trellis_opt_table: all, trellis_loops: all ? 4 : 1,
        auto_subsample: false, chroma_subsample: 2, separate_chroma_quality: false, chroma_quality: quality,
      });
      fs.writeFileSync(path.replace(/\.ppm$/, `.${name}.${quality}.jpg`), Buffer.from(file));
    }
  }
}
