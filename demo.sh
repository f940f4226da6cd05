#!/usr/bin/env bash
# Installs what the build needs (Debian 12), builds, and runs the paper's experiments into out/ (or the folder named).
set -euo pipefail
cd "$(dirname "$0")"
tools/install_packages.sh $(cat tools/build_packages.txt)
cmake --preset release >/dev/null
cmake --build --preset release --target pac_cli
build/release/pac demo -o "${1:-out}"
