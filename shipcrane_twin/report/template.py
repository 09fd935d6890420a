"""The frame of the report page: HTML and CSS, nothing that loads from elsewhere."""

CONVENTIONS = (
    "Roll is positive starboard down, pitch positive bow up, heave positive up.",
    "Heading and all directions are in degrees clockwise from north; current and wind: where they flow to.",
    "North, east and down are metres in the world frame; down is zero at the still water surface.",
    "Track, heave and position error are those of the centre of gravity; heave is zero at design draught.",
    "Forces and moments of the crane act on the ship at the crane's foot: x forward, y to port, z up.",
    "Sway is the angle between the line from crane tip to load and the vertical, while the wire is taut.",
    "Time is simulated time; forces are means over the macro step that ends at their time.",
)

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>
:root {{ --ink: #1d2733; --soft: #5a6675; --paper: #f5f6f8;
  --card: #ffffff; --rule: #dde2e8; --warn: #b3400c; }}
@media (prefers-color-scheme: dark) {{
  :root {{ --ink: #e4e8ed; --soft: #9aa6b4; --paper: #14181d;
    --card: #1d232a; --rule: #333c46; --warn: #ff9d66; }}
}}
* {{ box-sizing: border-box; }}
body {{ margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 62rem;
  background: var(--paper); color: var(--ink);
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }}
h1 {{ font-size: 1.7rem; line-height: 1.2; margin: 0 0 1.25rem; }}
h2 {{ font-size: 1.1rem; margin: 0 0 .5rem; }}
section, figure {{ background: var(--card); border: 1px solid var(--rule); border-radius: .5rem;
  margin: 0 0 1.25rem; padding: 1rem 1.25rem; }}
.scroll {{ overflow-x: auto; }}
table {{ border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }}
th, td {{ padding: .3rem .5rem; border-bottom: 1px solid var(--rule); text-align: right;
  vertical-align: top; }}
th:first-child {{ text-align: left; font-weight: 500; padding-left: 0; }}
thead th {{ color: var(--soft); font-weight: 500; }}
tr:last-child > * {{ border-bottom: 0; }}
.run td {{ text-align: left; overflow-wrap: anywhere; }}
.run th {{ width: 12rem; color: var(--soft); }}
img {{ display: block; width: 100%; height: auto; padding: .5rem;
  background: #ffffff; border-radius: .25rem; }}
figcaption {{ margin-top: .6rem; }}
.whole {{ color: var(--soft); margin: .75rem 0 0; }}
.gaps {{ border-left: .25rem solid var(--warn); padding-left: .75rem; margin: .75rem 0 0; }}
.gaps p {{ color: var(--warn); font-weight: 600; margin: 0; }}
.gaps ul, .conventions ul {{ margin: .25rem 0 0; padding-left: 1.2rem; }}
summary {{ cursor: pointer; font-weight: 600; }}
pre {{ overflow-x: auto; font: .8rem/1.45 ui-monospace, "DejaVu Sans Mono", monospace; margin: .75rem 0 0; }}
@media print {{
  :root {{ --ink: #000; --soft: #444; --paper: #fff; --card: #fff; --rule: #ccc; --warn: #b3400c; }}
  body {{ max-width: none; padding: 0; font-size: .85rem; }}
  section, figure {{ border: 0; padding: 0; break-inside: avoid; }}
  img {{ width: auto; max-width: 100%; max-height: 10.5cm; padding: 0; }}
  details {{ display: none; }}
}}
</style>
</head>
<body>
<h1>{title}</h1>
<section><h2>The run</h2><table class="run">
{run}
</table>
{gaps}
</section>
<section><h2>Results</h2><div class="scroll"><table>
<thead><tr><th></th><th>mean</th><th>std</th><th>min</th><th>max</th><th>rms</th></tr></thead>
<tbody>
{results}
</tbody></table></div></section>
{figures}
<section class="conventions"><h2>Conventions</h2><ul>
{conventions}
</ul></section>
<section><details><summary>The scenario, all settings resolved</summary>
<pre>{scenario}</pre></details></section>
</body>
</html>
"""
