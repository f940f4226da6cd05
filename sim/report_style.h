// The page's style sheet: light, dark and print from one set of variables.
#pragma once

namespace pac::sim {

inline constexpr char kReportStyle[] = R"css(
:root {
  --paper: #fdfcf8; --raised: #ffffff; --ink: #1c1b19; --soft: #5d5a54; --rule: #dcd8ce; --faint: #eeebe3;
  --image: #b3560b; --polygon: #1a5fb0; --model: #6a4c93; --good: #2a6f3c; --bad: #a8201a; --neutral: #6b6454; --teal: #0f7a80;
  --serif: "Iowan Old Style", "Palatino Linotype", Palatino, "URW Palladio L", P052, "Book Antiqua", Georgia, serif;
  --sans: system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", "Liberation Sans", Arial, sans-serif;
  --measure: 42rem;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #151617; --raised: #1d1f21; --ink: #e8e4db; --soft: #a8a399; --rule: #3a3b3d; --faint: #26282a;
    --image: #f0a35c; --polygon: #7fb6f2; --model: #c3a6e8; --good: #7fc78f; --bad: #f08a80; --neutral: #b9b1a0; --teal: #62c4c9;
  }
}
* { box-sizing: border-box; }
html { scroll-behavior: smooth; scroll-padding-top: 4rem; -webkit-text-size-adjust: 100%; }
@media (prefers-reduced-motion: reduce) { html { scroll-behavior: auto; } }
body { margin: 0; background: var(--paper); color: var(--ink); font: 1.0625rem/1.6 var(--serif);
  font-variant-numeric: oldstyle-nums; text-rendering: optimizeLegibility; }
.wrap { max-width: 76rem; margin: 0 auto; padding: 0 clamp(1rem, 4vw, 2.5rem); }
p, ul.plain, ol.plain { max-width: var(--measure); }
p { margin: 0 0 1em; hyphens: auto; }
a { color: var(--polygon); text-underline-offset: .15em; text-decoration-thickness: 1px; }
:focus-visible { outline: 3px solid var(--polygon); outline-offset: 2px; border-radius: 2px; }
h1, h2, h3 { font-weight: 600; line-height: 1.15; text-wrap: balance; }
h2 { font-size: 1.85rem; margin: 0 0 .7rem; }
h2 .number { display: block; font: 600 .82rem/1.4 var(--sans); letter-spacing: .09em; text-transform: uppercase;
  color: var(--soft); margin-bottom: .35rem; }
h3 { font-size: 1.2rem; margin: 2.2rem 0 .8rem; }
section { padding: 3.6rem 0 1.2rem; border-top: 1px solid var(--rule); margin-top: 3rem; }
main > section:first-child { border-top: 0; margin-top: 0; }
code, pre { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; font-size: .86em; }
pre { background: var(--faint); padding: .9rem 1.1rem; border-radius: 6px; overflow-x: auto; line-height: 1.5; }
.skip { position: absolute; left: -99rem; }
.skip:focus { left: 1rem; top: 1rem; background: var(--raised); padding: .5rem 1rem; z-index: 9; }

/* head */
.masthead { padding: 4.5rem 0 0; }
.kicker { font: 600 .82rem/1.4 var(--sans); letter-spacing: .09em; text-transform: uppercase; color: var(--soft); margin: 0 0 1rem; }
h1 { font-size: clamp(2.1rem, 5.2vw, 3.5rem); letter-spacing: -.012em; margin: 0 0 1.1rem; max-width: 20em; }
.lede { font-size: 1.22rem; line-height: 1.55; max-width: 46rem; }
.masthead .wrap { display: grid; gap: 0 3rem; grid-template-columns: minmax(0, 1fr); }
@media (min-width: 64rem) { .masthead .wrap:has(.compact) { grid-template-columns: minmax(0, 1fr) minmax(0, 26rem); } .highlights { grid-column: 1 / -1; } }
.masthead .words { align-self: center; }
.highlights { display: grid; grid-template-columns: repeat(auto-fit, minmax(12.5rem, 1fr)); gap: 1.6rem 2rem; margin: 2.4rem 0 0; }
.highlights div { border-top: 3px solid var(--polygon); padding-top: .7rem; }
.highlights dt { font-size: 2.2rem; line-height: 1.1; font-variant-numeric: lining-nums; margin-bottom: .3rem; }
.highlights dd { margin: 0; font: .9rem/1.45 var(--sans); color: var(--soft); }
nav.contents { position: sticky; top: 0; z-index: 5; background: var(--paper); border-bottom: 1px solid var(--rule);
  margin-top: 2.6rem; font: .88rem/1.4 var(--sans); }
nav.contents .wrap { display: flex; gap: 1.3rem; overflow-x: auto; white-space: nowrap; scrollbar-width: none; }
nav.contents a { padding: .8rem 0; color: var(--soft); text-decoration: none; }
nav.contents a:hover { color: var(--ink); text-decoration: underline; }

/* Table I */
.scroll { overflow-x: auto; margin: 1.4rem 0; }
table { border-collapse: collapse; font: .9rem/1.4 var(--sans); font-variant-numeric: lining-nums tabular-nums; }
.table-one { width: 100%; min-width: 46rem; }
.table-one th, .table-one td { padding: .38rem .8rem; text-align: right; vertical-align: top; }
.table-one thead th { font-weight: 600; border-bottom: 1px solid var(--ink); }
.table-one thead tr:first-child th { border: 0; text-align: center; padding-bottom: 0; font: 600 1.02rem/1.4 var(--serif); text-transform: capitalize; }
.table-one th[scope=row], .table-one td.note, .table-one .letter { text-align: left; font-weight: 400; }
.table-one th[scope=row] { padding-left: 1.6rem; min-width: 15rem; }
.table-one tr.part th { text-align: left; font: 600 1rem/1.4 var(--serif); padding: 1.1rem .8rem .25rem 0; border-top: 1px solid var(--rule); }
.table-one tbody:first-of-type tr.part th { border-top: 0; }
.table-one td.ours { font-weight: 600; }
.gains thead tr:first-child th { text-transform: none; font: 600 .92rem/1.35 var(--sans); vertical-align: bottom; } .gains thead tr:first-child th.letter { text-align: left; }
.gains th[scope=row] { padding-left: .8rem; } .gains td { white-space: nowrap; } .gains .unit { font-weight: 400; } .gains td.note { white-space: normal; min-width: 8rem; }
.table-one td.paper { color: var(--soft); }
.table-one td.note { color: var(--soft); font-size: .82rem; min-width: 14rem; }
.table-one tbody tr:not(.part):hover { background: var(--faint); }
.unit { color: var(--soft); font-size: .92em; }

/* findings */
.findings { list-style: none; padding: 0; margin: 1.6rem 0; display: grid; gap: .9rem; max-width: 60rem; }
.findings li { display: grid; grid-template-columns: 9.5rem 1fr; gap: 0 1.2rem; border-top: 1px solid var(--rule); padding-top: .9rem; }
.findings .claim::first-letter { text-transform: uppercase; }
.findings .claim { margin: 0 0 .25rem; max-width: none; }
.findings .ours { margin: 0; color: var(--soft); font: .92rem/1.5 var(--sans); font-variant-numeric: lining-nums; max-width: none; }
.chip { font: 600 .78rem/1.3 var(--sans); padding: .2rem 0; display: flex; align-items: baseline; gap: .45rem; color: var(--neutral); }
.chip::before { content: "○"; }
.agrees > .chip { color: var(--good); } .agrees > .chip::before { content: "✓"; }
.differs > .chip::before { content: "≈"; }
.against > .chip { color: var(--bad); } .against > .chip::before { content: "✗"; }
@media (max-width: 40rem) { .findings li { grid-template-columns: 1fr; } }

/* pictures */
.row { margin: 1.8rem 0; }
.row > .label { font: 600 .88rem/1.4 var(--sans); margin: 0 0 .7rem; }
.grid { display: grid; gap: 1.4rem 1.1rem; grid-template-columns: repeat(var(--columns, 3), minmax(0, var(--widest, 100%))); }
@media screen and (max-width: 60rem) { .grid { grid-template-columns: repeat(min(2, var(--columns, 3)), minmax(0, var(--widest, 100%))); } }
.grid.crops { grid-template-columns: repeat(3, minmax(0, 576px)); }
@media (max-width: 40rem) { .grid { gap: 1rem .6rem; } .crops figcaption { font-size: .74rem; } }
figure { margin: 0; }
figure img, .stage img, .crop img { display: block; background: var(--faint); }
.picture img { width: 100%; height: auto; }
.film { display: block; overflow: hidden; aspect-ratio: var(--w) / var(--h); }
.film img { animation: film calc(1s * var(--frames) / var(--rate)) steps(var(--frames)) infinite; }
@keyframes film { to { transform: translateY(-100%); } }
@media (prefers-reduced-motion: reduce) { .film img { animation: none; } .film:hover img { animation: film calc(1s * var(--frames) / var(--rate)) steps(var(--frames)) infinite; } }
figcaption { font: .84rem/1.45 var(--sans); font-variant-numeric: lining-nums tabular-nums; margin-top: .45rem; }
figcaption b { font-weight: 600; } figcaption .numbers { color: var(--soft); display: block; }
.letter-tag { font-weight: 600; margin-right: .35em; }
.arm-image figcaption b { color: var(--image); } .arm-polygon figcaption b { color: var(--polygon); }
.to-wipe { display: none; gap: .35rem; margin-top: .35rem; }
.script .to-wipe { display: flex; }
button, select { font: .82rem/1.3 var(--sans); color: var(--ink); background: var(--raised); border: 1px solid var(--rule);
  border-radius: 5px; padding: .3rem .6rem; }
button { cursor: pointer; } button:hover, select:hover { border-color: var(--soft); }
button[aria-pressed=true] { background: var(--ink); color: var(--paper); border-color: var(--ink); }
.to-wipe button { font-size: .74rem; padding: .12rem .5rem; color: var(--soft); }

/* the wipe */
.wipe { display: none; grid-template-columns: minmax(0, calc(var(--w) * 1px)) minmax(15rem, 1fr); gap: 1.2rem 2rem; margin: 2rem 0 2.6rem; }
.script .wipe { display: grid; }
@media (max-width: 56rem) { .wipe { grid-template-columns: minmax(0, calc(var(--w) * 1px)); } }
.script .wipe.compact { display: block; margin: 0; max-width: calc(var(--w) * 1px); }
@media (max-width: 63.99rem) { .script .wipe.compact { margin-top: 1.5rem; } }
.stage { position: relative; aspect-ratio: var(--w) / var(--h); overflow: hidden; touch-action: pan-y; user-select: none;
  cursor: ew-resize; --cut: 50%; align-self: start; }
.stage.zoomed { cursor: grab; touch-action: none; } .stage.panning { cursor: grabbing; }
.stage .layer { position: absolute; inset: 0; overflow: hidden; }
.stage .layer.left { clip-path: inset(0 calc(100% - var(--cut)) 0 0); }
.stage img { width: 100%; height: 100%; transform-origin: 0 0; pointer-events: none; }
.stage img.sharp { image-rendering: pixelated; }
.handle { position: absolute; top: 0; bottom: 0; left: var(--cut); width: 44px; margin-left: -22px; cursor: ew-resize; touch-action: none; }
.handle::before { content: ""; position: absolute; left: 21px; top: 0; bottom: 0; width: 2px; background: #fff; box-shadow: 0 0 0 1px rgba(0,0,0,.45); }
.handle::after { content: "◂ ▸"; position: absolute; left: 3px; top: calc(50% - 19px); width: 38px; height: 38px; border-radius: 50%;
  background: #fff; color: #222; box-shadow: 0 0 0 1px rgba(0,0,0,.45), 0 2px 8px rgba(0,0,0,.3); font: 14px/37px var(--sans); text-align: center; }
.handle:focus-visible { outline: none; } .handle:focus-visible::after { box-shadow: 0 0 0 3px var(--polygon), 0 0 0 5px #fff; }
.tag { position: absolute; bottom: .5rem; padding: .1rem .5rem; font: 600 .76rem/1.5 var(--sans); background: rgba(0,0,0,.62); color: #fff;
  border-radius: 3px; pointer-events: none; max-width: 48%; }
.tag.left { left: .5rem; } .tag.right { right: .5rem; }
.panel { font: .9rem/1.5 var(--sans); font-variant-numeric: lining-nums tabular-nums; align-self: start; }
.panel .side { margin: 0 0 1.1rem; } .panel label { display: block; color: var(--soft); font-size: .82rem; margin-bottom: .25rem; }
.panel select { width: 100%; max-width: 26rem; padding: .42rem .5rem; font-size: .88rem; }
.panel .numbers { margin: .4rem 0 0; color: var(--soft); white-space: pre-line; max-width: none; hyphens: none; }
.tools { display: flex; flex-wrap: wrap; gap: .4rem; align-items: center; margin: 0 0 .8rem; }
.tools span { color: var(--soft); font-size: .82rem; margin-right: .2rem; }
.hint { color: var(--soft); font-size: .8rem; max-width: 26rem; hyphens: none; }
kbd { font: .92em/1 ui-monospace, Menlo, Consolas, monospace; border: 1px solid var(--rule); border-radius: 3px; padding: 0 .25em; }

/* enlargements */
.crop { position: relative; overflow: hidden; }
.crop img { position: absolute; max-width: none; image-rendering: pixelated; }

/* drawings */
svg { display: block; width: 100%; height: auto; font-family: var(--sans); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 27rem), 1fr)); gap: 2.2rem 2.5rem; margin: 1.8rem 0; }
.plots figure > p::first-letter { text-transform: uppercase; }
.plots figure > p { font: 600 .95rem/1.4 var(--sans); margin: 0 0 .2rem; }
.plot text { fill: var(--ink); font-size: 12px; font-variant-numeric: lining-nums tabular-nums; }
.plot .tick, .plot .note { fill: var(--soft); font-size: 11.5px; } .plot .middle { text-anchor: middle; } .plot .end { text-anchor: end; }
.plot .grid { stroke: var(--faint); } .plot .grid.faint { opacity: .55; } .plot .frame { fill: none; stroke: var(--soft); }
.plot .mark { stroke: var(--soft); stroke-dasharray: 4 4; } .plot .zero { stroke: var(--ink); }
.series path { fill: none; stroke: currentColor; stroke-width: 2.2; stroke-linejoin: round; }
.series polygon, .series circle { fill: currentColor; stroke: var(--paper); stroke-width: 1; }
.series.image, .series.hue1 { color: var(--image); } .series.polygon, .series.hue0 { color: var(--polygon); } .series.hue2 { color: var(--model); }
.series.hue3 { color: var(--good); } .series.hue4 { color: var(--bad); } .series.hue5 { color: var(--teal); } .series.hue6 { color: var(--neutral); }
.series.hue4 path, .series.hue5 path, .series.hue6 path { stroke-dasharray: 7 4; }
.point:hover polygon, .point:hover circle { stroke: var(--ink); stroke-width: 2.5; }
.diagram { max-width: 56rem; margin: 1.6rem 0 .5rem; }
.diagram svg { min-width: 40rem; }
.diagram text { fill: var(--ink); font-size: 13px; text-anchor: middle; } .diagram .small { font-size: 11px; fill: var(--soft); }
.diagram .head { font-weight: 600; font-size: 14px; }
.diagram rect { fill: var(--raised); stroke: var(--ink); } .diagram rect.machine { fill: var(--faint); stroke: none; }
.diagram circle { fill: var(--raised); stroke: var(--ink); } .diagram path { fill: none; stroke: var(--ink); stroke-width: 1.3; }
.diagram path.optional { stroke-dasharray: 5 4; } .diagram path.wire { stroke: var(--polygon); stroke-width: 2.4; }
.diagram .arrow { fill: var(--ink); stroke: none; }
#tip { position: fixed; z-index: 9; pointer-events: none; background: var(--ink); color: var(--paper); font: .8rem/1.4 var(--sans);
  font-variant-numeric: lining-nums tabular-nums; padding: .3rem .55rem; border-radius: 4px; white-space: pre-line; max-width: 20rem; }
footer { padding: 2.5rem 0 4rem; border-top: 1px solid var(--rule); margin-top: 3rem; color: var(--soft); font-size: .95rem; }

@media print {
  :root { --paper: #fff; --raised: #fff; --ink: #000; --soft: #444; --rule: #bbb; --faint: #eee; --image: #a04a00; --polygon: #104a90;
    --model: #5a3c83; --good: #1a5f2c; --bad: #90100a; --neutral: #554; }
  body { font-size: 10pt; } .masthead { padding-top: 0; } nav.contents, .script .wipe:not(.compact), .script .to-wipe, .skip, .handle::after { display: none; }
  .masthead .wrap:has(.compact) { grid-template-columns: minmax(0, 1fr) minmax(0, 38%); } .highlights { grid-column: 1 / -1; grid-template-columns: repeat(4, 1fr); margin-top: 1rem; }
  .highlights dt { font-size: 1.4rem; } h1 { font-size: 2rem; } .lede { font-size: 1rem; } .plots { grid-template-columns: 1fr 1fr; } .crops { width: 75%; }
  section { padding-top: 1rem; margin-top: 1rem; } .row, figure, .findings li, tr { break-inside: avoid; } h2, h3 { break-after: avoid; }
  .scroll { overflow: visible; } .table-one { min-width: 0; font-size: 8pt; } .table-one td.note { min-width: 0; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)css";

}  // namespace pac::sim
