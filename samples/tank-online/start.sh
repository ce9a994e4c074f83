#!/bin/sh
# Builds both programs and runs them until Ctrl+C. `plcc` must be in the path, or PLCC names it.
set -e
plcc=${PLCC:-plcc}
here=$(cd "$(dirname "$0")" && pwd)
out=$(mktemp -d)
trap 'kill $plant $controller 2>/dev/null; wait; rm -rf "$out"' EXIT
trap 'exit 0' INT TERM
"$plcc" build --quiet "$here/plant" -o "$out/plant"
"$plcc" build --quiet "$here/controller" -o "$out/controller"
# The certificate of the OPC UA server is made here.
cd "$out"
"$out/plant" --quiet &
plant=$!
# Its ports are open then.
sleep 1
"$out/controller" --quiet &
controller=$!
echo "page: http://127.0.0.1:15105   metrics: http://127.0.0.1:15104/metrics   S7: 127.0.0.1:15103   OPC UA: opc.tcp://127.0.0.1:15106"
wait
