// node least_psnr.mjs A.y4m B.y4m DECIBEL: the least PSNR of a frame of luma; fails where it is not above DECIBEL or the
// clips are not of the same size and length.
import fs from 'node:fs';

function clip(path) {
  const bytes = fs.readFileSync(path);
  const end = bytes.indexOf(10);
  const header = bytes.toString('latin1', 0, end);
  const [, width, height] = header.match(/ W(\d+) H(\d+)/).map(Number);
  const frameBytes = width * height + 2 * ((width + 1) >> 1) * ((height + 1) >> 1);
  const frames = [];
  for (let at = end + 1; at < bytes.length;) {
    at = bytes.indexOf(10, at) + 1;  // after FRAME and its parameters
    frames.push(bytes.subarray(at, at + width * height));
    at += frameBytes;
  }
  return {width, height, frames};
}

const [a, b] = process.argv.slice(2, 4).map(clip);
if (a.width !== b.width || a.height !== b.height || a.frames.length !== b.frames.length || a.frames.length === 0) {
  console.log(`${a.frames.length} frames of ${a.width}x${a.height}, ${b.frames.length} of ${b.width}x${b.height}`);
  process.exit(1);
}
let least = Infinity;
a.frames.forEach((frame, i) => {
  let sum = 0;
  for (let k = 0; k < frame.length; ++k) sum += (frame[k] - b.frames[i][k]) ** 2;
  least = Math.min(least, sum === 0 ? Infinity : 10 * Math.log10(255 * 255 * frame.length / sum));
});
console.log(`${least.toFixed(1)} dB at least`);
process.exit(least > Number(process.argv[4]) ? 0 : 1);
