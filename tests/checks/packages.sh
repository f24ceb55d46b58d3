#!/bin/sh
# Packages: what is installed is all there and all gone again; examples/packages/consumer is built and runs by every route that
# this machine has; the recipes of the others are executed or read with what stands for their tools; one version everywhere.
. tests/checks/common.sh
need pkg-config pkg-config
need cmake cmake
python=${PYTHON:-python3}
need "$python" python3
version=$(sed -n 's/^#define FB_VERSION "\(.*\)"$/\1/p' flexbeam.h)
place=$(pwd)/$out
lay="sh examples/packages/lay_out.sh"
for route in meson conan vcpkg arduino platformio esp-idf zephyr consumer sbom; do
  try $lay $route
done
! grep -rl '@[A-Z]*@' build/packages > "$out/log" || fail "not filled in: $(cat "$out/log")"
said=$(grep -rhoE "\b[0-9]+\.[0-9]+\.[0-9]+\b" examples/packages --exclude=README.md --exclude=meson.build || true)
[ -z "$said" ] || fail "recipes have numbers of their own: $said"
ran=

# runs ROUTE PROGRAM
runs() {
  try "$2"
  [ "$(cat "$out/log")" = "flexbeam $version: 0.000 1.000 0.000" ] || fail "$1: $(cat "$out/log")"
  ran="$ran $1"
}

# install into a folder of packages, which is then moved to its place
mkdir -p "$out/staged"
(
  export DESTDIR="$place/staged" PREFIX="$place/prefix"
  try $lay install
)
mv "$place/staged$place/prefix" "$place/prefix"
find "$out/prefix" -type f | sed "s|^$out/prefix/||" | sort | tr '\n' ' ' > "$out/installed"
[ "$(cat "$out/installed")" = "bin/flexbeam include/flexbeam.h include/flexbeam_impl.h share/flexbeam/cmake/flexbeamConfig.cmake \
share/flexbeam/cmake/flexbeamConfigVersion.cmake share/licenses/flexbeam/LICENSE share/pkgconfig/flexbeam.pc " ] || fail "installed: $(cat "$out/installed")"
try "$out/prefix/bin/flexbeam" --help
export PKG_CONFIG_PATH="$place/prefix/share/pkgconfig"
[ "$(pkg-config --modversion flexbeam)" = "$version" ] || fail "pkg-config has another version"
try ${CC:-cc} -std=c99 -O0 $(pkg-config --cflags flexbeam) -o "$out/by_pkg_config" build/packages/consumer/main.c $(pkg-config --libs flexbeam)
runs pkg-config "$out/by_pkg_config"
try cmake -S build/packages/consumer -B "$out/cmake" -DCMAKE_PREFIX_PATH="$place/prefix"
try cmake --build "$out/cmake"
runs CMake "$out/cmake/consumer"
sed "s/flexbeam $version REQUIRED/flexbeam 99.0 REQUIRED/" build/packages/consumer/CMakeLists.txt > "$out/newer.txt"
mkdir -p "$out/newer" && cp "$out/newer.txt" "$out/newer/CMakeLists.txt" && cp build/packages/consumer/main.c "$out/newer"
! cmake -S "$out/newer" -B "$out/newer/b" -DCMAKE_PREFIX_PATH="$place/prefix" > "$out/log" 2>&1 || fail "find_package takes an older version"
(
  export PREFIX="$place/prefix"
  try $lay uninstall
)
[ -z "$(find "$out/prefix" -type f)" ] || fail "left after uninstall: $(find "$out/prefix" -type f)"

# vcpkg's port, ESP-IDF's component and Zephyr's module, by functions that stand for those of their tools
cat > "$out/vcpkg.cmake" << END
set(CURRENT_PACKAGES_DIR "$place/vcpkg")
function(vcpkg_install_copyright unused file)
  file(INSTALL "\${file}" DESTINATION "\${CURRENT_PACKAGES_DIR}/share/flexbeam")
endfunction()
include("$(pwd)/build/packages/vcpkg/flexbeam/portfile.cmake")
END
try cmake -P "$out/vcpkg.cmake"
try cmake -S build/packages/consumer -B "$out/by_port" -DCMAKE_PREFIX_PATH="$place/vcpkg"
try cmake --build "$out/by_port"
runs "vcpkg's port" "$out/by_port/consumer"
for route in esp-idf zephyr; do
  cat > "$out/$route.cmake" << END
set(CONFIG_FLEXBEAM 1)
function(idf_component_register)
  message(STATUS "folder \${ARGV}")
endfunction()
function(zephyr_include_directories)
  message(STATUS "folder \${ARGV}")
endfunction()
include("$(pwd)/build/packages/$route/CMakeLists.txt")
END
  try cmake -P "$out/$route.cmake"
  grep -q 'folder .*include' "$out/log" && [ -f build/packages/$route/include/flexbeam.h ] || fail "$route: $(cat "$out/log")"
  try ${CC:-cc} -std=c99 -O0 -Ibuild/packages/$route/include -o "$out/by_$route" build/packages/consumer/main.c -lm
  runs "$route's folder" "$out/by_$route"
done
if command -v meson > /dev/null; then
  mkdir -p "$out/meson/subprojects"
  cp build/packages/consumer/main.c build/packages/consumer/meson.build "$out/meson"
  cp -r build/packages/meson "$out/meson/subprojects/flexbeam"
  mv "$out/meson/subprojects/flexbeam/flexbeam.wrap" "$out/meson/subprojects"
  try meson setup "$out/meson/build" "$out/meson"
  try meson compile -C "$out/meson/build"
  runs Meson "$out/meson/build/consumer"
fi
if command -v conan > /dev/null; then
  export CONAN_HOME="$place/conan_home"
  try conan profile detect
  try conan create build/packages/conan
  try conan install build/packages/consumer --output-folder "$out/conan"
  try cmake -S build/packages/consumer -B "$out/by_conan" -DCMAKE_TOOLCHAIN_FILE="$place/conan/conan_toolchain.cmake" -DCMAKE_BUILD_TYPE=Release
  try cmake --build "$out/by_conan"
  runs Conan "$out/by_conan/consumer"
fi

# what is left is read: JSON, lines of a key, the SBOM against the files
cat > "$out/read.py" << 'END'
import ast, hashlib, json, sys
folder, version = sys.argv[1] + '/', sys.argv[2]
assert json.load(open(folder + 'vcpkg/flexbeam/vcpkg.json'))['version'] == version
assert json.load(open(folder + 'platformio/library.json'))['version'] == version
assert 'version = "%s"' % version in open(folder + 'conan/conanfile.py').read()
ast.parse(open(folder + 'conan/conanfile.py').read())
arduino = dict(line.rstrip('\n').split('=', 1) for line in open(folder + 'arduino/library.properties'))
assert arduino['version'] == version and not {'name', 'author', 'maintainer', 'sentence', 'paragraph', 'category', 'url', 'architectures'} - set(arduino)
for name in 'esp-idf/idf_component.yml', 'zephyr/zephyr/module.yml':
    text = open(folder + name).read()
    try:
        import yaml
        content = yaml.safe_load(text)
    except ImportError:  # keys alone
        content = dict((line.split(':', 1) + [''])[:2] for line in text.splitlines() if line[0] != ' ')
    assert str(content.get('version', version)).strip(' "') == version and set(content) & {'dependencies', 'build'}, name
sbom = json.load(open(folder + 'sbom/flexbeam.spdx.json'))
assert sbom['spdxVersion'] == 'SPDX-2.3' and sbom['packages'][0]['versionInfo'] == version
sums = []
for file in sbom['files']:
    data = open(file['fileName'], 'rb').read()
    for check in file['checksums']:
        assert check['checksumValue'] == hashlib.new(check['algorithm'].lower(), data).hexdigest(), file
    sums.append(hashlib.sha1(data).hexdigest())
assert sbom['packages'][0]['packageVerificationCode']['packageVerificationCodeValue'] == hashlib.sha1(''.join(sorted(sums)).encode()).hexdigest()
ids = {file['SPDXID'] for file in sbom['files']} | {'SPDXRef-DOCUMENT', 'SPDXRef-Package'}
assert all({r['spdxElementId'], r['relatedSpdxElement']} <= ids for r in sbom['relationships']) and len(ids) == 5
END
try "$python" "$out/read.py" build/packages "$version"
for header in flexbeam.h flexbeam_impl.h; do
  for at in arduino/src platformio/include esp-idf/include zephyr/include conan meson vcpkg/flexbeam; do
    cmp -s $header build/packages/$at/$header || fail "build/packages/$at/$header is another one"
  done
done
ok "version $version; installed and removed 7 files; built and ran by$(echo "$ran" | sed 's/ / /g'); read: Arduino, PlatformIO, SBOM"
