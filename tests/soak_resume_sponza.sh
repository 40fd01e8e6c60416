# Bakes of Sponza with small maps that are killed at least RESUME_KILLS times, and resumed, as test_resume.sh
# does with the Cornell box. The model is searched for in OCTALUX_SCENES, or in ../shared/scenes.
set -euo pipefail
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
scene=$OCTALUX_SOURCE_DIR/scenes/sponza.json
"$OCTALUX" scene "$scene" >/dev/null 2>&1 || { echo "skipped: no Sponza in $OCTALUX_SCENES"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bakes"
cat >"$work/probes.json" <<'PROBES'
{"probes": [{"position": [-6, 2, -0.35]}, {"position": [5, 2.5, -0.35]},
            {"position": [0, 1.6, 3.8]}, {"position": [-3, 5.9, -4]}]}
PROBES
python3 "$OCTALUX_SOURCE_DIR/tests/resume.py" "$work/bakes" "${RESUME_KILLS:-200}" 3 "$OCTALUX" "$scene" \
  --probes "$work/probes.json" --radiance-size 32 --noise 0.5 --quiet
