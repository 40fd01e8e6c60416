# The report of `octalux compare`: one complete file that contains what --json prints, whatever files are called.
source "$(dirname "$0")/cli/expect.sh"
tests="$OCTALUX_SOURCE_DIR/tests"
python3 "$tests/perceptual_reference.py" make . || fail "no pictures"

# check_report COMMAND-LINE EXPOSURE ARGUMENTS...: checks that the report shows the command line, the exposure, and the
# numbers of --json.
check_report() {
  local command=$1 exposure=$2
  shift 2
  expect 0 compare "$@" --report r.html --json
  cp stdout.txt printed.json
  PYTHONDONTWRITEBYTECODE=1 python3 "$tests/read_report.py" r.html printed.json "$command --report r.html --json" "$exposure" >stdout.txt 2>stderr.txt ||
    fail "the report of $*"
}

check_report "octalux compare a.exr b.exr" 1 a.exr b.exr
cp r.html again.html
check_report "octalux compare a.exr b.exr" 1 a.exr b.exr
cmp r.html again.html || fail "a report is not the same twice"
check_report "octalux compare a.exr b.exr --exposure 0.25 --layer beauty" 0.25 a.exr b.exr --exposure 0.25 --layer beauty

# The names of this folder and file would end a script, begin a tag, close an attribute and replace a mark of the page's
# template.
mkdir 'x<'
hostile="x</script><img src=y>&amp;\"'{{data}} é.exr"
cp a.exr "$hostile"
check_report "octalux compare 'x</script><img src=y>&amp;\"'\\''{{data}} é.exr' b.exr" 1 "$hostile" b.exr
rm -r 'x<'

# A comparison of an image with itself has no errors, and numbers that are not finite.
expect 0 compare a.exr a.exr --report same.html --json
grep -q '"beauty",0,1,0,0,null,0,0' same.html || fail "a report of equal images"

expect_usage "does not end in .html" compare a.exr b.exr --report r.htm
expect_failure "no/r.html: cannot write" compare a.exr b.exr --report no/r.html
cp again.html kept.html
expect_failure "none.exr" compare a.exr none.exr --report kept.html
cmp again.html kept.html || fail "a failure touched the old report"
expect_files a.exr b.exr again.html kept.html printed.json r.html same.html
finish
