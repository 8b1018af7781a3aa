#!/usr/bin/env bash
# Builds the page of `restshape live` from lib/restshape/live/page/src into .../dist, with node and npm.
# Usage: scripts/page.sh      (what has not changed since the last run it leaves alone)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
page=lib/restshape/live/page
oldest=18 # of node: what the bundler runs on

fail() { # what, what to do
    printf 'page: %s\n  try: %s\n' "$1" "$2" >&2
    exit 1
}

digest() { # files...
    { node --version && cat -- "$@"; } | sha256sum | cut -d' ' -f1
}

unchanged() { # file with a digest, digest
    [ "$(cat "$1" 2>/dev/null)" = "$2" ]
}

for tool in node npm; do
    command -v "$tool" >/dev/null || fail "$tool not found" "install Node.js $oldest or newer with npm"
done
[ "$(node --print 'process.versions.node.split(".")[0]')" -ge "$oldest" ] ||
    fail "node $(node --version) is older than $oldest" "install Node.js $oldest or newer"

packages=$(digest package.json package-lock.json)
if ! unchanged node_modules/.state "$packages"; then
    echo "page: what npm installs"
    # Scripts of packages are not run: none of these needs its own.
    npm ci --ignore-scripts --no-audit --no-fund --loglevel=error ||
        fail "npm could not install the packages of package-lock.json" "read npm's message above. Is there a network?"
    echo "$packages" >node_modules/.state
fi

mapfile -t sources < <(find "$page/src" "$page/tsconfig.json" -type f | LC_ALL=C sort)
wanted=$(digest scripts/page.sh package-lock.json "${sources[@]}")
if unchanged "$page/dist/.state" "$wanted"; then exit 0; fi
echo "page: $page/dist"
made=$(mktemp -d "$page/dist.XXXXXX")
trap 'rm -rf "$made"' EXIT
node_modules/.bin/esbuild "$page/src/main.ts" "$page/src/main.css" --bundle --minify --format=esm --target=es2022 \
    --legal-comments=eof --log-level=warning --outdir="$made" || fail "the page does not build" "read the message above"
cp "$page/src/index.html" "$made/"
echo "$wanted" >"$made/.state"
chmod 755 "$made"
rm -rf "$page/dist"
mv "$made" "$page/dist"
