// Decodes MPEG-1 video with jsmpeg's own decoder (JavaScript, no WebAssembly), for mpeg1_jsmpeg.
//   npm install @cycjimmy/jsmpeg-player && node jsmpeg_decode.mjs IN.m1v OUT.y4m      (from the folder with node_modules)
// Prints pictures and milliseconds. Exit code 3: the package is missing.
import fs from 'node:fs';
import {createRequire} from 'node:module';

globalThis.window = globalThis;  // where the player looks for performance.now
const require = createRequire(process.cwd() + '/');
let player;
try {
  player = require('@cycjimmy/jsmpeg-player');
} catch {
  process.exit(3);
}

const [input, output] = process.argv.slice(2);
const bytes = fs.readFileSync(input);
const pieces = [];
let size = null;

function cropped(plane, stride, width, height) {
  const rows = Buffer.alloc(width * height);
  for (let y = 0; y < height; ++y) rows.set(plane.subarray(y * stride, y * stride + width), y * width);
  return rows;
}
const renderer = {
  resize(width, height) {
    size = {width, height, stride: (width + 15) >> 4 << 4};
    pieces.push(Buffer.from(`YUV4MPEG2 W${width} H${height} F30:1 Ip A1:1 C420jpeg\n`));
  },
  render(y, cr, cb) {
    const {width, height, stride} = size;
    pieces.push(Buffer.from('FRAME\n'), cropped(y, stride, width, height));
    for (const plane of [cb, cr]) pieces.push(cropped(plane, stride >> 1, (width + 1) >> 1, (height + 1) >> 1));
  },
};

// Grown by itself its buffer may be too small; each call of decode() looks at one start code only.
const decoder = new player.Decoder.MPEG1Video({videoBufferSize: bytes.length + 64, decodeFirstFrame: false});
decoder.connect(renderer);
const start = process.cpuUsage();
decoder.write(0, bytes);
while (decoder.bits.has(32)) decoder.decode();
const used = process.cpuUsage(start);
fs.writeFileSync(output, Buffer.concat(pieces));
console.log(decoder.currentFrame, (used.user + used.system) / 1000);
