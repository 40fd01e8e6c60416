#!/usr/bin/env bash
# Bakes a furnished room and two rooms that are hard to light correctly, renders them from their fields and by path
# tracing, and puts pictures and numbers on one page that needs no other file: demo.sh PROGRAM FOLDER. Takes three to four
# minutes of processor time: pictures are small, and the room is baked with more noise than by default.
set -euo pipefail
export LC_ALL=C
program=$1 out=$2
bounces=2
mkdir -p "$out"

# This is the built-in glossy box with rougher surfaces, since the light that smoother metal reflects onto the ceiling
# would take the path tracer long.
cat >"$out/cornell.json" <<'JSON'
{"model": "builtin:cornell-glossy",
 "materials": {"metal block": {"roughness": 0.6}, "glazed block": {"roughness": 0.5}, "polished floor": {"roughness": 0.4}}}
JSON

# number JSON KEY...: prints the number behind the last key, each key searched behind the previous one. null means
# infinity.
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
mebibytes() { awk -v bytes="$(number "$@")" 'BEGIN { printf "%.1f MiB", bytes / 1048576 }'; }
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

picture() { printf 'data:image/png;base64,'; base64 -w 0 "$1"; }

# figure IMAGE TITLE TEXT: prints a picture with its caption.
figure() {
  printf '<figure><img alt="%s" src="%s"><figcaption><b>%s</b> %s</figcaption></figure>\n' "$2" "$(picture "$1")" "$2" "$3"
}

# slider LEFT-IMAGE LEFT-TITLE RIGHT-IMAGE RIGHT-TITLE: prints two pictures in one frame, with a movable line between
# them.
slider() {
  printf '<div class=slider style="--at: 50%%"><img alt="%s" src="%s"><img class=over alt="%s" src="%s">' \
    "$4" "$(picture "$3")" "$2" "$(picture "$1")"
  printf '<span class=left>%s</span><span class=right>%s</span>' "$2" "$4"
  printf '<input type=range min=0 max=100 value=50 step=0.1 aria-label="%s on the left, %s on the right"></div>\n' "$2" "$4"
}

say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

# milliseconds JSON SPP: prints the time of one frame's indirect light, with one sample a pixel, on one core.
milliseconds() {
  awk -v diffuse="$(number "$1" passes indirect_diffuse)" -v glossy="$(number "$1" passes indirect_glossy)" -v spp="$2" \
    'BEGIN { printf "%.0f ms", 1000 * (diffuse + glossy) / spp }'
}

# walk_through SCENE FIELD: makes a page beside ours that walks through the scene. Sets `walk` to the link to it, empty
# where this build has no such page.
walk_through() {
  walk=""
  rm -rf "$out/walk"
  say "flat: a page to walk through it"
  if "$program" export web "$1" --field "$2" -o "$out/walk" >"$out/log.txt" 2>&1; then
    walk='<p><a href="walk/index.html">Walk through this room</a>, once a server shows this folder: browsers load its parts from no other'
    walk+=" place.</p><pre>python3 -m http.server --directory $(printf %q "$out")</pre>"
  else
    say "there is none: $(tail -n 1 "$out/log.txt")"
  fi
}

# room: renders the room, and sets `hero` to its part of the page.
room() {
  local base=$out/flat size=640x400 spp=12 look baked field path
  look=(--camera room --size "$size" --exposure 2)
  say "flat: direct light alone"
  "$program" render builtin:flat -o "$base-direct.png" --method path --bounces 0 "${look[@]}" --spp "$spp" >"$out/log.txt"
  say "the first picture: $base-direct.png"
  say "flat: place probes, and bake"
  "$program" place builtin:flat -o "$base-probes.json" >"$out/log.txt" 2>&1
  baked=$("$program" bake builtin:flat --probes "$base-probes.json" -o "$base.olx" --radiance-size 256 --noise 0.06 --json)
  say "flat: render from the field"
  field=$("$program" render builtin:flat -o "$base-field.exr" --png "$base-field.png" --field "$base.olx" "${look[@]}" \
    --spp "$spp" --glossy-samples 1 --json)
  "$program" render builtin:flat -o "$base-probes.png" --field "$base.olx" "${look[@]}" --spp 9 --glossy-samples 1 \
    --show-probes >"$out/log.txt"
  say "flat: path trace, as many samples"
  path=$("$program" render builtin:flat -o "$base-path.exr" --png "$base-path.png" --method path --field "$base.olx" \
    "${look[@]}" --spp "$spp" --json)
  walk_through builtin:flat "$base.olx"
  hero=$(
    slider "$base-direct.png" "Direct light" "$base-field.png" "With Octalux"
    printf '<ul class=facts><li><b>%s</b> for the indirect light of a frame of %s on one core<li><b>%s</b> probes, placed by themselves' \
      "$(milliseconds "$field" "$spp")" "${size/x/ x }" "$(count "$baked" probes)"
    printf '<li><b>%s</b> of field in memory<li><b>%s</b> to bake</ul>\n' "$(mebibytes "$baked" file_bytes)" "$(seconds "$baked" seconds)"
    printf '<p>A furnished room with sun through its window. Whatever the sun does not reach is lit by what other surfaces reflect.'
    printf ' Below, path tracing with as many samples a pixel, which took %s where the field took %s; and the probes.</p>\n' \
      "$(seconds "$path" seconds)" "$(seconds "$field" seconds)"
    printf '<div class=grid style="--shape: %s">' "${size/x/ / }"
    figure "$base-path.png" "Path traced" "$spp paths a pixel, all bounces."
    figure "$base-field.png" "From the field" "$spp samples a pixel for direct light and reflections; diffuse light is read where surfaces are."
    figure "$base-probes.png" "Where the probes are" "Chosen so that they see what can be seen from where a viewer can be."
    printf '</div>\n'
    printf '%s\n' "$walk"
  )
}

rows="" sections=""

# scene SCENE CAMERA SIZE EXPOSURE SPP TITLE TEXT BAKE-OPTION...: bakes and renders a scene, and prints its part of the
# page.
scene() {
  local scene=$1 camera=$2 size=$3 exposure=$4 spp=$5 title=$6 text=$7 name=${1##*[:/]}
  local baked path field error audit view base=$out/${name%.json}
  name=${name%.json}
  shift 7
  view=(--camera "$camera" --size "$size")
  say "$name: bake"
  baked=$("$program" bake "$scene" -o "$base.olx" --bounces $bounces --json "$@")
  say "$name: render from the field"
  field=$("$program" render "$scene" -o "$base-field.exr" --png "$base-field.png" --exposure "$exposure" \
    --method field --field "$base.olx" "${view[@]}" --spp 64 --json)
  say "$name: path trace, $spp samples a pixel"
  path=$("$program" render "$scene" -o "$base-path.exr" --png "$base-path.png" --exposure "$exposure" --method path \
    "${view[@]}" --spp "$spp" --bounces $((bounces + 1)) --json)
  say "$name: measure"
  error=$("$program" compare "$base-field.exr" "$base-path.exr" --heatmap "$base-field-error.png" --json \
    --report "$base.html" --exposure "$exposure")
  audit=$("$program" audit "$scene" --field "$base.olx" --rays 20000 --points 500 --spp 128 --json)

  rows+="<tr><th>$title<td>$(count "$baked" probes)<td>$(seconds "$baked" seconds)<td>$(mebibytes "$baked" file_bytes)"
  rows+="<td>$(seconds "$path" seconds)<td>$(seconds "$field" seconds)"
  rows+="<td>$(fraction "$error" indirect_diffuse relative_mse)<td>$(fraction "$audit" points relative_mse)"
  rows+="<td>$(percent "$audit" points leak)"
  rows+="<td>$(percent "$audit" rays unresolved)<td>$(percent "$audit" rays wrong)"
  rows+=$'\n'

  sections+="<section><h2>$title</h2><p>$text <a href=\"${base##*/}.html\">The field against the path tracer, to look into.</a></p><div class=grid style=\"--shape: ${size/x/ / }\">"
  sections+=$(
    figure "$base-path.png" "Path traced" "The reference: $spp paths a pixel, $((bounces + 1)) indirect bounces."
    figure "$base-field.png" "From the field" "Direct light is sampled; everything indirect comes from the probes."
    figure "$base-field-error.png" "Error of the field" "Against the path-traced picture."
  )
  sections+=$'</div></section>\n'
}

room
scene "$out/cornell.json" front 176x176 2 256 "Cornell box, glossy" \
  "The classic box with a rough metal block: colour bleeds from the red and green walls onto the white ones, and the block
  shows the room again. Reflections are rays traced through what the probes saw." \
  --grid 4x4x4 --radiance-size 128
scene builtin:two-rooms-sealed dark 192x144 1 16 "Two rooms, sealed" \
  "A lit and a dark room, a thin wall between them, seen from the dark one: the true picture is black. Light is stored where
  surfaces are, and read only from a surface that a point lies on, so none comes through the wall." \
  --radiance-size 128

page=$out/index.html
{
  cat <<'HEAD'
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Octalux: light from probes</title>
<style>
:root { color-scheme: light dark; --page: #f7f7f5; --text: #1d1f21; --soft: #5b6066; --line: #d9dadb; --card: #fff; }
@media (prefers-color-scheme: dark) {
  :root { --page: #141619; --text: #e8e9ea; --soft: #a0a6ad; --line: #2f3338; --card: #1c1f23; }
}
body { margin: 0; background: var(--page); color: var(--text); font: 16px/1.55 system-ui, sans-serif; }
main { max-width: 1200px; margin: 0 auto; padding: 32px clamp(16px, 3vw, 48px) 64px; }
h1 { font-size: 32px; line-height: 1.2; margin: 0 0 8px; }
h2 { font-size: 22px; margin: 48px 0 4px; }
p { max-width: 80ch; margin: 0 0 16px; }
.slider { position: relative; overflow: hidden; border-radius: 8px; background: #000; }
.slider img { display: block; width: 100%; }
.slider .over { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--at)) 0 0); }
.slider::after { content: ""; position: absolute; top: 0; bottom: 0; left: calc(var(--at) - 1px); width: 2px; background: #fff; }
.slider::before { content: "\2039\a0\203a"; position: absolute; z-index: 1; top: 50%; left: var(--at); width: 40px; height: 40px; transform: translate(-50%, -50%);
  display: grid; place-items: center; border-radius: 50%; background: #fff; color: #1d1f21; font-size: 22px; line-height: 1; box-shadow: 0 1px 6px #0008; pointer-events: none; }
.slider span { position: absolute; top: 12px; padding: 2px 10px; border-radius: 999px; background: #000a; color: #fff; font-size: 14px; }
.slider .left { left: 12px; }
.slider .right { right: 12px; }
.slider input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0; cursor: ew-resize; }
.slider:focus-within { outline: 3px solid #4a90d9; outline-offset: 2px; }
.facts { display: flex; flex-wrap: wrap; gap: 8px 32px; list-style: none; margin: 12px 0 16px; padding: 0; color: var(--soft); }
.facts b { color: var(--text); }
.grid { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 20px; }
@media (max-width: 800px) { .grid { grid-template-columns: 1fr; } }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
figure img { display: block; width: 100%; aspect-ratio: var(--shape); object-fit: contain; background: #000; }
figcaption { padding: 10px 14px 12px; font-size: 15px; color: var(--soft); }
figcaption b { color: var(--text); }
pre { overflow-x: auto; padding: 14px 16px; background: var(--card); border: 1px solid var(--line); border-radius: 8px; font-size: 14px; }
.scroll { overflow-x: auto; margin-bottom: 16px; }
table { width: 100%; border-collapse: collapse; font-size: 15px; font-variant-numeric: tabular-nums; }
th, td { padding: 7px 0 7px 14px; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
thead tr + tr th { white-space: normal; vertical-align: bottom; }
tbody th, thead tr:first-child th:first-child { text-align: left; padding-left: 0; }
thead th { font-weight: 600; color: var(--soft); vertical-align: bottom; }
small { color: var(--soft); font-size: 14px; }
a { color: inherit; }
</style>
<main>
<h1>Octalux</h1>
<p>Global illumination from precomputed light field probes: baked once, then looked up on any processor or Vulkan GPU, without
ray tracing hardware. Every picture and number on this page was made by <code>octalux</code> on this machine a moment ago.</p>
HEAD
  printf '%s\n' "$hero"
  cat <<'TABLE'
<h2>Held to a path tracer</h2>
<div class="scroll"><table>
<thead>
<tr><th rowspan="2">Scene<th rowspan="2">Probes<th rowspan="2">Bake<th rowspan="2">Field<th colspan="2">Rendering<th
colspan="2">Error of indirect light<th rowspan="2">Leak<th colspan="2">Traced rays</tr>
<tr><th>path<th>field<th>picture<th>points<th>unresolved<th>wrong</tr>
</thead>
<tbody>
TABLE
  printf '%s</tbody>\n</table></div>\n' "$rows"
  cat <<'TEXT'
<p><small>The error of the picture is the relative mean square error of its indirect diffuse light against the path-traced
one, sum (a &minus; b)&sup2; / sum b&sup2;; it is infinite where the truth is black. That of points compares irradiance at 500
random points of the whole scene; leak is its mean at points that no light reaches, over the mean of the scene. Traced rays are
20&#8239;000 diffuse and mirror rays through the field against ray casting: unresolved where no probe could tell, wrong where
the point found is off. Error maps show |a &minus; b| over the reference's mean (over 1 where that is black), from black
(equal) to yellow (100&#8239;% and more); the scale at their right goes with the square root.</small></p>
TEXT
  printf '%s' "$sections"
  cat <<'FOOT'
<section><h2>Now your scene</h2>
<p>A glTF, OBJ or JSON scene needs three commands; nothing has to be placed or tuned by hand. The last one opens a window on
any machine with Vulkan.</p>
<pre>octalux place scene.glb -o probes.json
octalux bake scene.glb --probes probes.json -o scene.olx
octalux view scene.glb --field scene.olx</pre>
<p>A host links a small runtime without dependencies, or includes the shaders; see the README.</p></section>
</main>
<script>
for (const slider of document.querySelectorAll(".slider")) {
  slider.querySelector("input").addEventListener("input", e => slider.style.setProperty("--at", e.target.value + "%"));
}
</script>
</html>
FOOT
} >"$page"

say "done"
echo
echo "Open $page"
