# fuzz_for_long.sh FUZZER ROUNDS: runs a fuzzer at least once, with one seed after the other until SOAK_MINUTES have
# passed. CMakeLists.txt runs it for every fuzzer in `make soak`. A failure names the seed; FUZZER ROUNDS SEED runs it
# again.
set -euo pipefail
end=$((SECONDS + 60 * ${SOAK_MINUTES:-60})) seed=${SOAK_SEED:-1}
while
  "$1" "$2" "$seed" || { echo "failed: $1 $2 $seed"; exit 1; }
  seed=$((seed + 1))
  [ "$SECONDS" -lt "$end" ]
do :; done
