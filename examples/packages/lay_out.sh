#!/bin/sh
# lay_out.sh ROUTE: build/packages/ROUTE, ready to be copied or handed on. lay_out.sh install|uninstall: into $DESTDIR$PREFIX.
# Run it at the top of the project, as `make package-ROUTE`, `make install`. The version is that of flexbeam.h, @VERSION@ in recipes.
set -eu
here=examples/packages
version=$(sed -n 's/^#define FB_VERSION "\(.*\)"$/\1/p' flexbeam.h)
prefix=${PREFIX:-/usr/local}

# fill FILE TO: with the version and where it goes
fill() {
  mkdir -p "$(dirname "$2")"
  sed -e "s/@VERSION@/$version/g" -e "s|@PREFIX@|$prefix|g" "$1" > "$2"
}

# put FOLDER FILE...: files of the project as they are
put() {
  to=$1
  shift
  mkdir -p "$to"
  cp "$@" "$to"
}

# sum PROGRAM FILE
sum() {
  "$1" "$2" | cut -d ' ' -f 1
}

# SPDX 2.3: the package and its files, which have no dependencies but libc and libm. The date is that of the commit.
sbom() {
  seconds=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2> /dev/null || echo 0)}
  files="flexbeam.h flexbeam_impl.h LICENSE"
  code=$(for file in $files; do sum sha1sum "$file"; done | sort | tr -d '\n' | sha1sum | cut -d ' ' -f 1)
  cat << END
{
  "spdxVersion": "SPDX-2.3",
  "dataLicense": "CC0-1.0",
  "SPDXID": "SPDXRef-DOCUMENT",
  "name": "flexbeam-$version",
  "documentNamespace": "https://spdx.org/spdxdocs/flexbeam-$version-$code",
  "creationInfo": {"created": "$(date -u -d "@$seconds" +%Y-%m-%dT%H:%M:%SZ)", "creators": ["Tool: lay_out.sh"]},
  "packages": [{
    "name": "flexbeam", "SPDXID": "SPDXRef-Package", "versionInfo": "$version",
    "downloadLocation": "NOASSERTION", "filesAnalyzed": true,
    "packageVerificationCode": {"packageVerificationCodeValue": "$code"},
    "licenseConcluded": "MIT", "licenseDeclared": "MIT", "licenseInfoFromFiles": ["MIT"],
    "copyrightText": "$(sed -n 's/^Copyright/&/p' LICENSE)"}],
  "files": [
END
  between=
  for file in $files; do
    [ -z "$between" ] || echo "$between"
    printf '    {"fileName": "./%s", "SPDXID": "SPDXRef-%s",\n' "$file" "$(echo "$file" | tr _ -)"
    printf '     "checksums": [{"algorithm": "SHA1", "checksumValue": "%s"},\n' "$(sum sha1sum "$file")"
    printf '                   {"algorithm": "SHA256", "checksumValue": "%s"}],\n' "$(sum sha256sum "$file")"
    printf '     "licenseConcluded": "MIT", "licenseInfoInFiles": ["MIT"], "copyrightText": "NOASSERTION"}'
    between=,
  done
  cat << END

  ],
  "relationships": [
    {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-Package"},
    {"spdxElementId": "SPDXRef-Package", "relationshipType": "CONTAINS", "relatedSpdxElement": "SPDXRef-flexbeam.h"},
    {"spdxElementId": "SPDXRef-Package", "relationshipType": "CONTAINS", "relatedSpdxElement": "SPDXRef-flexbeam-impl.h"},
    {"spdxElementId": "SPDXRef-Package", "relationshipType": "CONTAINS", "relatedSpdxElement": "SPDXRef-LICENSE"}]
}
END
}

out=build/packages/$1
root=${DESTDIR:-}$prefix
case $1 in
install)
  put "$root/include" flexbeam.h flexbeam_impl.h
  put "$root/bin" build/flexbeam
  put "$root/share/licenses/flexbeam" LICENSE
  fill $here/pkgconfig/flexbeam.pc "$root/share/pkgconfig/flexbeam.pc"
  for file in flexbeamConfig.cmake flexbeamConfigVersion.cmake; do
    fill $here/cmake/$file "$root/share/flexbeam/cmake/$file"
  done
  exit
  ;;
uninstall)
  rm -f "$root/include/flexbeam.h" "$root/include/flexbeam_impl.h" "$root/bin/flexbeam" "$root/share/pkgconfig/flexbeam.pc"
  rm -rf "$root/share/licenses/flexbeam" "$root/share/flexbeam/cmake"
  rmdir "$root/share/flexbeam" 2> /dev/null || true
  exit
  ;;
sbom)
  mkdir -p "$out"
  sbom > "$out/flexbeam.spdx.json"
  exit
  ;;
esac
[ -d "$here/$1" ] || {
  echo "no such route: $1" >&2
  exit 2
}
rm -rf "$out"
headers=$out
case $1 in
arduino) headers=$out/src ;;
platformio | esp-idf | zephyr) headers=$out/include ;;
vcpkg)
  out=$out/flexbeam # a folder of overlay ports has one for each
  headers=$out
  for file in flexbeamConfig.cmake flexbeamConfigVersion.cmake; do
    fill $here/cmake/$file "$out/$file"
  done
  ;;
esac
(cd "$here/$1" && find . -type f) | while read -r file; do
  fill "$here/$1/$file" "$out/$file"
done
[ "$1" = consumer ] || {
  put "$headers" flexbeam.h flexbeam_impl.h
  put "$out" LICENSE
}
