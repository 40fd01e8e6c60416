# Wrong usage gives exit code 2, one line that says what is wrong, and nothing on standard output; help texts are
# compared with stored ones.
source "$(dirname "$0")/cli/expect.sh"

expect 2
grep -q "^usage: octalux COMMAND" stderr.txt || fail "no usage without a command"
[ -s stdout.txt ] && fail "usage without a command belongs on standard error"

expect_usage "unknown command 'paint'" paint builtin:cornell
expect_usage "unknown command '--json'" --json

for command in scene place bake render audit; do expect_usage "SCENE is missing" $command; done
for command in info verify; do expect_usage "FIELD is missing" $command; done
expect_usage "IMAGE.exr is missing" compare
expect_usage "REFERENCE.exr is missing" compare a.exr
expect_usage "experiments have a program of their own: octalux-bench" bench all
expect_usage "'c.exr' is one argument too many" compare a.exr b.exr c.exr
expect_usage "-o FILE.json is missing" place builtin:cornell
expect_usage "is not one of grid|sdf|medial|cover" place builtin:cornell -o p.json --method magic
for share in 0 -1 nan much ''; do
  expect_usage "is not a number above 0" place builtin:cornell -o p.json --coverage "$share"
done
expect_usage "-o FILE.olx is missing" bake builtin:cornell
expect_usage "-o FILE is missing" render builtin:cornell
expect_usage "--field FILE.olx is missing" audit builtin:cornell

expect_usage "unknown option '--frobnicate'" bake builtin:cornell -o a.olx --frobnicate 3
expect_usage "unknown option '--gri'" bake builtin:cornell -o a.olx --gri 4x4x4
expect_usage "unknown option '-x'" info -x
expect_usage "unknown option '--raidance-size'; did you mean --radiance-size?" bake builtin:cornell -o a.olx --raidance-size 64
expect_usage "unknown command 'rendr'; did you mean render?" rendr builtin:cornell
for far in --frobnicate --x; do
  expect 2 bake builtin:cornell -o a.olx $far 3
  grep -q "did you mean" stderr.txt && fail "$far is near to nothing"
done
expect_usage "--radiance-size needs a value" bake builtin:cornell -o a.olx --radiance-size
expect_usage "-o needs a value" bake builtin:cornell -o
expect_usage "--json takes no value" scene builtin:cornell --json=yes

for grid in 4x4 4x4x4x4 0x4x4 4x-1x4 4,4,4 axbxc 4x4x 99999999999x1x1 ' 4x4x4' ''; do
  expect_usage "is not a grid" bake builtin:cornell -o a.olx --grid "$grid"
done
for size in 100 4 4096 -64 64.0 1e2 0x40 '' ; do
  expect_usage "is not a power of two from 8 to 2048" bake builtin:cornell -o a.olx --radiance-size "$size"
done
expect_usage "power of two from 8 to 256" bake builtin:cornell -o a.olx --irradiance-size 512
expect_usage "power of two from 32 to 256" bake builtin:cornell -o a.olx --classic --classic-size 16
expect_usage "go with --classic" bake builtin:cornell -o a.olx --cube-size 64
expect_usage "--method classic needs --field" render builtin:cornell -o a.exr --method classic
expect_usage "go with --method field" render builtin:cornell -o a.exr --method classic --field a.olx --mode gather
expect_usage "from 0 to 256" bake builtin:cornell -o a.olx --bounces 257
expect_usage "from 1 to 8" bake builtin:cornell -o a.olx --samples 0
expect_usage "from 1 to 64" bake builtin:cornell -o a.olx --light-samples 65
expect_usage "from 0 to 4096" bake builtin:cornell -o a.olx --threads -1
for size in 640 0x480 640x 640x480x3 16385x16 640*480; do
  expect_usage "is not a size" render builtin:cornell -o a.exr --size "$size"
done
expect_usage "or inf" render builtin:cornell -o a.exr --bounces many
expect_usage "from 1 to 1048576" render builtin:cornell -o a.exr --spp 0
expect_usage "is not one of field|path" render builtin:cornell -o a.exr --method raster
expect_usage "is not one of cpu|vulkan" render builtin:cornell -o a.exr --device tpu
expect_usage "is not one of texel|two-level|hiz" render builtin:cornell -o a.exr --tracer texe
expect_usage "is not one of none|chebyshev" audit builtin:cornell --field a.olx --visibility some
expect_usage "is not one of beauty|direct" compare a.exr b.exr --layer light
expect_usage "is not a number above 0" render builtin:cornell -o a.png --exposure -1
expect_usage "is not a number above 0" render builtin:cornell -o a.png --exposure nan

expect_usage "needs --field" render builtin:cornell -o a.exr --method field
expect_usage "ends in neither .exr nor .png" render builtin:cornell -o a.jpg
expect_usage "ends in neither .exr nor .png" render builtin:cornell -o .png
expect_usage "does not end in .png" compare a.exr b.exr --heatmap d.jpg
expect_usage "needs --field and a .png" render builtin:cornell -o a.exr --show-probes --field a.olx
expect_usage "needs a .png" render builtin:cornell -o a.exr --exposure 2
expect_usage "goes with -o FILE.exr" render builtin:cornell -o a.png --png b.png
expect_usage "goes with -o FILE.exr" render builtin:cornell -o a.exr --png b.jpg
expect_files

# Options for research are shown by --help all only; `help COMMAND` shows the same as `COMMAND --help`.
expect 0 bake --help
grep -q -- "--noise" stdout.txt || fail "--help lacks what decides about quality"
grep -q -- "--classic" stdout.txt && fail "--help shows what is for research"
expect 0 bake --help all
grep -q -- "--classic" stdout.txt || fail "--help all lacks what is for research"
mv stdout.txt all.txt
expect 0 help bake all
cmp -s all.txt stdout.txt || fail "octalux help bake all is not octalux bake --help all"
expect 0 help export exr
grep -q "^usage: octalux export exr" stdout.txt || fail "octalux help export exr prints no usage"
expect_usage "unknown command 'paint'" help paint
expect_usage "a page is a folder, which '-' cannot be" export web builtin:cornell --field a.olx -o -

# Manual pages and completion have every option, those of research as well.
for command in scene place bake render compare audit info verify pack unpack "export exr" "export gltf" "export ktx2" "export web"; do
  # shellcheck disable=SC2086 # commands of two words
  expect 0 help $command words
  [ "$(grep -c -- '^-' stdout.txt)" -ge 3 ] || fail "no words for $command"
  mv stdout.txt words.txt
  # shellcheck disable=SC2086
  expect 0 help $command man
  sed 's/\\-/-/g; s/\\&//g' stdout.txt >page.txt
  while read -r word; do
    [ "$word" = --help ] || grep -q -- "^$word" page.txt || fail "the manual page of $command lacks $word"
  done <words.txt
done

# --quiet suppresses warnings, and nothing else.
cat >plain.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
f 1 2 3
OBJ
expect 0 bake plain.obj --grid 1x1x1 --radiance-size 8 -o loud.olx
grep -q "warning: .*no light" stderr.txt || fail "a scene without light is worth a warning"
mv stdout.txt loud.txt
expect 0 bake plain.obj --grid 1x1x1 --radiance-size 8 -o quiet.olx --quiet
[ -s stderr.txt ] && fail "--quiet says something beside results"
[ "$(grep -c . stdout.txt)" -eq "$(grep -c . loud.txt)" ] || fail "--quiet drops results"
cmp -s loud.olx quiet.olx || fail "--quiet changes what is baked"

help="$OCTALUX_SOURCE_DIR/tests/cli/help.txt"
{
  "$OCTALUX" --help
  for command in scene place bake render compare audit info verify pack unpack export "export exr" "export gltf" "export ktx2"; do
    echo
    echo "== octalux $command --help"
    "$OCTALUX" $command --help all
  done
  echo
  echo "== octalux-bench --help"
  "$OCTALUX_BENCH" --help
} >help.txt 2>stderr.txt
if [ "${UPDATE_GOLDEN:-}" ]; then cp help.txt "$help"; fi
diff -u "$help" help.txt >stdout.txt || fail "the help changed; when it should, run again with UPDATE_GOLDEN=1"
for help in -h help; do
  expect 0 $help
  grep -q "^usage: octalux COMMAND" stdout.txt || fail "octalux $help prints no usage"
done
expect 0 --version
grep -qE "^octalux [0-9]+\.[0-9]+\.[0-9]+$" stdout.txt || fail "no version"

finish
