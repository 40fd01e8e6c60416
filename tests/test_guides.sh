# Commands that the guides tell their readers to type work, in the order of their pages, on a small room.
source "$(dirname "$0")/cli/expect.sh"
guide=$OCTALUX_SOURCE_DIR/docs/guide
PATH="$(dirname "$OCTALUX"):$PATH"

python3 "$OCTALUX_SOURCE_DIR/tests/guide_commands.py" "$guide"/{first-hour,settings,symptoms,ci}.md >commands.sh ||
  fail "the guides cannot be read"
[ "$(grep -c '^octalux ' commands.sh)" -ge 14 ] || fail "the guides have lost their commands"
bash commands.sh >stdout.txt 2>stderr.txt || fail "a command of the guides fails"
for made in probes.json room.olx room.exr room.png path.exr differences.html room.olxz bake.json compare.json; do
  [ -s "$made" ] || fail "the guides promise $made"
done

# Results agree with the statements of the guides' pages.
grep -q "a field of about" stdout.txt || fail "place says nothing of the field's size"
grep -q "bounds" stdout.txt || fail "scene says nothing of bounds"
expect_json 'abs(o["layers"]["indirect_diffuse"]["bias"]) < 0.03' compare room.exr path.exr --layer indirect_diffuse
finish
