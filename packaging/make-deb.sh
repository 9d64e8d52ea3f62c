#!/usr/bin/env bash
# Builds the Debian package from what `make install` installs: make-deb.sh FOLDER VERSION BUILD
set -euo pipefail
folder=$1 version=$2 build=$3
source=$(dirname "$0")
staging=$(mktemp -d)
trap 'rm -rf "$staging"' EXIT
chmod 755 "$staging"

MAKEFLAGS='' make -s --no-print-directory BUILD="$build" PREFIX=/usr DESTDIR="$staging" install
strip --strip-unneeded "$staging"/usr/bin/{sinter,bondify,bend,analyze}
find "$staging" -name '*.[15]' -exec gzip -9n {} +
install -D -m 644 LICENSE "$staging/usr/share/doc/kiln/copyright"

# The package that owns each shared library, in the version that is installed here or a newer one. /lib and /usr/lib are one folder,
# and a package lists its files in either.
depends=$(for library in $(ldd "$staging"/usr/bin/{sinter,bondify,bend,analyze} | awk '/=> \// {print $3}' | sort -u); do
    dpkg-query --search "*/$(basename "$(dirname "$library")")/$(basename "$library")"
done | cut -d: -f1 | sort -u | while read -r package; do
    echo "$package (>= $(dpkg-query -W -f '${source:Upstream-Version}\n' "$package" | sort -V | head -1))"
done | paste -sd, | sed 's/,/, /g')

mkdir "$staging/DEBIAN"
sed -e "s/@VERSION@/$version/" -e "s/@ARCHITECTURE@/$(dpkg --print-architecture)/" -e "s/@DEPENDS@/$depends/" \
    -e "s/@SIZE@/$(du -sk "$staging/usr" | cut -f1)/" "$source/control.in" >"$staging/DEBIAN/control"
mkdir -p "$folder"
dpkg-deb --root-owner-group --build "$staging" "$folder/kiln_${version}_$(dpkg --print-architecture).deb"
