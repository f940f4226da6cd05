#!/usr/bin/env bash
# Installs what the build needs (Debian 12), builds everything with warnings as errors, and runs every test.
set -euo pipefail
cd "$(dirname "$0")"
tools/install_packages.sh $(cat tools/build_packages.txt)
cmake --workflow --preset release
