#!/usr/bin/env bash
# Makes the base image for docker/Dockerfile out of Debian packages, for machines that reach a Debian mirror but no
# image registry:
#   docker/make-base-image.sh [TAG]                       default tag: truestep-base
#   docker build --build-arg BASE=truestep-base -f docker/Dockerfile -t truestep .
# It uses this machine's apt sources and apt settings, so a local mirror is used in the image's builds too. Needs
# mmdebstrap, docker and root (or user namespaces).
set -euo pipefail

tag=${1:-truestep-base}
command -v mmdebstrap >/dev/null || { echo "mmdebstrap is missing: apt-get install mmdebstrap" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The machine's own sources of Debian, in whichever of apt's two formats they are.
shopt -s nullglob
sources=()
for file in /etc/apt/sources.list /etc/apt/sources.list.d/debian*.list /etc/apt/sources.list.d/debian*.sources; do
  [ -s "$file" ] && sources+=("$file")
done
[ "${#sources[@]}" -gt 0 ] || { echo "no apt sources of Debian found below /etc/apt" >&2; exit 1; }

# Documentation and translations stay out, as in Debian's own slim images; born merged, it needs no usrmerge (and
# no perl).
mmdebstrap --quiet --variant=apt --include=ca-certificates,usr-is-merged \
  --hook-dir=/usr/share/mmdebstrap/hooks/merged-usr \
  --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
  --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright' \
  --aptopt='Acquire::Languages "none"' \
  --customize-hook='copy-in /etc/ssl/certs/ca-certificates.crt /etc/ssl/certs' \
  --customize-hook='rm -rf "$1"/var/lib/apt/lists/* "$1"/var/cache/apt/* "$1"/var/log/*' \
  bookworm "$work/base.tar" "${sources[@]}"
docker import --change 'CMD ["bash"]' "$work/base.tar" "$tag"
