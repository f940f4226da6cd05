// Figure 1 of the paper, redrawn: the flow of data between server and client.
#pragma once

namespace pac::sim {

inline constexpr char kFlowDiagram[] = R"svg(
<svg viewBox="0 0 840 300" role="img" aria-labelledby="flow-t flow-d">
<title id="flow-t">Figure 1: flow of data</title>
<desc id="flow-d">The server renders the scene in high and low quality, subtracts, codes the difference and sends it. The client
decodes it, renders the matching low-quality picture, adds both and displays the composite. Sending the low-quality model is optional.</desc>
<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerUnits="userSpaceOnUse" markerWidth="9" markerHeight="9" orient="auto"><path class="arrow" d="M0 0L8 4L0 8z"/></marker></defs>
<rect class="machine" x="4" y="34" width="476" height="258" rx="8"/><rect class="machine" x="546" y="34" width="290" height="258" rx="8"/>
<text class="head" x="242" y="22">Server</text><text class="head" x="691" y="22">Client</text><text class="small" x="513" y="22">network</text>
<rect x="20" y="64" width="104" height="52" rx="4"/><text x="72" y="87">high-quality</text><text x="72" y="104">model</text>
<rect x="20" y="214" width="104" height="52" rx="4"/><text x="72" y="237">low-quality</text><text x="72" y="254">model</text>
<rect x="162" y="64" width="96" height="52" rx="4"/><text x="210" y="87">render</text><text class="small" x="210" y="104">high quality</text>
<rect x="162" y="214" width="96" height="52" rx="4"/><text x="210" y="237">render</text><text class="small" x="210" y="254">low quality</text>
<circle cx="320" cy="165" r="17"/><path d="M312 165h16"/>
<rect x="386" y="139" width="80" height="52" rx="4"/><text x="426" y="162">JPEG</text><text class="small" x="426" y="179">encode</text>
<rect x="560" y="139" width="80" height="52" rx="4"/><text x="600" y="162">JPEG</text><text class="small" x="600" y="179">decode</text>
<rect x="560" y="214" width="80" height="52" rx="4"/><text x="600" y="237">render</text><text class="small" x="600" y="254">low quality</text>
<circle cx="706" cy="165" r="17"/><path d="M698 165h16M706 157v16"/>
<rect x="758" y="139" width="66" height="52" rx="4"/><text x="791" y="170">display</text>
<path marker-end="url(#head)" d="M124 90h36"/><path marker-end="url(#head)" d="M124 240h36"/>
<path marker-end="url(#head)" d="M258 90h62v56"/><path marker-end="url(#head)" d="M258 240h62v-56"/>
<text x="288" y="82">H</text><text x="288" y="232">L</text>
<path marker-end="url(#head)" d="M337 165h47"/><text x="360" y="157">D</text>
<path class="wire" marker-end="url(#head)" d="M466 165h92"/>
<path class="wire optional" marker-end="url(#head)" d="M72 266v16h462v-42h24"/><text class="small" x="430" y="276">model, where it is not resident</text>
<path marker-end="url(#head)" d="M640 165h47"/><text x="664" y="157">D′</text>
<path marker-end="url(#head)" d="M640 240h66v-56"/><text x="664" y="232">L</text>
<path marker-end="url(#head)" d="M723 165h33"/>
</svg>
)svg";

}  // namespace pac::sim
