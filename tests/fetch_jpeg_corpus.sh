#!/usr/bin/env bash
# fetch_jpeg_corpus.sh FOLDER: gathers other people's JPEG files from the test suites of Debian packages, for
# tests/jpeg_corpus.cpp. Uses the machine's configured apt sources (adding their source packages in a private list), installs
# nothing, and leaves only FOLDER/PACKAGE/*: about 400 files, 115 MB of downloads.
set -euo pipefail
[ $# -eq 1 ] || { echo "usage: $0 FOLDER" >&2; exit 2; }
mkdir -p "$1"
target=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source_packages=(libjpeg-turbo pillow exiv2 php8.2 libimage-exiftool-perl libgd2)
binary_packages=(golang-1.19-src gdk-pixbuf-tests)

# The configured repositories, as deb and deb-src lines; the release itself suffices, without its security updates.
mkdir -p "$work/lists/partial" "$work/cache/archives/partial"
apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' | grep -i debian | grep -v security | sort -u |
  while read -r line; do printf 'deb %s\ndeb-src %s\n' "$line" "$line"; done >"$work/sources.list"
apt=(apt-get -qq -o "Dir::Etc::sourcelist=$work/sources.list" -o Dir::Etc::sourceparts=/dev/null
  -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache" -o APT::Sandbox::User=root
  -o Acquire::Languages=none -o Acquire::Retries=3)
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
[ -f "$keyring" ] && apt+=(-o "Dir::Etc::trusted=$keyring")
"${apt[@]}" update

cd "$work"
"${apt[@]}" source --download-only "${source_packages[@]}"
"${apt[@]}" download "${binary_packages[@]}"

# keep PACKAGE < tar: the JPEG files, each under a name made of its path. Names say JPEG, or the first bytes do.
keep() {
  local package=$1 tree=$work/tree n=0
  rm -rf "$tree" && mkdir -p "$tree" "$target/$package"
  # tar fails where one of the patterns matches nothing; the count at the end is the check.
  tar -x -C "$tree" --no-same-owner --wildcards '*.jp*' '*.JP*' '*.jfif' '*.mpo' 2>/dev/null || true
  while IFS= read -r -d '' file; do
    local name=${file#"$tree"/}
    cp "$file" "$target/$package/${name//\//__}"
    n=$((n + 1))
  done < <(find "$tree" -type f -regextype posix-extended -iregex '.*\.(jpe?g|jfif|mpo)' -print0)
  echo "$package: $n files"
}
for deb in ./*.deb; do
  name=$(dpkg-deb -f "$deb" Package)
  dpkg-deb --fsys-tarfile "$deb" | keep "$name"
done
for dsc in ./*.dsc; do
  name=$(sed -n 's/^Source: //p' "$dsc" | head -n 1)
  archive=$(ls "${name}"_*.orig.tar.* | grep -v '\.asc$' | head -n 1)
  case $archive in
    *.gz) gzip -dc "$archive" ;;
    *.xz) xz -dc "$archive" ;;
    *.bz2) bzip2 -dc "$archive" ;;
  esac | keep "$name"
done
[ "$(find "$target" -type f | wc -l)" -gt 300 ] || { echo "fewer files than expected" >&2; exit 1; }
