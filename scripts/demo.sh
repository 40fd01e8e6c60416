#!/usr/bin/env bash
# Bake three built-in scenes, render them from their fields and by path tracing, and put pictures, error maps and numbers
# on one page that needs no other file: demo.sh PROGRAM FOLDER. Takes a few minutes on two processors.
set -euo pipefail
export LC_ALL=C
program=$1 out=$2
size=${DEMO_SIZE:-512x384} radiance=${DEMO_RADIANCE_SIZE:-256} path_spp=${DEMO_PATH_SPP:-64} bounces=3
mkdir -p "$out"

# number JSON KEY...: the number behind the last key, each key sought behind the one before.
number() {
  local json=$1 key
  shift
  for key; do json=${json#*\"$key\":}; done
  printf '%s' "${json%%[,\}]*}"
}
seconds() { printf '%.1f s' "$(number "$@")"; }
count() { printf '%.0f' "$(number "$@")"; }
error() { printf '%.4f' "$(number "$@")"; }
percent() {
  local value
  value=$(printf '%.8f' "$(number "$@")")
  printf '%+.1f&#8239;%%' "${value}e2"
}
mebibytes() { printf '%s' "$(($(number "$@") / 1048576)) MiB"; }

# figure IMAGE TITLE TEXT
figure() {
  printf '<figure><img alt="%s" src="data:image/png;base64,' "$2"
  base64 -w 0 "$1"
  printf '"><figcaption><b>%s</b> %s</figcaption></figure>\n' "$2" "$3"
}

say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

rows="" sections=""

# scene NAME TITLE TEXT BAKE-OPTIONS...
scene() {
  local name=$1 title=$2 text=$3 scene=builtin:$1 base=$out/$1 baked path field naive field_error naive_error
  shift 3
  say "$name: bake"
  baked=$("$program" bake "$scene" -o "$base.olx" --radiance-size "$radiance" --irradiance-size 64 --bounces $bounces \
    --json "$@")
  say "$name: path trace, $path_spp samples a pixel"
  path=$("$program" render "$scene" -o "$base-path.exr" --png "$base-path.png" --method path --size "$size" \
    --spp "$path_spp" --bounces $((bounces + 1)) --json)
  say "$name: render from the field"
  field=$("$program" render "$scene" -o "$base-field.exr" --png "$base-field.png" --method field --field "$base.olx" \
    --size "$size" --spp 4 --json)
  "$program" render "$scene" -o "$base-naive.exr" --png "$base-naive.png" --method field --field "$base.olx" \
    --size "$size" --spp 4 --visibility none >/dev/null
  "$program" render "$scene" -o "$base-probes.png" --method field --field "$base.olx" --size "$size" --spp 4 \
    --show-probes >/dev/null
  say "$name: compare"
  field_error=$("$program" compare "$base-field.exr" "$base-path.exr" --heatmap "$base-field-error.png" --json)
  naive_error=$("$program" compare "$base-naive.exr" "$base-path.exr" --heatmap "$base-naive-error.png" --json)

  rows+="<tr><th>$title<td>$(count "$baked" probes)<td>$(seconds "$baked" seconds)<td>$(mebibytes "$baked" file_bytes)"
  rows+="<td>$(seconds "$path" seconds)<td>$(seconds "$field" seconds)"
  rows+="<td>$(error "$field_error" beauty relative_mse)<td>$(error "$naive_error" beauty relative_mse)"
  rows+="<td>$(error "$field_error" indirect_diffuse relative_mse)<td>$(error "$naive_error" indirect_diffuse relative_mse)"
  rows+="<td>$(percent "$field_error" indirect_diffuse bias)<td>$(percent "$naive_error" indirect_diffuse bias)"
  rows+=$'\n'

  sections+="<section><h2>$title</h2><p>$text</p><div class=grid>"
  sections+=$(
    figure "$base-path.png" "Path traced." "The reference: $path_spp paths a pixel, $((bounces + 1)) indirect bounces."
    figure "$base-field.png" "From the field." "Indirect light comes from the probes alone, 4 samples a pixel."
    figure "$base-naive.png" "From the field, without visibility." "Nearby probes are averaged, whether or not a wall stands between."
    figure "$base-probes.png" "Where the probes stand." "Blue: probes. Red: probes inside geometry, which are never asked."
    figure "$base-field-error.png" "Error of the field." "Against the path-traced picture, over its mean."
    figure "$base-naive-error.png" "Error without visibility." "The same scale."
  )
  sections+=$'</div></section>\n'
}

scene cornell-glossy "Cornell box with a glossy surface" \
  "The classic box: colour bleeds from the red and green walls onto the white ones, and the glossy surface shows the room
  again. Reflections are rays traced through what the probes saw, so they can only show what some probe saw."
scene two-rooms-sealed "Two rooms, sealed" \
  "A lit and a dark room, a thin wall between them. Probes on the lit side stand close to the dark side, so averaging the
  nearest probes lets light through the wall. Stored distances tell the field which probes see a point."
scene labyrinth "Labyrinth" \
  "Inner walls cut the space into corridors that are lit around corners. Most probes near a point are behind some wall, and
  some stand inside walls."

page=$out/index.html
{
  cat <<'HEAD'
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Octalux: light from probes against path tracing</title>
<style>
:root { color-scheme: light dark; --page: #f7f7f5; --text: #1d1f21; --soft: #5b6066; --line: #d9dadb; --card: #fff; }
@media (prefers-color-scheme: dark) {
  :root { --page: #141619; --text: #e8e9ea; --soft: #a0a6ad; --line: #2f3338; --card: #1c1f23; }
}
body { margin: 0; background: var(--page); color: var(--text); font: 16px/1.55 system-ui, sans-serif; }
main { max-width: 1680px; margin: 0 auto; padding: 32px clamp(16px, 3vw, 48px) 64px; }
h1 { font-size: 32px; line-height: 1.2; margin: 0 0 8px; }
h2 { font-size: 22px; margin: 48px 0 4px; }
p { max-width: 80ch; margin: 0 0 16px; }
.grid { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 20px; }
@media (max-width: 800px) { .grid { grid-template-columns: 1fr; } }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
img { display: block; width: 100%; height: auto; }
figcaption { padding: 10px 14px 12px; font-size: 15px; color: var(--soft); }
figcaption b { color: var(--text); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 15px; font-variant-numeric: tabular-nums; }
th, td { padding: 7px 14px; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th:first-child { text-align: left; padding-left: 0; }
thead th { font-weight: 600; color: var(--soft); text-align: center; }
small { color: var(--soft); }
</style>
<main>
<h1>Octalux</h1>
<p>Global illumination from precomputed light field probes, beside a path tracer that judges it. Every picture and number
on this page was made by <code>octalux</code> on this machine a moment ago.</p>
<div class="scroll"><table>
<thead>
<tr><th rowspan="2">Scene<th rowspan="2">Probes<th rowspan="2">Bake<th rowspan="2">Field<th colspan="2">Rendering<th
colspan="2">Error of the picture<th colspan="2">Error of indirect diffuse<th colspan="2">Its bias</tr>
<tr><th>path<th>field<th>field<th>no visibility<th>field<th>no visibility<th>field<th>no visibility</tr>
</thead>
<tbody>
HEAD
  printf '%s</tbody>\n</table></div>\n' "$rows"
  cat <<'TEXT'
<p><small>Errors are relative mean square errors, sum (a &minus; b)&sup2; / sum b&sup2; against the path-traced picture; bias is
sum (a &minus; b) / sum b. The reference's own noise is part of them. Error maps show |a &minus; b| over the reference's mean,
from black (equal) to yellow (100&#8239;% and more); the scale at the right of each goes with the square root.</small></p>
TEXT
  printf '%s</main>\n</html>\n' "$sections"
} >"$page"

say "done"
echo
echo "Open $page"
