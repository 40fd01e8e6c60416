#!/usr/bin/env bash
# Bake three built-in scenes, render them from their fields and by path tracing, and put pictures, error maps and numbers
# on one page that needs no other file: demo.sh PROGRAM FOLDER. Takes less than 150 seconds of processor time, most of it for
# references without visible noise; pictures are small for their sake.
set -euo pipefail
export LC_ALL=C
program=$1 out=$2
bounces=2
mkdir -p "$out"

# The built-in glossy box, rougher: what its metal throws onto the ceiling takes the path tracer long to make smooth.
cat >"$out/cornell.json" <<'JSON'
{"model": "builtin:cornell-glossy",
 "materials": {"metal block": {"roughness": 0.6}, "glazed block": {"roughness": 0.5}, "polished floor": {"roughness": 0.4}}}
JSON

# number JSON KEY...: the number behind the last key, each key sought behind the one before. null is an infinite one.
number() {
  local json=$1 key
  shift
  for key; do json=${json#*\"$key\":}; done
  json=${json%%[,\}]*}
  [ "$json" = null ] && json=inf
  printf '%s' "$json"
}
seconds() { printf '%.1f s' "$(number "$@")"; }
count() { printf '%.0f' "$(number "$@")"; }
mebibytes() { printf '%s MiB' "$(($(number "$@") / 1048576))"; }
fraction() {
  local value
  value=$(number "$@")
  if [ "$value" = inf ]; then printf '&infin;'; else printf '%.4f' "$value"; fi
}
percent() {
  local value
  value=$(printf '%.8f' "$(number "$@")")
  printf '%.2f&#8239;%%' "${value}e2"
}

# figure IMAGE TITLE TEXT
figure() {
  printf '<figure><img alt="%s" src="data:image/png;base64,' "$2"
  base64 -w 0 "$1"
  printf '"><figcaption><b>%s</b> %s</figcaption></figure>\n' "$2" "$3"
}

say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

rows="" sections="" pictures=0

# scene SCENE CAMERA SIZE EXPOSURE SPP TITLE TEXT BAKE-OPTION...
scene() {
  local scene=$1 camera=$2 size=$3 exposure=$4 spp=$5 title=$6 text=$7 name=${1##*[:/]}
  local baked path field field_error naive_error field_audit naive_audit view base=$out/${name%.json}
  name=${name%.json}
  shift 7
  view=(--camera "$camera" --size "$size")
  say "$name: bake"
  baked=$("$program" bake "$scene" -o "$base.olx" --bounces $bounces --json "$@")
  say "$name: render from the field"
  field=$("$program" render "$scene" -o "$base-field.exr" --png "$base-field.png" --exposure "$exposure" \
    --method field --field "$base.olx" "${view[@]}" --spp 64 --json)
  pictures=$((pictures + 1))
  [ $pictures -gt 1 ] || say "the first picture: $base-field.png"
  "$program" render "$scene" -o "$base-naive.exr" --png "$base-naive.png" --exposure "$exposure" --method field \
    --field "$base.olx" "${view[@]}" --spp 64 --visibility none >"$out/log.txt"
  "$program" render "$scene" -o "$base-probes.png" --exposure "$exposure" --method field --field "$base.olx" \
    "${view[@]}" --spp 16 --show-probes >"$out/log.txt"
  say "$name: path trace, $spp samples a pixel"
  path=$("$program" render "$scene" -o "$base-path.exr" --png "$base-path.png" --exposure "$exposure" --method path \
    "${view[@]}" --spp "$spp" --bounces $((bounces + 1)) --json)
  say "$name: measure"
  field_error=$("$program" compare "$base-field.exr" "$base-path.exr" --heatmap "$base-field-error.png" --json \
    --report "$base.html" --exposure "$exposure")
  naive_error=$("$program" compare "$base-naive.exr" "$base-path.exr" --heatmap "$base-naive-error.png" --json)
  field_audit=$("$program" audit "$scene" --field "$base.olx" --rays 20000 --points 500 --spp 128 --json)
  naive_audit=$("$program" audit "$scene" --field "$base.olx" --rays 2 --points 500 --spp 128 --visibility none --json)

  rows+="<tr><th>$title<td>$(count "$baked" probes)<td>$(seconds "$baked" seconds)<td>$(mebibytes "$baked" file_bytes)"
  rows+="<td>$(seconds "$path" seconds)<td>$(seconds "$field" seconds)"
  rows+="<td>$(fraction "$field_error" indirect_diffuse relative_mse)<td>$(fraction "$naive_error" indirect_diffuse relative_mse)"
  rows+="<td>$(fraction "$field_audit" points relative_mse)<td>$(fraction "$naive_audit" points relative_mse)"
  rows+="<td>$(percent "$field_audit" points leak)<td>$(percent "$naive_audit" points leak)"
  rows+="<td>$(percent "$field_audit" rays unresolved)<td>$(percent "$field_audit" rays wrong)"
  rows+=$'\n'

  sections+="<section><h2>$title</h2><p>$text <a href=\"${base##*/}.html\">The field against the path tracer, to look into.</a></p><div class=grid style=\"--shape: ${size/x/ / }\">"
  sections+=$(
    figure "$base-path.png" "Path traced" "The reference: $spp paths a pixel, $((bounces + 1)) indirect bounces."
    figure "$base-field.png" "From the field" "Direct light is sampled; everything indirect comes from the probes."
    figure "$base-naive.png" "From the field, without visibility" "Nearby probes are averaged, wall between or not."
    figure "$base-probes.png" "Where the probes stand" "Blue: probes. Red: probes inside geometry, never asked."
    figure "$base-field-error.png" "Error of the field" "Against the path-traced picture."
    figure "$base-naive-error.png" "Error without visibility" "On the same scale."
  )
  sections+=$'</div></section>\n'
}

scene "$out/cornell.json" front 176x176 2 400 "Cornell box, glossy" \
  "The classic box with a rough metal block: colour bleeds from the red and green walls onto the white ones, and the block
  shows the room again. Reflections are rays traced through what the probes saw." \
  --grid 4x4x4 --radiance-size 128 --irradiance-size 32
scene builtin:two-rooms-sealed dark 192x144 1 16 "Two rooms, sealed" \
  "A lit and a dark room, a thin wall between them, seen from the dark one: the true picture is black. Probes of the lit
  room stand just behind the wall, so averaging the nearest probes lets light through. Stored distances tell the field
  which probes see a point, and it stays dark but for spots in corners beside the wall. Irradiance probes stand where the
  light field probes do, to show this; at half that spacing, the default for so few, a layer of them falls inside the wall
  and parts the rooms even so." \
  --irradiance-grid 4x2x2 --radiance-size 256
scene builtin:labyrinth ring 144x108 1.5 448 "Labyrinth" \
  "Inner walls cut the space into corridors that are lit around corners. Most probes near a point are behind some wall, and
  some stand inside walls." \
  --radiance-size 256 --irradiance-size 32

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
img { display: block; width: 100%; aspect-ratio: var(--shape); object-fit: contain; background: #000; }
figcaption { padding: 10px 14px 12px; font-size: 15px; color: var(--soft); }
figcaption b { color: var(--text); }
.scroll { overflow-x: auto; }
table { width: 100%; border-collapse: collapse; font-size: 15px; font-variant-numeric: tabular-nums; }
th, td { padding: 7px 0 7px 14px; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
thead tr + tr th { white-space: normal; vertical-align: bottom; }
tbody th, thead tr:first-child th:first-child { text-align: left; padding-left: 0; }
thead th { font-weight: 600; color: var(--soft); vertical-align: bottom; }
small { color: var(--soft); font-size: 14px; }
a { color: inherit; }
.scroll { margin-bottom: 16px; }
</style>
<main>
<h1>Octalux</h1>
<p>Global illumination from precomputed light field probes, beside a path tracer that judges it. Every picture and number
on this page was made by <code>octalux</code> on this machine a moment ago.</p>
<div class="scroll"><table>
<thead>
<tr><th rowspan="2">Scene<th rowspan="2">Probes<th rowspan="2">Bake<th rowspan="2">Field<th colspan="2">Rendering<th
colspan="2">Error of indirect light<th colspan="2">Error of irradiance<th colspan="2">Leak<th colspan="2">Traced rays</tr>
<tr><th>path<th>field<th>field<th>no visibility<th>field<th>no visibility<th>field<th>no visibility<th>unresolved<th
>wrong</tr>
</thead>
<tbody>
HEAD
  printf '%s</tbody>\n</table></div>\n' "$rows"
  cat <<'TEXT'
<p><small>The error of indirect light is the relative mean square error of the picture's indirect diffuse light against
the path-traced one, sum (a &minus; b)&sup2; / sum b&sup2;; it is infinite where the truth is black. Irradiance is compared at 500 random points of the whole scene against
path tracing; leak is its mean at points that no light reaches, over the mean of the scene. Traced rays are 20&#8239;000
diffuse and mirror rays through the field against ray casting: unresolved where no probe could tell, wrong where the point
found is off. Error maps show |a &minus; b| over the reference's mean (over 1 where that is black), from black (equal) to
yellow (100&#8239;% and more); the scale at their right goes with the square root.</small></p>
TEXT
  printf '%s</main>\n</html>\n' "$sections"
} >"$page"

say "done"
echo
echo "Open $page"
